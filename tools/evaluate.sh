#!/usr/bin/env bash
# Builds Clearway, measures the experiments of clearway-bench and tools/certainty.py, and draws their
# charts: the whole evaluation of docs/design/evaluation.md. Installs missing packages (Debian 12 or
# 13). Run again, it goes on where it was stopped; another commit needs another FOLDER, or --force,
# which removes the outputs of before.
# Usage: tools/evaluate.sh [--force] [small|full] FOLDER
# Output: FOLDER/EXPERIMENT.json, FOLDER/charts; scenes and stores stay in FOLDER/work.
set -euo pipefail
experiments=(table threads grid datasets points accuracy stability scaling surfaces seen section)
force=no
if [ "${1:-}" = --force ]; then
  force=yes
  shift
fi
size=small
case "${1:-}" in small | full)
  size=$1
  shift
  ;;
esac
if [ $# -ne 1 ] || [ "${1#-}" != "$1" ]; then
  echo "usage: tools/evaluate.sh [--force] [small|full] FOLDER" >&2
  exit 2
fi
mkdir -p "$1"
folder=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
source tools/setup.sh
install_missing_packages

configure_release -DCLEARWAY_BENCHMARKS=ON -DCLEARWAY_PYTHON=ON -DCLEARWAY_CUDA=AUTO
cmake --build build/release --target clearway-bench clearway_python

if [ $force = yes ]; then (cd "$folder" && rm -rf work certainty.json "${experiments[@]/%/.json}"); fi
for experiment in "${experiments[@]}"; do
  printf '\n== %s\n' "$experiment"
  build/release/tools/clearway-bench "$experiment" -o "$folder/$experiment.json" \
    --work "$folder/work" --size "$size" --resume
done
printf '\n== certainty\n'
if [ ! -e "$folder/certainty.json" ]; then
  PYTHONPATH=build/release/python tools/certainty.py build/release/tools/clearway \
    -o "$folder/certainty.json" --size "$size"
fi
printf '\n== charts\n'
tools/charts.py "$folder" -o "$folder/charts"
printf '\nAll experiments at size %s took %d min %d s.\n' "$size" $((SECONDS / 60)) $((SECONDS % 60))
