#!/usr/bin/env bash
# Builds Clearway, makes the scan of a road through a village, and checks whether a lorry with a high
# load passes, from the scan to a report for any browser. Installs missing packages (Debian 12 or 13).
# Output: the folder demo/.
# Usage: tools/demo.sh [road|hall|plant|mine|tunnel] [POINTS]
set -euo pipefail
cd "$(dirname "$0")/.."
kind=${1:-road}
points=${2:-2000000}
source tools/setup.sh
install_missing_packages "${program_packages[@]}"

# The program alone, with CUDA where there is a GPU. What the tests have configured stays as it is.
if [ ! -e build/release/build.ninja ]; then
  cuda=OFF
  if nvidia-smi >/dev/null 2>&1; then cuda=AUTO; fi
  configure_release -DCLEARWAY_TESTS=OFF -DCLEARWAY_BENCHMARKS=OFF -DCLEARWAY_PYTHON=OFF \
    -DCLEARWAY_CUDA=$cuda
fi
cmake --build build/release --target clearway
clearway=build/release/tools/clearway
out=demo/$kind

step() { printf '\n== %s\n' "$*"; "$@"; }
step $clearway scene "$kind" --points "$points" -o "$out" --force
step $clearway check "$out/environment.las" --model "$out/model.ply" \
  --trajectory "$out/trajectory.txt" --radius 0.1 --title "Clearway demo: $kind" -o "$out/site" \
  --force
