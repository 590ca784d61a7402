#!/bin/sh
# Installs the wheel (python/wheel.py) in a virtual environment on a bare Debian in a debootstrap folder: the module
# renders, the command replays a study and writes its video by the program ffmpeg.
# As root, with network: sh tests/package/wheel.sh [RELEASE [FOLDER]]; keeps FOLDER, which must be new or an earlier one.
set -eu
cd "$(dirname "$0")/../.."
release=${1:-bookworm}
bare=${2:-build/bare-python-$release}
wheel=$(ls build/wheel/foci-*.whl) || { echo "first: python3 python/wheel.py (CONTRIBUTING.md)" >&2; exit 2; }
[ -x "$bare/usr/bin/apt-get" ] || debootstrap --variant=minbase "$release" "$bare" http://deb.debian.org/debian
rm -rf "$bare/tmp/foci" && mkdir "$bare/tmp/foci"
cp "$wheel" configs/demo.toml "$bare/tmp/foci"
cp -r tests/python "$bare/tmp/foci/tests"
# /proc vanishes with the mount namespace.
env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin unshare --mount sh -euc '
  mount -t proc proc "$1/proc"
  exec chroot "$1" sh -euc "$2"' sh "$bare" '
  export DEBIAN_FRONTEND=noninteractive
  fail() { echo "$*" >&2; exit 1; }
  cd /tmp/foci
  apt-get update -qq
  # NumPy is Debian'\''s: PyPI need not be reached.
  apt-get install -y -qq --no-install-recommends python3-venv python3-numpy ffmpeg gnuplot-nox >/dev/null
  python3 -m venv --system-site-packages --clear venv
  venv/bin/pip install -q --no-index ./foci-*.whl
  cd tests
  ../venv/bin/python -m unittest foci_test stubs_test
  cd ..
  venv/bin/python -m foci --version | grep -E "^foci [0-9.]+ \([0-9a-f]{7,}" || fail "python -m foci --version names no commit"
  venv/bin/foci replay demo.toml --size 320x180 --seconds 0:1 --out demo
  ffprobe -v error -count_frames -show_entries stream=codec_name,nb_read_frames -of csv=p=0 demo/video.mp4 | tee video
  grep -q "^h264,[1-9]" video || fail "no video in H.264 by ffmpeg"
  grep -q "<svg" demo/report.html || fail "no plots in the report"'
echo "the wheel runs in a virtual environment of a bare Debian ($release)"
