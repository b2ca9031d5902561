#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the Debian packages that are missing. Needs root (by sudo) only if one is missing.
# usage: cmake/setup.sh run|test
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(g++ cmake ninja-build pkg-config ca-certificates
          libeigen3-dev libembree-dev libtbb-dev libassimp-dev libyaml-cpp-dev
          nlohmann-json3-dev libfmt-dev libcli11-dev robin-map-dev libzstd-dev libdeflate-dev libpng-dev
          liblz4-dev libxxhash-dev liblzf-dev libmd-dev libceres-dev libcpp-httplib-dev libgtest-dev libgmock-dev libbenchmark-dev
          dpkg-dev file)
# Debian 12 has sdformat 12; later releases dropped it, which disables SDF worlds. Without libbz2,
# ROS 1 bags with bz2 chunks cannot be read; without libsqlite3, .db3 bags of rosbag2; without nanoflann, benchmarks leave out the comparison
# with it. Live topics need Cyclone DDS, the Python module needs pybind11 and NumPy.
optional=(libsdformat-dev cyclonedds-dev libbz2-dev libsqlite3-dev libnanoflann-dev python3-dev pybind11-dev python3-numpy)

installed() { [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

missing=()
for p in "${packages[@]}"; do installed "$p" || missing+=("$p"); done
# an npm package bundles the HTML pages' scripts; a Node.js from another source works as well
command -v node >/dev/null || missing+=(nodejs)
command -v npm >/dev/null || missing+=(npm)
if [ "${1:-run}" = test ]; then
  command -v python3 >/dev/null || missing+=(python3)
  # tests of the Python module and of the schemas, and the documentation site
  optional+=(python3-pytest python3-jsonschema python3-yaml mkdocs)
  # names that a script uses and does not define
  optional+=(python3-pyflakes)
  # browser for tests of the HTML pages; without it the tests of the view are reported as skipped
  optional+=(chromium)
  # makes the wheel's libraries find each other; without it the test of the wheel is reported as skipped
  optional+=(patchelf)
  # the other implementation of DDS, beside which live topics are tested; without it that is skipped
  optional+=(libfastrtps-dev)
  # plots and notebooks of the Python module; without them their tests are reported as skipped
  optional+=(python3-matplotlib python3-nbconvert python3-ipykernel)
  # ROS 1's own bag reader; without it the test that needs it is reported as skipped
  optional+=(python3-rosbag python3-roslz4 python3-sensor-msgs python3-nav-msgs python3-tf2-msgs)
fi
absent_optional=()
for p in "${optional[@]}"; do installed "$p" || absent_optional+=("$p"); done

if [ "${#missing[@]}" -eq 0 ] && [ "${#absent_optional[@]}" -gt 0 ] && [ "$(id -u)" != 0 ]; then
  echo "set-up: optional, not installed: ${absent_optional[*]} (features that need them are disabled)"
elif [ "${#missing[@]}" -gt 0 ] || [ "${#absent_optional[@]}" -gt 0 ]; then
  as_root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || {
      echo "set-up: these Debian packages are missing: ${missing[*]}" >&2
      echo "set-up: install them as root with: apt-get install ${missing[*]}" >&2
      exit 2
    }
    as_root=(sudo)
  fi
  echo "set-up: installing ${missing[*]} ${absent_optional[*]}"
  "${as_root[@]}" apt-get update -qq
  available=()
  without() { echo "set-up: optional, cannot be installed here: $1 (features that need it are disabled)"; }
  for p in "${absent_optional[@]}"; do
    if [ -n "$(apt-cache madison "$p" 2>/dev/null)" ]; then available+=("$p"); else without "$p"; fi
  done
  install() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get install -y -qq --no-install-recommends "$@" >/dev/null
  }
  if ! install "${missing[@]}" "${available[@]}"; then
    install "${missing[@]}"
    for p in "${available[@]}"; do install "$p" || without "$p"; done
  fi
fi

# npm_packages FOLDER WHAT CONSEQUENCE: installs the packages of FOLDER/package-lock.json unless that
# is done already; WHAT they are and the CONSEQUENCE of a failure are for messages
npm_packages() {
  local lock=$1/package-lock.json mark=$1/node_modules/.lock-installed
  if cmp -s "$lock" "$mark"; then return; fi
  echo "set-up: installing $2 from npm"
  if npm ci --prefix "$1" --no-audit --no-fund --loglevel=error; then
    cp "$lock" "$mark"
  else
    echo "set-up: $2 could not be installed; $3"
  fi
}

npm_packages viewer "the libraries of the 3D view and the charts" \
  "a report is tables and data then, without a page"
if [ "${1:-run}" = test ]; then
  npm_packages tests/dataset/mcap_official "independent readers of recordings" \
    "the tests that need them will be reported as skipped"
fi
