#!/bin/sh
# Installs the Debian packages that foci needs and that are missing: app/install.sh [--tests | --all]
# --tests: also those of the tests; --all: also those of tests/run.sh --all.
# Works as root or through sudo; says what is missing otherwise.
set -eu
case "${1:-}" in
  "") parts=1 ;;
  --tests) parts=2 ;;
  --all) parts=3 ;;
  *) echo "usage: app/install.sh [--tests | --all]" >&2; exit 2 ;;
esac
wanted=$(awk -v parts="$parts" '/^---$/ { part++ } /^[a-z]/ && part < parts' "$(dirname "$0")/packages.txt")

missing=
for package in $wanted; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' ||
    missing="$missing $package"
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" -eq 0 ]; then
  as_root=
elif command -v sudo >/dev/null 2>&1; then
  as_root=sudo
else
  echo "foci: these packages are missing, and neither root nor sudo is at hand:$missing" >&2
  echo "foci: as root, run: apt-get install --no-install-recommends$missing" >&2
  exit 1
fi
echo "foci: installing$missing" >&2
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -qq
# shellcheck disable=SC2086  # a list of words
$as_root apt-get install -y -qq --no-install-recommends $missing >/dev/null
