#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Keeps what a later comparison needs of a study's result.
# usage: keep.sh OUT BASELINE
set -euo pipefail
out=${1:?usage: keep.sh OUT BASELINE}
baseline=${2:?usage: keep.sh OUT BASELINE}
rm -rf "$baseline"
mkdir -p "$baseline"
cp -r "$out/plan.json" "$out/runs" "$baseline"
find "$baseline" -name '*.ply' -delete
