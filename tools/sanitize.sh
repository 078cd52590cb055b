# Sourced by tools/test.sh: builds with the sanitizers and runs the fast tests under them.

# OpenMP is seen through libomp's archer; src/core/util/tsan_annotations.hpp describes oneTBB.
thread_tests=(stream_tests cpu_tests grid_tests io_convert_tests library_tests)
# Threads that wait in a loop take the processor from those that work.
export OMP_WAIT_POLICY=passive

test_under_address_sanitizer() {
  cmake --preset asan
  cmake --build build/asan
  export LSAN_OPTIONS="suppressions=$PWD/tests/lsan.supp:print_suppressions=0"
  ctest --test-dir build/asan --output-on-failure -j "$(nproc)" -LE data --timeout 1800
}

# What the sanitizer is given, and what it is to leave out, hides no race of ours.
require_planted_races() {
  local program=build/tsan/tests/tsan/planted_race planted
  for planted in none exception; do
    "$program" "$planted"
  done
  for planted in counter "other stage" kept input loop halves; do
    if "$program" "$planted" >build/tsan/planted.log 2>&1; then
      echo "planted_race: the thread sanitizer misses '$planted'" >&2
      return 1
    fi
    grep -q 'WARNING: ThreadSanitizer: data race' build/tsan/planted.log
    echo "$planted: reported"
  done
}

test_under_thread_sanitizer() {
  local program
  cmake --preset tsan
  cmake --build build/tsan --target planted_race "${thread_tests[@]}"
  export TSAN_OPTIONS="halt_on_error=1 ignore_noninstrumented_modules=1"
  TSAN_OPTIONS+=" suppressions=$PWD/tests/tsan.supp"
  TSAN_OPTIONS+=" external_symbolizer_path=/usr/lib/llvm-19/bin/llvm-symbolizer"
  export OMP_TOOL_LIBRARIES=/usr/lib/llvm-19/lib/libarcher.so
  require_planted_races
  for program in "${thread_tests[@]}"; do
    "$(find build/tsan -type f -name "$program")"
  done
}
