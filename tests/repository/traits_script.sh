#!/usr/bin/env bash
# .ci/traits: a page that it made passes its own check; a row too many, one too few, a figure that is off and a missing
# thumbnail do not. .ci/optimise_png changes no pixel and reaches a fixed point. On one small style.
# Usage: traits_script.sh SOURCE_FOLDER SCUMBLE
set -eu
source=$1
program=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fails() { echo "$1"; cat "$folder/out"; exit 1; }
mkdir -p "$folder/exemplars/one" "$folder/docs"
oiiotool "$source/exemplars/charcoal/lit.png" --resize 256x256 -d uint8 -o "$folder/exemplars/one/lit.png"
printf 'licence = "CC0-1.0"\n[[exemplar]]\nimage = "lit.png"\n' > "$folder/exemplars/one/style.toml"
traits() {
  "$source/.ci/traits" --program "$program" --exemplars "$folder/exemplars" --scene "$source/scenes/suzanne.glb" \
    --table "$folder/docs/table.md" "$@" > "$folder/out" 2>&1
}

traits || fails "the table was not made"
traits --check || fails "a table just made is said to be wrong"
grep -q '](../exemplars/one/thumbnail.png) | one | lit.png |' "$folder/docs/table.md" || fails "no row"
[ "$(oiiotool "$folder/exemplars/one/thumbnail.png" --echo '{TOP.width} {TOP.nchannels}')" = "192 3" ] \
    || fails "thumbnail"
first=$(sha256sum "$folder/docs/table.md" "$folder/exemplars/one/thumbnail.png")
traits
[ "$first" = "$(sha256sum "$folder/docs/table.md" "$folder/exemplars/one/thumbnail.png")" ] \
    || fails "made twice, it differs"

wrong() { # WHAT-IS-SAID SED-PROGRAM
  cp "$folder/docs/table.md" "$folder/good.md"
  sed -i "$2" "$folder/docs/table.md"
  if traits --check; then fails "not found: $1"; fi
  grep -q -- "$1" "$folder/out" || fails "not said: $1"
  grep -q "make traits" "$folder/out" || fails "no remedy"
  mv "$folder/good.md" "$folder/docs/table.md"
}
wrong "one/lit.png is not listed" '/| one |/d'
wrong "two/lit.png is listed and not there" '/| one |/{p;s/| one |/| two |/}'
wrong "one/lit.png: covered % is" '/| one |/s/lit.png | [0-9.]* |/lit.png | 12.3 |/'
wrong "one/lit.png: darkest is .*, the table has many" \
    '/| one |/s/lit.png | \([0-9.]*\) | [0-9]* |/lit.png | \1 | many |/'
wrong "the licence is CC0-1.0" '/| one |/s/CC0-1.0/CC-BY/'
rm "$folder/exemplars/one/thumbnail.png"
if traits --check; then fails "a missing thumbnail is not found"; fi
grep -q "one has no thumbnail.png" "$folder/out" || fails "a missing thumbnail is not said"

cp "$folder/exemplars/one/lit.png" "$folder/before.png"
"$source/.ci/optimise_png" "$folder/exemplars"
cmp -s "$folder/before.png" "$folder/exemplars/one/lit.png" && fails "nothing was made smaller"
[ "$(stat -c %s "$folder/exemplars/one/lit.png")" -lt "$(stat -c %s "$folder/before.png")" ] || fails "it grew"
# An alpha that is opaque everywhere may go.
oiiotool "$folder/before.png" --ch R,G,B "$folder/exemplars/one/lit.png" --ch R,G,B --diff > "$folder/out" \
    || fails "pixels changed"
second=$(sha256sum "$folder/exemplars/one/lit.png")
"$source/.ci/optimise_png" "$folder/exemplars"
[ "$second" = "$(sha256sum "$folder/exemplars/one/lit.png")" ] || fails "it does not come to rest"
