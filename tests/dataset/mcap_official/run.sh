#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# usage: run.sh WRITE_RECORDING_SAMPLE FOLDER mcap|bag   writes the sample and checks it with the reader of
# that format. Exits 77 (skipped) where the readers are not installed.
set -eu
here=$(dirname "$0")
if ! command -v node >/dev/null; then
  echo "skipped: no node here, so the official MCAP reader cannot run"
  exit 77
fi
if [ ! -d "$here/node_modules/@mcap/core" ] || [ ! -d "$here/node_modules/@foxglove/rosbag" ]; then
  echo "skipped: the readers are not installed; npm ci --prefix tests/dataset/mcap_official"
  exit 77
fi
"$1" "$2" "$3"
if [ "$3" = bag ]; then exec node "$here/read_bag.mjs" "$2/data.bag"; fi
"$1" "$2/driver" mcap driver
node "$here/read_driver.mjs" "$2/driver/data.mcap"
exec node "$here/read_all.mjs" "$2/data.mcap"
