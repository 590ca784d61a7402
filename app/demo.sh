#!/bin/sh
# The first command: installs, builds and replays the built-in study. A second run is fast.
set -eu
cd "$(dirname "$0")/.."
sh app/install.sh
[ -f build/release/build.ninja ] || cmake --preset release -DFOCI_TESTS=OFF >/dev/null
cmake --build --preset release --target foci
build/release/foci replay configs/demo.toml --out out/demo
echo "The report: $(pwd)/out/demo/report.html"
