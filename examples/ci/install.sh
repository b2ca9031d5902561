#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs Lidarena: a Debian package on Debian 12, or a wheel into a virtual environment.
# usage: install.sh PACKAGE [ENVIRONMENT]
# PACKAGE is a .deb or .whl. A wheel goes into ENVIRONMENT (default: lidarena-env); the folder of its
# command is printed as the last line.
set -euo pipefail
package=${1:?usage: install.sh PACKAGE [ENVIRONMENT]}
environment=${2:-lidarena-env}
[ -f "$package" ] || {
  echo "install.sh: $package does not exist" >&2
  exit 2
}
case $package in
*.deb)
  as_root=()
  [ "$(id -u)" = 0 ] || as_root=(sudo)
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" apt-get install -y -qq --no-install-recommends "$(realpath "$package")"
  dirname "$(command -v lidarena)"
  ;;
*.whl)
  python3 -m venv "$environment"
  "$environment/bin/pip" install --quiet "$package"
  realpath "$environment/bin"
  ;;
*)
  echo "install.sh: $package is neither a .deb nor a .whl" >&2
  exit 2
  ;;
esac
