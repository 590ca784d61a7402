#!/bin/sh
# The test command: tests/run.sh [--all]. A second run builds only what changed.
# Installs missing packages, checks style, then builds and runs all tests of the release preset.
# --all also attacks the program (tests/attacks), runs clang-tidy, repeats the tests under sanitizers (address, undefined
# behaviour, threads), and fuzzes.
set -eu
cd "$(dirname "$0")/.."
case "${1:-}" in
  "") all= ;;
  --all) all=--all ;;
  *) echo "usage: tests/run.sh [--all]" >&2; exit 2 ;;
esac
sh app/install.sh "${all:---tests}"
if command -v ccache >/dev/null 2>&1; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
  export CCACHE_SLOPPINESS=pch_defines,time_macros  # or it would not cache what uses precompiled headers
fi
step() { printf '\n== %s  (%s)\n' "$*" "$(date +%H:%M)"; }

if command -v npm >/dev/null 2>&1; then
  step "networks of the webcam tracker"
  sh app/webcam_models.sh || echo "not there: their tests are skipped"
fi

# Other versions format and find other things: $1 is of the version that CONTRIBUTING.md states.
is_ours() {
  "$1" --version | grep -q 'version 14\.' && return
  echo "left out: expected $1 14, found $("$1" --version | grep -m 1 -o 'version [0-9.]*')"
  return 1
}

step "style"
if is_ours clang-format; then
  find app base calibration examples gaze python render tests -name '*.h' -o -name '*.cpp' |
    xargs clang-format --dry-run --Werror
fi

step "release: build and test"
# With --all the Python module shares the libraries, which are then position-independent.
# shellcheck disable=SC2086  # a list of words
cmake --preset release -DFOCI_TESTS=ON \
  ${all:+-DFOCI_PYTHON=ON -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DPython_EXECUTABLE=/usr/bin/python3} >/dev/null
cmake --build --preset release
ctest --test-dir build/release --output-on-failure -j 2
if [ -z "$all" ]; then
  step "all passed (tests/run.sh --all also runs attacks, lint, sanitizers and fuzzing)"
  exit 0
fi

# The tests of a program that a filter names, in eight processes: a sanitized program takes long to start.
sanitized() {
  seq 0 7 | xargs -P 2 -I{} env GTEST_TOTAL_SHARDS=8 GTEST_SHARD_INDEX={} "$1" --gtest_brief=1 --gtest_filter="$2"
}
# clang-tidy for the libraries and the program: for what changed after the commit of tests/linted, up to which it finds
# nothing, or for all if git does not know that commit or .clang-tidy changed. The asan preset joins the sources of a
# folder, so that their headers are read once; a change means the whole folder.
lint() {
  grep -o '"file": "[^"]*"' build/asan/compile_commands.json | cut -d'"' -f4 | grep -v "/tests/" | sort -u >build/asan/sources
  if git diff --quiet "$(cat tests/linted)" -- .clang-tidy 2>/dev/null; then
    git diff --name-only "$(cat tests/linted)" -- '*.h' '*.cpp' | sed -E 's:(-inl)?\.h$:.cpp:' | while read -r file; do
      printf '/%s\nunity_%s_cxx\n' "$file" "$(dirname "$file" | tr / _)"
    done | sort -u | grep -F -f - build/asan/sources || true
  else
    cat build/asan/sources
  fi | xargs -r -P 2 -n 2 clang-tidy -p build/asan --quiet
}

step "attacks"
python3 tests/attacks/attacks.py build/release/foci

step "lint, and beside it, since it mostly waits, the workflow on a real SLURM"
python3 tests/batch/slurm_test.py build/release/foci &
slurm=$!
cmake --preset asan -DFOCI_TESTS=ON >/dev/null
if is_ours clang-tidy; then lint; fi

export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:allocator_may_return_null=1
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=suppressions=$PWD/tests/tsan.supp:halt_on_error=1
step "asan: build and test"
cmake --build --preset asan --target foci foci_tests foci_e2e foci_fuzz
wait $slurm || [ $? -eq 77 ]
# Without the longest tests, whose time goes into libraries or into whole pictures; of the program, what reads input.
sanitized build/asan/foci_tests '-*Aberration*:Alignment.*:Auto*.*Predict*:AutoTest.APassed*:AutoTest.RendersSub*:AutoTest.Spreads*:CascadeTracker.F*:ClosedSurfaces.*:*Ellipses.*raytrace*:FaceFinder.FindsBoth*:FaceNetworks.TheIris*:Fidelity.A*:Framing.AS*:*GaussianCaptures*:GltfLimits.I*:*GpuCapture*:GpuGaussianPicture.*:GpuPicture.*:GpuWindows.Larger*:HardFaces.*:HeatMap.OfG*:KeptFrame.TheTexture*:Label*.Agrees*:Label*.IsNotWorse*:LevelKernels.*:MakeStatue.*:Mulder.P*:*NetworkTracker.*:PartsOfAMesh.*:PlanChart.H*:PrepareScene.*:Raytrace.A*:RenderImage.*:SurfaceQuery.F*:SurfelsFromPoints.*:SweepLod.*'
sanitized build/asan/foci_e2e '*BadInputs*:BadUsage*:Batch.Refuse*:Calibrat*:Figures*:HostileInputs*:Overwrite*:Recordings*:Replay.*:ReplayOfAH*:ReplayOfE*:Trace*-HostileInputs.AMeshHasLimits'

step "tsan: build and test"
# What has threads of its own, and every method at several numbers of threads.
threads='Thread|Live|Stereo|Session|Socket|Feed|Record|Source|Progress'
cmake --preset tsan -DFOCI_TESTS=ON -DFOCI_TESTS_NAMED="$threads" >/dev/null
cmake --build --preset tsan --target foci_tests
sanitized build/tsan/foci_tests "*$(echo "$threads" | sed 's/|/*:*/g')*"

step "hostile input: each reader's corpus, then some seconds of fuzzing"
tests/fuzz/run.sh 8

step "all passed"
