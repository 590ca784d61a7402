#!/bin/sh
# Renders the images of docs/stability.md anew, from a full `foci chart --stability`:
#   sh docs/stability-pictures.sh                 run the suite into out/stability first
#   sh docs/stability-pictures.sh FOLDER          use an earlier full run, e.g. out/results/stability of docs/results.py --full
#   SCAN=scan.ply sh docs/stability-pictures.sh   also thin out a scan
# Needs ImageMagick with WebP.
set -eu
cd "$(dirname "$0")/.."
run=${1:-out/stability}
if [ $# -eq 0 ]; then
  build/release/foci chart --stability --out "$run" ${SCAN:+--scan "$SCAN"}
fi
from=$run/images
to=docs/stability
mkdir -p "$to"
row() {  # SCENE VALUE
  set -- "$1_$2" "$2"
  convert \( "$from/$1_reference.png" "$from/$1_sweep-lod-7.png" "$from/$1_sweep-lod-7_difference.png" \
    "$from/$1_paper-lod.png" "$from/$1_accumulate-64.png" "$from/$1_matthews.png" -resize 128x128 -bordercolor white \
    -border 2 +append \) -background white -gravity West -splice 44x0 -pointsize 13 -annotate +2+0 "$2" miff:-
}
montage_of() {  # SCENE VALUE...
  scene=$1
  shift
  { convert -size 836x18 xc:white -pointsize 13 -fill '#333' \
      -annotate +48+13 reference -annotate +180+13 sweep-lod -annotate +312+13 'difference x 8' \
      -annotate +444+13 paper-lod -annotate +576+13 accumulate:64 -annotate +708+13 matthews miff:-
    for value; do row "$scene" "$value"; done
  } | convert - -append -quality 82 "$to/$scene.webp"
}
montage_of parallel 0.005 0.001
montage_of crossing 45 5
montage_of crossing-deep 45 85
montage_of slanted 60 85
montage_of curved 0.2 0.05
montage_of density 100
montage_of patches 4 12
montage_of duplicates 16
montage_of normals 10 60
montage_of wire 0.2
montage_of sharp-before-blurred 16
montage_of blurred-before-sharp 16
montage_of close-up 0.05 0.02
montage_of near-plane 32
montage_of focus 10
montage_of point-light 10
montage_of transparent 16
montage_of crossing-layers 2 6
montage_of highlight 100
montage_of focus-sweep 40
montage_of moving-eye 3
if [ -e "$from/thinned_0.1_reference.png" ]; then montage_of thinned 0.25 0.1; fi
convert "$run/stability.png" -resize 1500x -quality 75 "$to/chart.webp"
