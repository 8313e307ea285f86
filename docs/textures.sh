#!/usr/bin/env bash
# Makes the pictures of docs/textures.md, from the project's own assets: docs/textures.sh [RAYCAST]
set -euo pipefail
cd "$(dirname "$0")/.."
raycast=${1:-target/release/raycast}
out=docs/textures
mkdir -p "$out"

leopard=(--texture assets/leopard.png)
crop=(--crop 128,128,256,256)
view=(--samples 16 --mode smooth)
small=(--size 320x320)

# The image; the part of it that is used.
"$raycast" texture-map "${leopard[@]}" -o "$out/image.jpg"
"$raycast" texture-map "${leopard[@]}" "${crop[@]}" -o "$out/crop.jpg"

# The triangles of a mesh in it: all by a plane, all in their own shape, and one of those.
"$raycast" texture-map assets/monkey.obj "${leopard[@]}" --texture-projection plane \
    --line-width 0.5 -o "$out/all-plane.jpg"
"$raycast" texture-map assets/cube.obj "${leopard[@]}" "${crop[@]}" -o "$out/all-uv.jpg"
"$raycast" texture-map assets/cube.obj "${leopard[@]}" "${crop[@]}" \
    --texture-projection per-triangle --triangle 3 -o "$out/one.jpg"

# The cube from its own colours to its texture.
for blend in 0 0.25 0.5 0.75 1; do
    "$raycast" render assets/cube.obj "${leopard[@]}" "${crop[@]}" "${view[@]}" "${small[@]}" --orbit 30,25 \
        --blend "$blend" -o "$out/cube-$blend.png"
done

# Each way to find a place in it.
for kind in uv triplanar per-triangle plane sphere cylinder; do
    "$raycast" render assets/torus.obj "${leopard[@]}" "${view[@]}" "${small[@]}" --orbit 25,35 \
        --texture-projection "$kind" -o "$out/torus-$kind.png"
done

# A photograph onto what its camera saw: from there, from beside it, and from behind.
taken=(--texture-camera 2.5,2.2,3.5/0,0.1,0 --texture-fov 34)
photograph() {
    "$raycast" render docs/textures/shelter.raycast.toml "${leopard[@]}" "${view[@]}" "${small[@]}" "${taken[@]}" "${@:2}" \
        -o "$out/photo-$1.png"
}
photograph taken --eye 2.5,2.2,3.5 --target 0,0.1,0 --fov 42
photograph beside --eye 4.6,2.6,0.8 --target 0,0,0 --fov 42
photograph behind --eye -3,2.6,2.6 --target 0,0,0 --fov 45

# Beyond a plane of half the cube's width.
for wrap in repeat mirror clamp border; do
    "$raycast" render assets/cube.obj "${leopard[@]}" "${crop[@]}" "${view[@]}" "${small[@]}" --orbit 30,25 \
        --texture-projection plane --texture-size 1.2,1.2 --wrap "$wrap" -o "$out/wrap-$wrap.png"
done

# A floor that reaches to the horizon, one ray a pixel.
for filter in bilinear trilinear ewa; do
    "$raycast" render docs/textures/floor.raycast.toml -o "$out/far-$filter.png" --filter "$filter"
done

# The object that it is for.
"$raycast" render assets/monkey.obj "${leopard[@]}" "${view[@]}" --size 640x480 \
    --texture-projection triplanar -o "$out/monkey.png"
