#!/usr/bin/env bash
# Clones this repository into fresh systems of Debian's releases, runs tools/demo.sh there and compares
# its answer with the one that README.md shows. Prints the minutes that it took.
#   tools/test_releases.sh [--tests] [RELEASE...]
# Without names: bookworm and trixie. --tests also runs tools/test.sh, and prints how many tests ran
# and which were skipped. What is not committed is not tested, and nothing is built with CUDA.
# A release takes 3 GB below TMPDIR, which are removed. Where root, debootstrap or a mirror is missing
# the script says so and ends with 77. CLEARWAY_TEST_DATA=FOLDER adds the tests on real scans, and
# with CCACHE_DIR=FOLDER what is compiled is kept there.
set -euo pipefail
source_folder=$(cd "$(dirname "$0")/.." && pwd)
name=test_releases
source "$source_folder/tools/chroot.sh"
own_mounts "$0" "$@"

tests=no releases=()
for word in "$@"; do
  case $word in
    --tests) tests=yes ;;
    -*) echo "usage: tools/test_releases.sh [--tests] [RELEASE...]" >&2; exit 2 ;;
    *) releases+=("$word") ;;
  esac
done
[ ${#releases[@]} -gt 0 ] || releases=(bookworm trixie)
find_mirror

# in_clone COMMAND: runs the command in the clone, with its output in `log`, and sets `minutes`.
in_clone() {
  local TIMEFORMAT='%R %U %S'
  log=$scratch/clone.log
  { time as_root env "${settings[@]}" bash -c "cd /clearway && $1" >"$log" 2>&1; } \
    2>"$scratch/time" || {
    tail -50 "$log" >&2
    fail "$tested: $1 failed"
  }
  minutes=$(awk '{ printf "%.1f min (%.1f of processor time)", $1 / 60, ($2 + $3) / 60 }' \
    "$scratch/time")
}

# Shares a folder of this machine with the system.
share() {
  mkdir -p "$root$2"
  mount --bind "$1" "$root$2"
}

test_release() {
  tested=$1 settings=(LC_ALL=C.UTF-8)
  make_root "$tested"
  install_in_chroot git ca-certificates
  if [ -n "${CCACHE_DIR:-}" ]; then
    install_in_chroot ccache
    share "$CCACHE_DIR" /ccache
    settings+=(CCACHE_DIR=/ccache CCACHE_BASEDIR=/clearway CCACHE_NOHASHDIR=yes
      CMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  if [ -n "${CLEARWAY_TEST_DATA:-}" ]; then
    share "$CLEARWAY_TEST_DATA" /data
    settings+=(CLEARWAY_TEST_DATA=/data)
  fi
  git clone --quiet "$source_folder" "$root/clearway"
  as_root git config --global --add safe.directory /clearway

  in_clone 'source tools/setup.sh && install_missing_packages "${program_packages[@]}"'
  echo "$name: $tested: the packages of the demo took $minutes"
  in_clone tools/demo.sh
  grep -F "2 conflicts of 6,128 points along 328 m of path" "$log" ||
    fail "$tested: the demo has another answer: $(grep 'conflicts of' "$log")"
  echo "$name: $tested: the demo took $minutes"
  if [ $tests = yes ]; then
    in_clone 'source tools/setup.sh && install_missing_packages'
    echo "$name: $tested: the packages of the tests took $minutes"
    in_clone tools/test.sh
    echo "$name: $tested: the tests took $minutes: $(grep 'tests passed' "$log")"
    sed -n 's/^.*[0-9] - \(.*\) (Skipped)$/skipped: \1/p' "$log"
  fi
}

for tested in "${releases[@]}"; do test_release "$tested"; done
