#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a pipeline of evalio on a recording and writes OUTPUT/trajectory.tum.
# usage: evalio.sh PIPELINE INPUT OUTPUT RIG
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
export EVALIO_CUSTOM=lidarena_evalio PYTHONPATH=$here${PYTHONPATH:+:$PYTHONPATH} PYTHONDONTWRITEBYTECODE=1
export LIDARENA_RIG=$4
LIDARENA_RECORDING=$(dirname "$2")
export LIDARENA_RECORDING
evalio run -d lidarena_recording/flight -p "$1" -o "$3/evalio"
# its rows: time, x, y, z, qx, qy, qz, qw
tr ',' ' ' <"$3/evalio/lidarena_recording/flight/$1.csv" >"$3/trajectory.tum"
