#!/usr/bin/env bash
# .ci/fuzz separates fuzzers that ran from those that did not: in a folder of its own, with replacements for the
# fuzzers.
# Usage: fuzz_script.sh SOURCE
set -eu
source=$(cd "$1" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir -p .ci build-fuzz tests/fuzz/corpus
cp "$source/.ci/fuzz" .ci/fuzz

# stand_in TARGET 'COMMANDS'
stand_in() {
  printf '#!/bin/sh\n%s\n' "$2" > "build-fuzz/fuzz_$1"
  chmod +x "build-fuzz/fuzz_$1"
}
# expect STATUS TARGET…
expect() {
  wanted=$1
  shift
  status=0
  said=$(.ci/fuzz 1 "$@" 2>&1) || status=$?
  if [ "$status" != "$wanted" ]; then
    printf 'FAILED: %s ended with %s, expected %s:\n%s\n' "$*" "$status" "$wanted" "$said"
    exit 1
  fi
}

stand_in good 'echo "stat::number_of_executed_units: 12"; echo "stat::average_exec_per_sec: 3"'
stand_in idle 'echo "stat::number_of_executed_units: 0"'
stand_in silent 'exit 0'
stand_in broken 'echo "stat::number_of_executed_units: 12"; exit 77'
stand_in killed 'kill -KILL $$'
stand_in crashing 'echo "stat::number_of_executed_units: 12"; touch build-fuzz/crashes/crashing/crash-1'
expect 0 good
expect 1 missing
expect 1 good missing
expect 1 idle
expect 1 silent
expect 1 broken
expect 1 killed
expect 1 crashing
stand_in good 'exit 1'  # what the run before said does not count
expect 1 good
# The length that each is asked for.
stand_in style 'echo "$*" | grep -q -- -max_len=262144 && echo "stat::number_of_executed_units: 1"'
stand_in png 'echo "$*" | grep -q -- -max_len=8192 && echo "stat::number_of_executed_units: 1"'
expect 0 style png
