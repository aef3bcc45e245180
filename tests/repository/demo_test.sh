#!/usr/bin/env bash
# The demo script draws its dozen pictures and the contact sheet, small. usage: demo_test.sh PROGRAM
set -eu
program=$(realpath "$1")
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
SCUMBLE=$program .ci/demo --size 160x90 -o "$folder" > "$folder/said"
pictures=("$folder"/[0-9][0-9]-*.png)
[ ${#pictures[@]} = 12 ] || { echo "expected 12 pictures, found ${#pictures[@]}"; exit 1; }
[ -s "$folder/contact-sheet.png" ] || { echo "there is no contact sheet"; exit 1; }
grep -q '^\[12 of 12\]' "$folder/said" || { echo "no progress was printed:"; cat "$folder/said"; exit 1; }
