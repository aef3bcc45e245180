#!/usr/bin/env bash
# A program outside the tree, built against the installed files alone: by CMake's package and by pkg-config. Both paint
# the picture of `scumble stylize`. What is installed is whole: every style paints, every script finds what it imports.
# Usage: consumer.sh SOURCE BUILD
set -eu
source=$(cd "$1" && pwd)
build=$(cd "$2" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/prefix" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
mkdir "$work/project"
cp "$source/tests/consumer/"*.cpp "$source/tests/consumer/CMakeLists.txt" "$work/project/"
cp "$source/scenes/suzanne.glb" "$work/"
cd "$work"
cmake -S project -B by-cmake -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" > log 2>&1 &&
  cmake --build by-cmake >> log 2>&1 || { cat log; exit 1; }
# shellcheck disable=SC2046
PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig" sh -c '${CXX:-c++} -std=c++20 project/main.cpp -o by-pkg-config \
  $(pkg-config --cflags --libs scumble)' > log 2>&1 || { cat log; exit 1; }

prefix/bin/scumble stylize suzanne.glb --style oil --size 640x360 --quiet -o wanted.png > log
by-cmake/paint suzanne.glb oil one.png
./by-pkg-config suzanne.glb oil two.png
for picture in one.png two.png; do
  prefix/bin/scumble compare wanted.png $picture --quiet > log || { echo "$picture differs"; cat log; exit 1; }
done
by-cmake/formats one.png three.jpg && by-cmake/formats three.jpg three.tif ||
  { echo "without a Stylizer no JPEG is written or read"; exit 1; }
rm three.*
for style in prefix/share/scumble/exemplars/*/style.toml; do
  style=$(basename "$(dirname "$style")")
  prefix/bin/scumble stylize suzanne.glb --style "$style" --size 32x18 --samples 1 --quiet -o style.png > log 2>&1 ||
    { echo "the installed style $style does not paint"; cat log; exit 1; }
done
for script in prefix/share/scumble/blender_scripts/*.py; do
  for module in $(sed -nE 's/^ *(import|from) ([a-z_]+).*/\2/p' "$script"); do
    [ ! -e "$source/blender_scripts/$module.py" ] || [ -e "$(dirname "$script")/$module.py" ] ||
      { echo "$script imports $module, which is not installed"; exit 1; }
  done
done
# A mistake is a sentence and an exit code.
if by-cmake/paint missing.glb oil three.png > log; then echo "a missing scene was painted"; exit 1; fi
grep -q missing.glb log || { cat log; exit 1; }
[ ! -e three.png ]
[ "$(wc -l < project/main.cpp)" -lt 25 ] || { echo "the program has 25 lines or more"; exit 1; }
