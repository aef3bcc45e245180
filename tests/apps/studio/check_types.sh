#!/bin/sh
# The types of the studio's page, which stand in its comments, agree: check_types.sh FOLDER, with Debian's
# node-typescript.
set -eu
if ! command -v tsc >/dev/null; then
  echo "tsc is not here: install node-typescript" >&2
  exit 1
fi
cd "$1"
exec tsc --allowJs --checkJs --noEmit --strict --noUnusedLocals \
  --target es2022 --module es2022 --lib es2022,dom,dom.iterable *.js
