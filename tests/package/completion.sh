#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Tests bash completion (called as a shell does) and the manual page (formatted by man).
# usage: completion.sh PROGRAM
set -euo pipefail
PATH=$(dirname "$1"):$PATH
source <(lidarena completion)

# expect LINE WORD...: every WORD must be offered as completion of the last word of LINE
expect() {
  local line=$1 word
  shift
  read -ra COMP_WORDS <<<"$line"
  [ "${line: -1}" != " " ] || COMP_WORDS+=("")
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  COMPREPLY=()
  _lidarena || true  # compgen returns 1 if nothing matches
  for word in "$@"; do
    printf '%s\n' "${COMPREPLY[@]}" | grep -qxF -- "$word" || {
      echo "'$line' does not offer '$word' but: ${COMPREPLY[*]}" >&2
      exit 1
    }
  done
}
expect "lidarena si" simulate
expect "lidarena simulate --wo" --world
expect "lidarena simulate --world h" house
expect "lidarena simulate --sensor livox_mid3" livox_mid360
expect "lidarena simulate --noise o" on off
expect "lidarena convert --dialect dr" driver
expect "lidarena run fast" fast_lio2
expect "lidarena list wo" worlds
expect "lidarena study qu" quick
expect "lidarena study --sl" --slurm
expect "lidarena sta" status
expect "lidarena status --w" --watch

if command -v man >/dev/null; then
  warnings=$(lidarena man | MANROFFSEQ= man --warnings=w -E UTF-8 -l - 2>&1 >/dev/null)
  [ -z "$warnings" ] || { echo "$warnings" >&2; exit 1; }
fi
page=$(lidarena man)
for verb in simulate run evaluate study status report view convert info list schema; do
  [[ $page == *".SS $verb"* ]] || { echo "the manual page does not contain $verb" >&2; exit 1; }
done
