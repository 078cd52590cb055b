#!/usr/bin/env bash
# Builds the fuzz targets with clang and runs each for a time: tools/fuzz.sh [SECONDS] [TARGET...]
# (60 seconds, all targets). A finding ends it with the input's name; docs/design/testing.md says more.
set -euo pipefail
cd "$(dirname "$0")/.."
source tools/setup.sh
clearway_packages+=(clang-19 libclang-rt-19-dev libomp-19-dev llvm-19)
install_missing_packages

seconds=${1:-60}
targets=("${@:2}")
[ ${#targets[@]} -gt 0 ] ||
  targets=(las las_records laz e57 pcd ply ptx xyz mesh trajectory alignment line json packed_chunk store
    store_values result journal)

cmake --preset fuzz
cmake --build build/fuzz
work=build/fuzz/corpus
rm -rf build/fuzz/seeds
build/fuzz/tests/fuzz/fuzz_seeds build/fuzz/seeds
# What HDF5 keeps until the end of the process is no leak of ours.
# A small quarantine: freed memory is not to count against the limit of one input.
export ASAN_OPTIONS=detect_leaks=0:quarantine_size_mb=16
for target in "${targets[@]}"; do
  mkdir -p "$work/$target" build/fuzz/findings
  log=build/fuzz/findings/$target.log
  echo "== $target, $seconds s"
  if ! build/fuzz/tests/fuzz/fuzz_"$target" -max_total_time="$seconds" -timeout=10 \
      -rss_limit_mb=512 -malloc_limit_mb=256 -max_len=65536 -print_final_stats=1 \
      -artifact_prefix=build/fuzz/findings/"$target"- \
      "$work/$target" "build/fuzz/seeds/$target" >"$log" 2>&1; then
    tail -n 60 "$log" >&2
    echo "$target: a finding; the input lies in build/fuzz/findings" >&2
    exit 1
  fi
  grep -E 'number_of_executed_units|peak_rss_mb' "$log"
done
