# Sourced by tools/test.sh: builds with the sanitizers and runs the fast tests under them.

# OpenMP is seen through libomp's archer; HandOver (src/core) tells of oneTBB's pipelines.
thread_tests=(stream_tests cpu_tests grid_tests io_convert_tests)

test_under_address_sanitizer() {
  cmake --preset asan
  cmake --build build/asan
  ctest --test-dir build/asan --output-on-failure -j "$(nproc)" -LE data --timeout 1800
}

test_under_thread_sanitizer() {
  local program
  cmake --preset tsan
  cmake --build build/tsan --target "${thread_tests[@]}"
  export TSAN_OPTIONS="halt_on_error=1 ignore_noninstrumented_modules=1"
  TSAN_OPTIONS+=" suppressions=$PWD/tests/tsan.supp"
  export OMP_TOOL_LIBRARIES=/usr/lib/llvm-14/lib/libarcher.so
  for program in "${thread_tests[@]}"; do
    "$(find build/tsan -type f -name "$program")"
  done
}
