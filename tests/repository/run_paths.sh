#!/usr/bin/env bash
# The loader takes an empty entry of a program's run path as the folder that it runs in, and would load libraries from
# there.
# Usage: run_paths.sh READELF FILE...
set -eu
readelf=$1
shift
for file in "$@"; do
  "$readelf" -d "$file" > /dev/null
  for path in $("$readelf" -d "$file" | sed -nE 's/.*\((RPATH|RUNPATH)\).*\[(.*)\].*/[\2]/p'); do
    case $path in
      *::* | '[:'* | *':]' | '[]') echo "$file has an empty entry in its run path: $path"; exit 1 ;;
    esac
  done
done
