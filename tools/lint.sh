#!/usr/bin/env bash
# Checks the sources with clang-format and clang-tidy, where they are installed. A check that is
# asked for by its name fails where its program is not.
# Usage: tools/lint.sh [format|tidy]
set -euo pipefail
cd "$(dirname "$0")/.."

missing=1  # what a check without its program returns

check_format() {
  if ! command -v clang-format >/dev/null; then
    echo "clang-format is not installed: the format is not checked." >&2
    return "$missing"
  fi
  git ls-files -z '*.cpp' '*.hpp' '*.cu' | xargs -0 clang-format --dry-run -Werror
  echo "clang-format: clean"
}

# The sources of a folder are read as one, which takes a fraction of the time.
check_tidy() {
  # Older ones do not know the deduction of template arguments of aggregates.
  if ! command -v clang-tidy-19 >/dev/null; then
    echo "clang-tidy-19 is not installed: the sources are not checked with it." >&2
    return "$missing"
  fi
  source tools/setup.sh
  install_missing_packages
  cmake --preset release -B build/lint -DCLEARWAY_CUDA=OFF -DCLEARWAY_TESTS=OFF \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
  cmake --build build/lint --target clearway_report_page >/dev/null
  local sources
  mapfile -t sources < <(/usr/bin/python3 -c '
import json
for entry in json.load(open("build/lint/compile_commands.json")):
    print(entry["file"])')
  printf '%s\0' "${sources[@]}" |
    nice -n 5 xargs -0 -P "$(nproc)" -n 1 clang-tidy-19 -p build/lint --quiet \
      --checks=-bugprone-suspicious-include --warnings-as-errors='*'
  echo "clang-tidy: clean"
}

case "${1:-all}" in
  all) missing=0; check_format; check_tidy ;;
  format) check_format ;;
  tidy) check_tidy ;;
  *) echo "usage: tools/lint.sh [format|tidy]" >&2; exit 2 ;;
esac
