#!/usr/bin/env bash
# make tradeoff: a small sample is measured, and its front and chart stand in a copy of the page, between the marks and
# nowhere else; showing it again changes nothing. Missing parts are reported.
# Usage: tradeoff_script.sh SOURCE_FOLDER BUILD_FOLDER
set -eu
source=$1 build=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fails() {
  printf '%s\n' "$1"
  cat "$folder/out"
  exit 1
}
tradeoff() {
  /usr/bin/python3 "$source/bench/tradeoff.py" --build "$build" --output "$folder/made" --docs "$folder" \
      --size 96x54 "$@" \
    > "$folder/out" 2>&1
}
mkdir "$folder/gallery"
cp "$source/docs/tradeoff.md" "$folder"
sed -i '/^<!-- toys-graphite: begin/,/^<!-- toys-graphite: end/{/^<!--/!d}' "$folder/tradeoff.md"
cp "$folder/tradeoff.md" "$folder/before.md"

tradeoff --only toys-graphite --write-docs -- --quick --repeat 1 --no-memory || fails "it does not run"
grep -q "toys-graphite/report.html" "$folder/out" || fails "where the report is is not said"
[ -s "$folder/made/toys-graphite/report.html" ] || fails "no report"
grep -q "<svg" "$folder/gallery/tradeoff-toys-graphite.svg" || fails "no chart"
grep -q '^| ★ | ' "$folder/tradeoff.md" || fails "no front"
front=$(/usr/bin/python3 -c 'import json, sys; print(len(json.load(open(sys.argv[1]))["front"]))' \
    "$folder/made/toys-graphite/tradeoff.json")
lines=$(sed -n '/^<!-- toys-graphite: begin/,/^<!-- toys-graphite: end/p' "$folder/tradeoff.md" | grep -c '^| ★ | ')
[ "$lines" = "$front" ] || fails "$lines lines with a star for $front variants on the front"
grep -q '| the style |' "$folder/tradeoff.md" || fails "the style is missing"
sed '/^<!-- toys-graphite: begin/,/^<!-- toys-graphite: end/{/^<!--/!d}' "$folder/tradeoff.md" |
  cmp - "$folder/before.md" ||
  fails "something else was changed too"

cp "$folder/tradeoff.md" "$folder/first.md"
tradeoff --only toys-graphite --write-docs --show || fails "it cannot be shown again"
cmp "$folder/tradeoff.md" "$folder/first.md" || fails "shown again, it differs"

tradeoff --only ball && fails "there is no such sample"
grep -q "there are suzanne-oil" "$folder/out" || fails "the samples are not said"
tradeoff --only suzanne-oil --show && fails "nothing was measured"
grep -q "run without --show first" "$folder/out" || fails "no remedy"
sed -i '/toys-graphite: end/d' "$folder/tradeoff.md"
tradeoff --only toys-graphite --write-docs --show && fails "the mark is missing"
grep -q "put them back" "$folder/out" || fails "no remedy for the mark"
