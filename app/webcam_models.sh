#!/bin/sh
# Gets the networks of the webcam tracker: sh app/webcam_models.sh [PACKAGE.tgz]
# They are BlazeFace, Face Mesh and Iris of MediaPipe, from an npm package (MIT). foci reads them as ONNX from the user's
# data folder, where the licence lies beside them. Needs Python 3, and npm unless the package's file is given.
set -eu
package=@vladmandic/human
version=3.3.6
sha256=425e9c51dbbca0c8934362b170cb0d54c2529c11c654b3c03092b16e9d6ad3f7

fail() { echo "foci: $*" >&2; exit 1; }
here=$(cd "$(dirname "$0")" && pwd)
folder=${XDG_DATA_HOME:-$HOME/.local/share}/foci/webcam
stamp="$package $version $sha256"
[ "$#" -le 1 ] || { echo "usage: app/webcam_models.sh [PACKAGE.tgz]" >&2; exit 2; }
if [ -f "$folder/source.txt" ] && [ "$(cat "$folder/source.txt")" = "$stamp" ]; then
  echo "The networks are in $folder"
  exit 0
fi
command -v python3 >/dev/null 2>&1 || fail "python3 is missing: it converts the networks"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM HUP
if [ "$#" -eq 1 ]; then
  [ -f "$1" ] || fail "$1: no such file: expected $package-$version as npm packs it"
  cp "$1" "$work/package.tgz"
else
  command -v npm >/dev/null 2>&1 ||
    fail "npm is missing: install it, or give the file that 'npm pack $package@$version' makes elsewhere"
  (cd "$work" && npm pack --silent "$package@$version" >/dev/null) || fail "npm cannot get $package $version"
  mv "$work"/*.tgz "$work/package.tgz"
fi
echo "$sha256  $work/package.tgz" | sha256sum --check --status ||
  fail "the package is not $package $version: its SHA-256 is not $sha256"
tar -xzf "$work/package.tgz" -C "$work" package/LICENSE package/models/blazeface.json package/models/blazeface.bin \
  package/models/facemesh.json package/models/facemesh.bin package/models/iris.json package/models/iris.bin
grep -q "MIT License" "$work/package/LICENSE" || fail "the licence of $package is not the MIT licence any more"
mkdir -p "$folder"
for model in blazeface facemesh iris; do
  python3 "$here/webcam_models.py" "$work/package/models/$model.json" "$folder/$model.onnx"
done
{
  echo "Networks of MediaPipe (Google, Apache License 2.0), converted from $package $version, whose licence follows."
  echo
  cat "$work/package/LICENSE"
} >"$folder/LICENSE"
echo "$stamp" >"$folder/source.txt"
echo "The networks are in $folder"
