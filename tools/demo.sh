#!/usr/bin/env bash
# Builds Clearway, makes a factory hall with a car body on its conveyor, and shows what the car
# touches, in a report for any browser. Installs missing packages (Debian 12). Output: the folder demo/.
# Usage: tools/demo.sh [hall|plant|mine|tunnel|road] [POINTS]
set -euo pipefail
cd "$(dirname "$0")/.."
kind=${1:-hall}
points=${2:-2000000}
source tools/setup.sh
install_missing_packages

configure_release
cmake --build build/release --target clearway
clearway=build/release/tools/clearway
out=demo/$kind

step() { printf '\n== %s\n' "$*"; "$@"; }
step $clearway scene "$kind" --points "$points" -o "$out" --force
step $clearway convert "$out/environment.las" -o "$out/site.h5" --force
step $clearway run --env "$out/site.h5" --model "$out/model.ply" \
  --trajectory "$out/trajectory.txt" --radius 0.1 --first-pose --clearance 0.3 --profile 0.5 \
  -o "$out/collisions.h5" --force
step $clearway info "$out/collisions.h5"
step $clearway export "$out/collisions.h5" -o "$out/colliding.las" --force
step $clearway export "$out/collisions.h5" -o "$out/colliding.csv" --force
step tools/picture.py --environment "$out/environment.las" --result "$out/collisions.h5" \
  --model "$out/model.ply" --trajectory "$out/trajectory.txt" -o "$out/collisions.png"
step $clearway report "$out/collisions.h5" --env "$out/site.h5" --model "$out/model.ply" \
  --trajectory "$out/trajectory.txt" --title "Clearway demo: $kind" -o "$out/report.html" --force

count=$($clearway info "$out/collisions.h5" --json |
  /usr/bin/python3 -c 'import json, sys; print(json.load(sys.stdin)["colliding_points"])')
cat <<END

$count of $points points lie within 0.1 m of the moving model. Look at:
  $out/report.html      everything on one page: open it in a browser
  $out/collisions.png   the hall, the path and the colliding points
  $out/colliding.las    the colliding points, for any point cloud viewer
  $out/colliding.csv    the same with the first pose that touches each
  $out/collisions.h5    the result itself (docs/design/result-format.md)
END
