#!/bin/sh
# Fuzzes the readers: tests/fuzz/run.sh [SECONDS [TARGET...]]
# Builds the fuzzers, runs each one on its corpus (tests/fuzz/corpus), and then fuzzes for SECONDS (default
# 30). Two fuzzers run at the same time. SEED in the environment sets the seed (default 1; 0: random), so that
# the same commit takes the same path. New inputs and findings (TARGET-crash-*) go to out/fuzz.
set -eu
cd "$(dirname "$0")/../.."
seconds=${1:-30}
[ $# -gt 0 ] && shift
cmake --preset asan >/dev/null
cmake --build --preset asan --target foci_fuzz
[ $# -gt 0 ] || set -- $(ls tests/fuzz/corpus)
mkdir -p out/fuzz
export SEED="${SEED:-1}" ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1

one=$(mktemp)
trap 'rm -f "$one"' EXIT
cat >"$one" <<'EOF'
target=$1 seconds=$2
export FOCI_FUZZER="$target"
found=out/fuzz/$target
mkdir -p "$found"
# The harness limits each read in processor time. This timeout ends a read that never returns.
limits="-timeout=20 -rss_limit_mb=2048 -max_len=65536 -artifact_prefix=out/fuzz/$target-"
if build/asan/foci_fuzz $limits -runs=0 tests/fuzz/corpus/$target >"$found.log" 2>&1 &&
  { [ "$seconds" -eq 0 ] ||
    build/asan/foci_fuzz $limits -seed="$SEED" -max_total_time="$seconds" -print_final_stats=1 "$found" \
      tests/fuzz/corpus/$target >"$found.log" 2>&1; }; then
  echo "$target: $(grep -c . "$found.log") lines, $(sed -n 's/^stat::number_of_executed_units: *//p' "$found.log") runs, nothing found"
else
  echo "$target: FAILED"
  grep -v '^#' "$found.log" | tail -n 40
  exit 1
fi
EOF
printf '%s\n' "$@" | xargs -P 2 -I TARGET sh "$one" TARGET "$seconds"
