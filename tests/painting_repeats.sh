#!/usr/bin/env bash
# Painting the exemplars twice with one seed gives the same bytes, and another seed another picture; at a small size, to
# be quick. Usage: painting_repeats.sh PAINT_EXEMPLARS SCUMBLE
set -eu
paint=$1
program=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$paint" --style all --size 192 --seed 1 -o "$folder/first" > /dev/null
"$paint" --style all --size 192 --seed 1 -o "$folder/second" > /dev/null
"$paint" --style all --size 192 --seed 2 -o "$folder/other" > /dev/null
for style in "$folder"/first/*/; do
  name=$(basename "$style")
  cmp "$style/lit.png" "$folder/second/$name/lit.png"
  cmp "$style/paper.png" "$folder/second/$name/paper.png"
  if cmp -s "$style/lit.png" "$folder/other/$name/lit.png"; then echo "$name: the seed changes nothing"; exit 1; fi
  "$program" styles check "$style/lit.png"
done
