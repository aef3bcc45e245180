#!/usr/bin/env bash
# The committed sample scenes equal the output of blender_scripts/make_scenes.py. Compared by their guides, not byte by
# byte: Blender's last bits may differ from one processor to the next.
# Usage: scenes_are_current.sh PROGRAM SOURCE_FOLDER
set -eu
program=$1
source=$2
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT

blender -b -noaudio --factory-startup -P "$source/blender_scripts/make_scenes.py" -- --output "$fresh" \
    > "$fresh/log" 2>&1 ||
  { cat "$fresh/log"; exit 1; }
for committed in "$source"/scenes/*.glb; do
  name=$(basename "$committed")
  for frame in 1 31; do  # what stands still does so in both
    for file in "$committed" "$fresh/$name"; do
      "$program" guidegen "$file" --size 320x180 --frame "$frame" --layers albedo,luminance \
        -o "$fresh/guides-$([ "$file" = "$committed" ] && echo a || echo b).exr" --quiet > "$fresh/log"
    done
    "$program" compare "$fresh/guides-a.exr" "$fresh/guides-b.exr" --fail 0.002 --failpercent 0.1 > "$fresh/report" ||
      { echo "$name is not what the script makes, frame $frame:"; cat "$fresh/report"; exit 1; }
  done
  echo "$name: current"
done
