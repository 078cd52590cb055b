#!/usr/bin/env bash
# Builds Clearway and runs all tests, after installing missing packages (Debian 12 or 13).
# CLEARWAY_WERROR=ON treats warnings of the compiler as errors.
# CLEARWAY_TEST_DATA=FOLDER adds the tests on real scans; without it they are skipped and say so.
# --all adds what takes longer: every property of every question, kills by the dozen, the experiments
# and their charts, man pages, and packages in fresh systems.
# --sanitize runs the fast tests under the address, undefined-behaviour and thread sanitizers instead.
set -euo pipefail
cd "$(dirname "$0")/.."
source tools/setup.sh
which=()
case "${1:-}" in
  "") ;;
  --all) which=(-C All); CLEARWAY_DRAW= ;;
  --sanitize)
    source tools/sanitize.sh
    clearway_packages+=(clang-19 libclang-rt-19-dev libomp-19-dev llvm-19)
    install_missing_packages
    test_under_address_sanitizer
    test_under_thread_sanitizer
    exit
    ;;
  *)
    echo "usage: tools/test.sh [--all|--sanitize]" >&2
    exit 2
    ;;
esac
install_missing_packages

configure_release -DCLEARWAY_TESTS=ON -DCLEARWAY_BENCHMARKS=ON -DCLEARWAY_PYTHON=AUTO \
  -DCLEARWAY_CUDA=AUTO
cmake --build build/release

# Tests run side by side, so OpenMP's threads sleep while they wait, and do not spin.
export OMP_WAIT_POLICY=passive
log=build/release/ctest.log
status=0
# Which two properties of each question are tried (tests/commands/README.md); all of them if it is empty.
export CLEARWAY_DRAW=${CLEARWAY_DRAW-$(git rev-parse HEAD 2>/dev/null || true)}
# Two more than there are cores, since some wait for others to end or to be killed.
ctest --test-dir build/release "${which[@]}" --output-on-failure -j $(($(nproc) + 2)) 2>&1 | tee "$log" || status=$?
# Tests of optional programs, as Slurm's, may skip; tests on real scans may not when these are given.
if [ -n "${CLEARWAY_TEST_DATA:-}" ]; then
  on_data=$(ctest --test-dir build/release -N -L data | sed -n 's/^ *Test *#[0-9]*: //p')
  skipped=$(sed -n 's/^.*[0-9] - \(.*\) (Skipped)$/\1/p' "$log" | grep -Fx "$on_data" || true)
  if [ -n "$skipped" ]; then
    echo "Skipped although CLEARWAY_TEST_DATA is set: $skipped" >&2
    exit 1
  fi
fi
if [ "${1:-}" = --all ]; then
  tests=tests/tools/cli
  /usr/bin/python3 "$tests/resume/kill_and_resume.py" build/release/tools/clearway --kills 24 || status=$?
  /usr/bin/python3 "$tests/campaign/kill_campaign.py" build/release/tools/clearway --kills 48 || status=$?
  # Where there is no debootstrap or mirror, the packages cannot be tried, which is said.
  tools/package.sh && tools/test_package.sh || { code=$?; [ "$code" = 77 ] || status=$code; }
fi
exit "$status"
