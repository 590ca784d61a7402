#!/bin/sh
# Makes docs/live.webp, the first image of README.md: an observer looks around the gallery.
# foci replays the gaze, because a replay has an even frame rate; the frames equal those of a live run (docs/live.md).
# Needs ImageMagick with WebP: sh docs/live-animation.sh
set -eu
cd "$(dirname "$0")/.."
out=$(mktemp -d)
trap 'rm -r "$out"' EXIT
cat >"$out/study.toml" <<'STUDY'
seed = 7
[scene]
builtin = "gallery"
background = [0.012, 0.013, 0.016]
[observer]
pupil_mm = 6
[gaze]
source = "gaze.tsv"
[render]
method = "sweep-lod"
[output]
size_px = [480, 270]
fps = 10
marker = true
images = true
STUDY
# Leaf, image on the wall, ring, leaf: x and y in px of the screen, and the time until which gaze stays there.
awk 'BEGIN {
  print "time_s\tx_px\ty_px"
  split("150 700 1.8 864 240 3.6 330 380 5.2 1090 180 6.8 150 700 7.5", p)
  for (i = 0; i < 750; ++i) {
    while (i / 100 >= p[3 * k + 3]) ++k
    printf "%.2f\t%.1f\t%.1f\n", i / 100, p[3 * k + 1], p[3 * k + 2]
  }
}' >"$out/gaze.tsv"
build/release/foci replay "$out/study.toml" --out "$out/replay" >/dev/null
convert -delay 10 -loop 0 "$out"/replay/frame-*.png -quality 55 -define webp:method=6 docs/live.webp
ls -l docs/live.webp
