#!/usr/bin/env bash
# Painting the exemplars twice with one seed gives the same bytes, and another seed another picture; at a small size, to
# be quick. Usage: painting_repeats.sh PAINT_EXEMPLARS EXEMPLARS
set -eu
paint=$1
exemplars=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

painters=()
for each in first:1 second:1 other:2; do
  "$paint" --style all --size 128 --seed "${each#*:}" -o "$folder/${each%:*}" > /dev/null &
  painters+=($!)
done
for painter in "${painters[@]}"; do wait "$painter"; done
for style in "$folder"/first/*/; do
  name=$(basename "$style")
  for picture in "$style"/*.png; do
    file=$name/$(basename "$picture")
    cmp "$picture" "$folder/second/$file"
    case $file in */paper.png) continue ;; esac
    if cmp -s "$picture" "$folder/other/$file"; then echo "$file: the seed changes nothing"; exit 1; fi
  done
done
# What the bundled styles list is what is painted.
for style in "$exemplars"/*/style.toml; do
  name=$(basename "$(dirname "$style")")
  for picture in $(sed -n 's/^\(image\|paper\) = "\(.*\.png\)".*/\2/p' "$style"); do
    [ -s "$folder/first/$name/$picture" ] || { echo "$name: no $picture"; exit 1; }
  done
done
# A scene's painting has its guides' size unless another is asked for; without those guides nothing is painted.
if "$paint" --style scene-ink --scene "$folder/none.exr" -o "$folder" 2> "$folder/message"; then exit 1; fi
grep -q "none.exr" "$folder/message" || { cat "$folder/message"; exit 1; }
