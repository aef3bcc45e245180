#!/usr/bin/env bash
# A case that takes longer than its tier allows fails its program, and is named: slow_cases_fail.sh PROGRAM, which is
# measure_test.
set -eu
slow=Regularity.PeriodAndDirectionOfLines
said=$(SCUMBLE_CASE_SECONDS=0.001 "$1" --gtest_filter=$slow) && { echo "$slow may take any time"; exit 1; }
grep -q "^$slow took .* its tier allows 0.00 s" <<< "$said" || { echo "$slow is not named: $said"; exit 1; }
SCUMBLE_CASE_SECONDS=600 "$1" --gtest_filter=$slow || { echo "$slow fails within its time"; exit 1; }
"$1" --gtest_filter=$slow || { echo "$slow fails without a limit"; exit 1; }
