#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# usage: run.sh WRITE_MCAP_SAMPLE FOLDER   writes the sample and has the official reader check it.
# Exits 77 (skipped) where the reader is not installed.
set -eu
here=$(dirname "$0")
if ! command -v node >/dev/null; then
  echo "skipped: no node here, so the official MCAP reader cannot run"
  exit 77
fi
if [ ! -d "$here/node_modules/@mcap/core" ]; then
  echo "skipped: the official MCAP reader is not installed; npm ci --prefix tests/dataset/mcap_official"
  exit 77
fi
"$1" "$2"
exec node "$here/read_all.mjs" "$2/data.mcap"
