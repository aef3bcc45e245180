#!/usr/bin/env bash
# Blender's Cycles and our ray caster see the sample scenes alike, and a Blender render with its .camera file is as good
# a guide file as ours. Usage: cycles_agrees.sh PROGRAM SOURCE_FOLDER
set -eu
program=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$program" crosscheck "$source"/scenes/*.glb --size 240x135 --samples 64 -o "$work/report.html" --quiet \
    > "$work/verdicts" || { cat "$work/verdicts"; exit 1; }
cat "$work/verdicts"
test "$(grep -c '^  verdict: agrees$' "$work/verdicts")" = "$(ls "$source"/scenes/*.glb | wc -l)"

blender -b -noaudio --factory-startup -P "$source/blender_scripts/render_guides.py" -- \
  "$source/scenes/suzanne.glb" "$work/cycles.exr" --size 480x270 > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
# Without the .camera file the camera is found from the Position pass.
"$program" transfer "$work/cycles.exr" --style oil -o "$work/solved.png"
"$program" transfer "$work/cycles.exr" --camera "$work/cycles.camera" --style oil -o "$work/theirs.png"
"$program" stylize "$source/scenes/suzanne.glb" --style oil --size 480x270 -o "$work/ours.png"
# Guides that differ in their last digits settle a few pixels on another chunk.
"$program" compare "$work/theirs.png" "$work/ours.png" --fail 0.02 --failpercent 2
"$program" compare "$work/theirs.png" "$work/solved.png" --fail 0.02 --failpercent 2
