#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Flies a study, compares it with a kept one, and writes OUT/summary.md for a comment.
# usage: fly.sh STUDY OUT [BASELINE] [LIMITS]
# BASELINE is the folder of an earlier result (keep.sh); without it, or if it is empty, nothing is
# compared. LIMITS are those of `lidarena report --fail-on`, by default drift=5%,lost=0.
# Exit code 0: good; 1: an expectation is not met, or a figure grew by more than its limit; 2: wrong
# usage or bad input.
set -euo pipefail
study=${1:?usage: fly.sh STUDY OUT [BASELINE] [LIMITS]}
out=${2:?usage: fly.sh STUDY OUT [BASELINE] [LIMITS]}
baseline=${3:-}
limits=${4:-drift=5%,lost=0}
mkdir -p "$out"

code=0
lidarena study "$study" --out "$out" | tee "$out/flown.txt" || code=$?
[ "$code" -le 1 ] || exit "$code"
compared=0
if [ -n "$baseline" ] && [ -f "$baseline/plan.json" ]; then
  lidarena report "$out" --against "$baseline" --fail-on "$limits" >"$out/compared.txt" || compared=$?
  cat "$out/compared.txt"
  [ "$compared" -le 1 ] || exit "$compared"
fi

{
  echo "<!-- lidarena -->"
  if [ "$code" = 0 ] && [ "$compared" = 0 ]; then
    echo "### Lidarena: all limits are kept"
  else
    echo "### Lidarena: a limit is exceeded"
    grep -h -E "^(falls short|beyond the limit)" "$out/flown.txt" "$out/compared.txt" 2>/dev/null |
      sort -u | sed 's/^/- /' || true
  fi
  echo
  if [ -f "$out/compared.txt" ]; then
    cat "$out/comparison.md"
  else
    echo "No earlier result to compare with."
    echo
    echo '```'
    sed -n '/^world /,/^$/p' "$out/flown.txt"
    echo '```'
  fi
} >"$out/summary.md"
[ "$code" = 0 ] && [ "$compared" = 0 ]
