#!/usr/bin/env bash
# Makes the pictures of docs/colors.md, from the project's own assets: docs/colors.sh [RAYCAST]
set -euo pipefail
cd "$(dirname "$0")/.."
raycast=${1:-target/release/raycast}
out=docs/colors
mkdir -p "$out"
view=(--size 640x400 --samples 16 --legend)

"$raycast" render assets/monkey.obj -o "$out/curvature.jpg" "${view[@]}" --color curvature --color-map diverging \
    --color-range -6,6
"$raycast" render assets/monkey.obj -o "$out/area.jpg" "${view[@]}" --color area --color-map magma --mode color
"$raycast" render assets/dahlia.obj -o "$out/depth.jpg" "${view[@]}" --mode depth --orbit 20,40
"$raycast" render assets/torus.obj -o "$out/distance.jpg" "${view[@]}" --color distance:1.4,0,0 --color-map turbo \
    --orbit 25,35
