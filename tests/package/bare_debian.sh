#!/bin/sh
# Installs the package on a bare Debian in a debootstrap folder, makes a first image there, and removes the package.
# As root, with network: sh tests/package/bare_debian.sh [RELEASE [FOLDER]]; RELEASE is that which the package was made
# on, bookworm or trixie; keeps FOLDER, which must be new or an earlier one.
# Where `cpack` has also made the Python module's package (build/python), it is tested as well.
set -eu
cd "$(dirname "$0")/../.."
release=${1:-bookworm}
bare=${2:-build/bare-$release}
package=$(ls build/package/foci_*.deb) || { echo "first: cmake --build --preset package, then cpack in build/package" >&2; exit 2; }
module=$(ls build/python/python3-foci_*.deb 2>/dev/null) || echo "without the Python module: build/python has no package" >&2
[ -x "$bare/usr/bin/apt-get" ] || debootstrap --variant=minbase "$release" "$bare" http://deb.debian.org/debian
rm -rf "$bare/tmp/foci" && mkdir "$bare/tmp/foci"
cp "$package" "$bare/tmp/foci/foci.deb"
[ -z "$module" ] || cp "$module" "$bare/tmp/foci/python3-foci.deb"
# /proc vanishes with the mount namespace.
env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin unshare --mount sh -euc '
  mount -t proc proc "$1/proc"
  exec chroot "$1" sh -euc "$2"' sh "$bare" '
  export DEBIAN_FRONTEND=noninteractive
  fail() { echo "$*" >&2; exit 1; }
  cd /tmp/foci
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends ./*.deb >/dev/null

  foci --version | grep -E "^foci [0-9.]+ \([0-9a-f]{7,}" || fail "--version names no commit"
  foci doctor | grep "^packages  *all installed" || fail "foci doctor: something is missing"
  foci render /usr/share/foci/configs/demo.toml --size 320x180 --out first.png
  foci replay /usr/share/foci/configs/demo.toml --size 320x180 --seconds 0:1 --out demo
  test -s first.png && test -s demo/video.mp4 && grep -q "<svg" demo/report.html

  for deb in *.deb; do
    test -s "/usr/share/doc/$(dpkg-deb -f "$deb" Package)/copyright" || fail "$deb: no licence"
  done

  commands=$(foci --help | sed -n "/^Subcommands/,\$s/^  \([a-z][a-z]*\) .*/\1/p")
  for command in $commands; do
    test -s "/usr/share/man/man1/foci-$command.1" || fail "no man page of foci $command"
  done
  [ "$(echo "$commands" | wc -l)" -ge 15 ] || fail "foci --help: too few commands: $commands"
  for completion in bash-completion/completions/foci zsh/vendor-completions/_foci fish/vendor_completions.d/foci.fish; do
    test -s "/usr/share/$completion" || fail "no /usr/share/$completion"
  done

  packages=foci
  if [ -e python3-foci.deb ]; then
    packages="foci python3-foci"
    python3 -c "
import foci, numpy
grid = numpy.stack(numpy.meshgrid(numpy.linspace(-1, 1, 61), numpy.linspace(-1, 1, 61), [-1.0]), -1).reshape(-1, 3)
scene = foci.Scene.from_points(grid)
image = foci.render(scene, foci.Eye(), foci.Screen(), focus_m=1.0, size_px=(160, 90))
assert image.rgb.shape == (90, 160, 3) and abs(image.depth_m[45, 80] - 1) < 0.01
image.save(\"module.png\")"
    test -s module.png
  fi

  # shellcheck disable=SC2086  # a list of words
  apt-get remove -y -qq $packages >/dev/null
  left=$(find / -xdev -path /tmp -prune -o -name "*foci*" -print)
  [ -z "$left" ] || fail "left behind: $left"'
echo "installed, ran and left nothing on a bare Debian ($release)"
