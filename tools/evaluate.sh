#!/usr/bin/env bash
# Builds Clearway, measures the experiments of tools/experiments.py, and draws their charts: the whole
# evaluation of docs/design/evaluation.md. Installs missing packages (Debian 12 or 13). Run again, it
# goes on where it was stopped; another build needs another FOLDER, or --force, which removes the
# outputs of before.
# Usage: tools/evaluate.sh [--force] [--only NAME,...] [small|full] FOLDER
# --only: these of the experiments below, so that a machine that is there for some minutes can do a part;
#   the charts are drawn of all that FOLDER has.
# Output: FOLDER/EXPERIMENT.json, FOLDER/charts; scenes and stores stay in FOLDER/work.
# Other libraries are measured where they are installed: tools/bench/peers/programs.
set -euo pipefail
experiments=(table threads grid points accuracy stability share surfaces seen section peers ablation
  outofcore certainty)
force=no only= size=small
while [ $# -gt 1 ]; do
  case $1 in
    --force) force=yes ;;
    --only) only=,$2, && shift ;;
    small | full) size=$1 ;;
    *) break ;;
  esac
  shift
done
if [ $# -ne 1 ] || [[ $1 =~ ^(-.*|small|full)$ ]]; then
  echo "usage: tools/evaluate.sh [--force] [--only NAME,...] [small|full] FOLDER" >&2
  exit 2
fi
mkdir -p "$1"
folder=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
source tools/setup.sh
install_missing_packages

configure_release -DCLEARWAY_BENCHMARKS=ON -DCLEARWAY_PYTHON=ON -DCLEARWAY_CUDA=AUTO -DCLEARWAY_PEERS=ON
cmake --build build/release --target clearway-bench clearway_peers clearway_python

if [ $force = yes ]; then
  (cd "$folder" && rm -rf work "${experiments[@]/%/.json}")
fi
# Seconds after which a case is stopped, which then has failed.
limit=6
[ "$size" = small ] || limit=60
# The scenes of an experiment that could take others too.
declare -A scenes=([seen]=hall,mine [section]=hall [ablation]=hall,tunnel)
wanted() { [ -z "$only" ] || [[ $only == *,$1,* ]]; }
for experiment in "${experiments[@]}"; do
  wanted "$experiment" || continue
  printf '\n== %s\n' "$experiment"
  PYTHONPATH=build/release/python tools/experiments.py build/release/tools "$experiment" -o "$folder/$experiment.json" \
    --work "$folder/work" --size "$size" --limit $limit --resume \
    ${scenes[$experiment]:+--scenes "${scenes[$experiment]}"}
done
printf '\n== charts\n'
tools/charts.py "$folder" -o "$folder/charts"
printf '\nAt size %s this took %d min %d s.\n' "$size" $((SECONDS / 60)) $((SECONDS % 60))
