#!/bin/sh
# The test command: installs, builds and runs every test, checks style, and repeats the tests under the
# address, undefined-behaviour and thread sanitizers. A second run builds only what changed.
set -eu
cd "$(dirname "$0")/.."
sh app/install.sh --tests
if command -v ccache >/dev/null 2>&1; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
step() { printf '\n== %s\n' "$*"; }
# The unit tests of a build that a filter names, many to a process: with a sanitizer a start takes as long as most.
unitTests() {
  seq 0 7 | xargs -P 2 -I{} env GTEST_TOTAL_SHARDS=8 GTEST_SHARD_INDEX={} "$1/foci_tests" --gtest_brief=1 \
    --gtest_filter="$2"
}

step "style"
find app base calibration gaze render tests -name '*.h' -o -name '*.cpp' | xargs clang-format --dry-run --Werror

step "release: build and test"
cmake --preset release -DFOCI_TESTS=ON >/dev/null
cmake --build --preset release
ctest --test-dir build/release --output-on-failure -j 2

step "lint"
# The sanitizers' build joins sources of one library, so that the headers are read once for eight of them.
cmake --preset asan -DFOCI_TESTS=ON >/dev/null
grep -o '"file": "[^"]*"' build/asan/compile_commands.json | cut -d'"' -f4 | grep -v "^$PWD/tests/" | sort -u |
  xargs -P 2 -n 2 clang-tidy -p build/asan --quiet --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-shadow

export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=suppressions=$PWD/tests/tsan.supp:halt_on_error=1
step "asan: build and test"
cmake --preset asan -DFOCI_TESTS=ON >/dev/null
cmake --build --preset asan --target foci foci_tests foci_e2e foci_stability_tests
# Not the windows, whose time goes into the OpenGL library; nor the three longest runs from end to end, whose parts
# have tests of their own.
unitTests build/asan '-AutoOnTheChart.*'
ctest --test-dir build/asan --output-on-failure -j 2 -LE unit \
  -E '^Window|^Reproduce.WritesTheTable|^Webcam.CalibratedOnAFilmed'

step "tsan: build and test"
cmake --preset tsan -DFOCI_TESTS=ON >/dev/null
cmake --build --preset tsan --target foci_tests
# What has threads of its own, and every method at several numbers of them.
unitTests build/tsan '*Thread*:*Live*:*Stereo*:*Session*:*Socket*:*Feed*:*Record*:*Source*:*Progress*'

step "hostile input: each reader's corpus, then half a minute of fuzzing"
tests/fuzz/run.sh 30

step "all passed"
