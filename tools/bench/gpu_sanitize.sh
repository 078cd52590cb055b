#!/usr/bin/env bash
# Runs the CUDA engines on a small scene under compute-sanitizer: memcheck, racecheck and initcheck.
# Usage: tools/bench/gpu_sanitize.sh PROGRAM FOLDER
set -uo pipefail
program=$1 folder=$2 failed=0
"$program" scene hall -o "$folder" --points 20000 --model-points 2000 --poses 200 --force >/dev/null 2>&1 || exit 1
"$program" convert "$folder/environment.las" -o "$folder/site.h5" --cell-points 1000 --force >/dev/null 2>&1 || exit 1
ask=(run --env "$folder/site.h5" --model "$folder/model.ply" --trajectory "$folder/trajectory.txt" --radius 0.1
  -o "$folder/out.h5" --force --device cuda --device-memory 256M)
for tool in memcheck racecheck initcheck; do
  for mode in "--engine sweep" "--engine sweep --first-pose" "--engine sweep --between-poses" "--engine sweep --clearance 0.3" \
    "--engine sweep --clearance 0.3 --first-pose" "--engine sweep --between-poses --first-pose" \
    "--engine grid" "--engine grid --first-pose" "--engine grid --precision float"; do
    # shellcheck disable=SC2086
    if log=$(compute-sanitizer --tool "$tool" --error-exitcode 9 "$program" "${ask[@]}" $mode 2>&1); then
      echo "$tool, $mode: clean"
    else
      failed=1
      echo "$tool, $mode: $(echo "$log" | grep -E '=====|error' | head -20)"
    fi
  done
done
exit "$failed"
