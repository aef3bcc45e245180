#!/usr/bin/env bash
# Two builds of finished_pictures.cpp print the same hashes: as they are, and without AVX2.
# Usage: same_pictures.sh PROGRAM PROGRAM-WITHOUT-AVX2
set -eu
with=$("$1") without=$("$2")
[ "${without%%$'\n'*}" = default ] || { echo "$2 takes the form '${without%%$'\n'*}' instead of 'default'"; exit 1; }
[ "${with%%$'\n'*}" = avx2 ] || { echo "skipped: this processor has no AVX2"; exit 77; }
diff <(tail -n +2 <<< "$with") <(tail -n +2 <<< "$without") || { echo "these pictures differ"; exit 1; }
[ "$(grep -vc ^refused <<< "$with")" -gt 100 ] || { echo "few pictures: $with"; exit 1; }
