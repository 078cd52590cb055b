#!/usr/bin/env bash
# Runs the CUDA engines on a small scene under compute-sanitizer: memcheck, racecheck and initcheck.
# Usage: tools/bench/gpu_sanitize.sh PROGRAM FOLDER [WORDS: only questions that contain them]
set -uo pipefail
program=$1 folder=$2 only=${3:-} failed=0
"$program" scene hall -o "$folder" --points 20000 --model-points 2000 --poses 200 --force >/dev/null 2>&1 || exit 1
"$program" convert "$folder/environment.las" -o "$folder/site.h5" --origins "$folder/origins.csv" \
  --cell-points 1000 --force >/dev/null 2>&1 || exit 1
box=box:4,1.6,1.4
echo '{"bodies": [{"name": "front", "model": "box:4,1.6,1.4", "at": 3}, {"name": "middle", "model": "model.ply", "pivots": [2, -2]}]}' \
  >"$folder/vehicle.json"
ask=(--env "$folder/site.h5" --trajectory "$folder/trajectory.txt"
  -o "$folder/out.h5" --force --device cuda --device-memory 256M)
run="run --radius 0.1"
points="$run --model $folder/model.ply"
surface="$run --model $box --model-as surface"
solid="$run --model $box --model-as solid"
vehicle="$run --vehicle $folder/vehicle.json"
questions=("$points --engine sweep" "$points --engine sweep --first-pose" "$points --engine sweep --between-poses"
  "$points --engine sweep --clearance 0.3" "$points --engine sweep --clearance 0.3 --first-pose"
  "$points --engine sweep --between-poses --first-pose" "$points --engine sweep --profile 0.5"
  "$points --engine sweep --seen" "$points --engine sweep --between-poses --seen"
  "$points --engine grid" "$points --engine grid --first-pose")
every="--first-pose --clearance 0.3 --profile 0.5 --floor 0.2 --error-scan 5mm --error-pose 1cm --ignore-box 0,0,0,50,50,50"
questions+=("$points --engine sweep $every" "$vehicle $every")
for model in "$surface" "$solid" "$vehicle"; do
  questions+=("$model --first-pose" "$model --clearance 0.3" "$model --profile 0.5" "$model --seen")
done
section="section find --x-range=-1,1 --cell 0.1 --bin 1 --window=-3,3,-1,3"
questions+=("$section" "$section --ignore-box 0,0,0,50,50,50 --between-poses")
for tool in memcheck racecheck initcheck; do
  for question in "${questions[@]}"; do
    [[ "$question" == *"$only"* ]] || continue
    shown=${question//"$folder/"/}
    # shellcheck disable=SC2086
    if log=$(compute-sanitizer --tool "$tool" --error-exitcode 9 "$program" $question "${ask[@]}" 2>&1); then
      echo "$tool, $shown: clean"
    else
      failed=1
      echo "$tool, $shown: $(echo "$log" | grep -E '=====|error' | head -20)"
    fi
  done
done
exit "$failed"
