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

step "style"
find app calibration gaze render tests -name '*.h' -o -name '*.cpp' | xargs clang-format --dry-run --Werror

step "release: build and test"
cmake --preset release -DFOCI_TESTS=ON >/dev/null
cmake --build --preset release
ctest --test-dir build/release --output-on-failure -j 2

step "lint"
find app calibration gaze render -name '*.cpp' | sort |
  xargs -P 2 -n 4 clang-tidy -p build/release --quiet --extra-arg=-Wno-unknown-warning-option

export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=suppressions=$PWD/tests/tsan.supp:halt_on_error=1
for sanitizer in asan tsan; do
  step "$sanitizer: build and test"
  cmake --preset "$sanitizer" -DFOCI_TESTS=ON >/dev/null
  cmake --build --preset "$sanitizer" --target foci foci_tests foci_e2e foci_stability_tests
  # Not the windows: what they spend their time in is the OpenGL library.
  ctest --test-dir "build/$sanitizer" --output-on-failure -j 2 -E '^Window'
done

step "hostile input: each reader's corpus, then half a minute of fuzzing"
tests/fuzz/run.sh 30

step "all passed"
