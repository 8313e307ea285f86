#!/usr/bin/env bash
# Takes the pictures of README's tour from the real window, on a screen of its own: docs/tour.sh [RAYCAST]
# Needs Xvfb, xdotool and ImageMagick. Look at each picture before it is committed: clicks go to places.
set -euo pipefail
cd "$(dirname "$0")/.."
raycast=$(realpath "${1:-target/release/raycast}")
out=docs/tour
mkdir -p "$out"

home=$(mktemp -d)
screen=
window=
end() {
    [ -z "$window" ] || kill "$window" 2>/dev/null || true
    [ -z "$screen" ] || kill "$screen" 2>/dev/null || true
    rm -rf "$home"
}
trap end EXIT

mkfifo "$home/display"
Xvfb -displayfd 1 -noreset -nolisten tcp -screen 0 1600x1000x24 >"$home/display" 2>/dev/null &
screen=$!
read -r number <"$home/display"
export DISPLAY=:$number LIBGL_ALWAYS_SOFTWARE=1
unset WAYLAND_DISPLAY

# Opens the window on files, at WIDTHxHEIGHT.
open() {
    local size=$1 id
    shift
    if [ -n "$window" ]; then
        kill "$window" 2>/dev/null || true
        wait "$window" 2>/dev/null || true
    fi
    rm -rf "$home/settings"
    HOME=$home XDG_CONFIG_HOME=$home/settings XDG_DATA_HOME=$home/settings XDG_CACHE_HOME=$home/settings \
        "$raycast" view "$@" 2>/dev/null &
    window=$!
    until id=$(xdotool search --onlyvisible --name RayCast 2>/dev/null | head -n 1) && [ -n "$id" ]; do
        sleep 0.2
    done
    xdotool windowmove "$id" 0 0 windowsize "$id" "${size%x*}" "${size#*x}" windowfocus "$id"
    width=${size%x*} height=${size#*x}
    settle
    # A click beside everything ends the line about the mouse.
    click 20 $((height - 60))
}

look() {
    import -silent -window root -crop "${width}x$height+0+0" +repage "$home/$1.png"
}

# Waits until two looks half a second apart are the same, three times over; at most for 30 looks, since a cursor blinks.
settle() {
    local same=0 looks=0
    look before
    while [ $same -lt 3 ] && [ $((looks += 1)) -le 30 ]; do
        sleep 0.5
        look after
        if cmp -s "$home/before.png" "$home/after.png"; then same=$((same + 1)); else same=0; fi
        mv "$home/after.png" "$home/before.png"
    done
}

# A command by its name, through the palette.
run() {
    xdotool key ctrl+p
    sleep 0.4
    xdotool type --delay 20 "$1"
    sleep 0.4
    xdotool key Return
    sleep 0.4
}

click() {
    xdotool mousemove "$1" "$2"
    sleep 0.3
    xdotool click 1
    sleep 0.5
}

# From a place to another; the button stays down.
drag() {
    xdotool mousemove "$1" "$2"
    sleep 0.3
    xdotool mousedown 1
    for step in 1 2 3 4 5 6 7 8 9 10; do
        xdotool mousemove $(($1 + ($3 - $1) * step / 10)) $(($2 + ($4 - $2) * step / 10))
        sleep 0.05
    done
}

# The window as it is: a PNG, or a JPEG for the tour.
take() {
    settle
    look shot
    case $1 in
        *.png) convert "$home/shot.png" -strip -define png:compression-level=9 "$1" ;;
        *) convert "$home/shot.png" -strip -sampling-factor 4:4:4 -quality 84 "$1" ;;
    esac
    echo "$1"
}

# Folds the two parts of the panel that are open at first: the headings of all are then 30 points apart.
fold() {
    click 1030 48
    click 1030 78
    measure=108 cut=138 health=168
}

demo=assets/demo.raycast.toml

# The whole window: the marked object's handles, a pick and tile borders.
open 1600x1000 "$demo"
click 640 470
xdotool key g t
take docs/window.png

# A handle while it is dragged; Ctrl snaps.
open 1280x800 "$demo"
click 500 350
xdotool key Escape shift+r
settle
xdotool keydown ctrl
drag 558 259 584 322
take $out/handles.jpg
xdotool mouseup 1 keyup ctrl

# A clipping plane, with its section filled.
open 1280x800 "$demo"
fold
click 1030 $cut
run "cut across z"
xdotool key Left Left Left Left
xdotool mousemove 500 770
take $out/cut.jpg

# Distances between vertices.
open 1280x800 "$demo"
fold
click 1030 $measure
xdotool key d
click 662 480
click 743 503
click 743 503
click 833 488
xdotool key Escape a
click 660 594
click 741 624
click 743 503
xdotool key Escape
xdotool mousemove 500 770
take $out/measure.jpg

# Faults of a mesh, one of which is looked at: a torus without every 40th face.
awk '!/^f / || ++face % 40' assets/torus.obj >"$home/torus.obj"
cp assets/torus.mtl "$home"
open 1280x800 "$home/torus.obj"
fold
click 1030 $health
run "check the mesh"
settle
click 1040 252
xdotool key 0 f
xdotool mousemove 500 770
take $out/health.jpg

# Every command by its name.
open 1280x800 "$demo"
xdotool key ctrl+p
sleep 0.4
xdotool type --delay 20 "cut"
sleep 0.4
take $out/commands.jpg

# Depth in colors, fitted to what is seen, with its legend.
open 1280x800 "$demo"
xdotool key alt+5
xdotool mousemove 500 770
take $out/depth.jpg

# Three picks, numbered and listed.
open 1280x800 "$demo"
click 1030 48
click 500 370
xdotool keydown ctrl
click 760 280
click 690 560
xdotool keyup ctrl
xdotool mousemove 500 770
take $out/picks.jpg

# A ball that was put in, over the ground grid, among the other objects.
open 1280x800 "$demo"
run "ground grid"
run "sphere"
xdotool key g
settle
drag 496 318 496 60
xdotool mouseup 1 mousemove 500 770
take $out/shapes.jpg

# All layers, the nearest of them exact.
open 1280x800 "$demo"
xdotool key alt+x
xdotool mousemove 500 770
take $out/x-ray.jpg

# Few rays: each is a block of its color.
open 1280x800 "$demo"
for _ in 1 2 3 4; do xdotool key minus; done
xdotool key t
xdotool mousemove 500 770
take $out/rays.jpg
