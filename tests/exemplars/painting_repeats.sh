#!/usr/bin/env bash
# Painting an exemplar twice with one random seed gives equal bytes, and another seed another picture: every style is
# painted twice, alternately with one seed and with two. At a small size. Four that take longest are left out, because
# they lay paint on with the brushes of others: impasto as tinted-oil does, and the flat brush.
# Usage: painting_repeats.sh PAINT_EXEMPLARS EXEMPLARS
set -eu
paint=$1
exemplars=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

styles=()
for style in "$exemplars"/*/style.toml; do
  name=$(basename "$(dirname "$style")")
  case $name in gouache | oil | plein-air | scene-oil) ;; *) styles+=("$name") ;; esac
done
for name in "${styles[@]}"; do
  "$paint" --style "$name" --size 64 --seed 1 -o "$folder/first" > /dev/null
done &
first=$!
seed=1
for name in "${styles[@]}"; do
  "$paint" --style "$name" --size 64 --seed $seed -o "$folder/seed-$seed" > /dev/null
  seed=$((3 - seed))
done
wait "$first"
for style in "$folder"/first/*/; do
  name=$(basename "$style")
  for picture in "$style"/*.png; do
    file=$name/$(basename "$picture")
    if [ -d "$folder/seed-1/$name" ]; then
      cmp "$picture" "$folder/seed-1/$file"
      continue
    fi
    case $file in */paper.png) [ -s "$folder/seed-2/$file" ]; continue ;; esac
    [ -s "$folder/seed-2/$file" ] || { echo "$file: not painted again"; exit 1; }
    if cmp -s "$picture" "$folder/seed-2/$file"; then echo "$file: the seed changes nothing"; exit 1; fi
  done
done
# The painted exemplars are those that the bundled styles list.
for name in "${styles[@]}"; do
  for picture in $(sed -n 's/^\(image\|paper\) = "\(.*\.png\)".*/\2/p' "$exemplars/$name/style.toml"); do
    [ -s "$folder/first/$name/$picture" ] || { echo "$name: no $picture"; exit 1; }
  done
done
# A scene's exemplar has its guides' size by default; without those guides it is refused.
if "$paint" --style scene-ink --scene "$folder/none.exr" -o "$folder" 2> "$folder/message"; then exit 1; fi
grep -q "none.exr" "$folder/message" || { cat "$folder/message"; exit 1; }
