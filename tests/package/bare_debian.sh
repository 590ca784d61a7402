#!/bin/sh
# Installs the package on a bare Debian 12 in a debootstrap folder, and makes a first image there.
# As root, with network: sh tests/package/bare_debian.sh [FOLDER]; keeps FOLDER, which must be new or an earlier one.
set -eu
cd "$(dirname "$0")/../.."
bare=${1:-build/bare}
package=$(ls build/package/foci_*.deb) || { echo "first: cmake --build --preset package, then cpack in build/package" >&2; exit 2; }
[ -x "$bare/usr/bin/apt-get" ] || debootstrap --variant=minbase bookworm "$bare" http://deb.debian.org/debian
cp "$package" "$bare/tmp/foci.deb"
chroot "$bare" sh -euc '
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends /tmp/foci.deb >/dev/null
  cd /tmp
  foci --version
  foci render /usr/share/foci/configs/demo.toml --size 320x180 --out first.png --overwrite
  foci replay /usr/share/foci/configs/demo.toml --size 320x180 --seconds 0:1 --out demo --overwrite
  test -s first.png && test -s demo/video.mp4 && grep -q "<svg" demo/report.html
  test -s /usr/share/man/man1/foci-replay.1 && test -s /usr/share/bash-completion/completions/foci'
echo "installed and ran on a bare Debian 12"
