#!/usr/bin/env bash
# .ci/install without root: where sudo is missing or not allowed it prints the one line to run and stops; if apt-get
# update fails once it is tried again. Small scripts replace dpkg-query, id, sudo, apt-get and sleep.
# Usage: install_script.sh SOURCE_FOLDER
set -eu
source=$1
fakes=$(mktemp -d)
trap 'rm -rf "$fakes"' EXIT

fake() { printf '#!/bin/sh\n%s\n' "$2" > "$fakes/$1"; chmod +x "$fakes/$1"; }
fails() { echo "$1"; cat "$fakes/out"; exit 1; }
run() { PATH="$fakes:$PATH" "$source/.ci/install" build > "$fakes/out" 2>&1 < /dev/null; }

fake dpkg-query 'exit 1'
fake id 'echo 1000'
fake sudo 'echo "sudo: a password is required" >&2; exit 1'
if run; then fails "it went on without rights"; fi
grep -q '^  apt-get update && apt-get install -y .* libembree-dev' "$fakes/out" || fails "the line to run is missing"

fake id 'echo 0'
fake sleep ''
fake apt-get "echo \"\$@\" >> $fakes/calls; [ \"\$1\" = install ] || [ \$(grep -c update $fakes/calls) -ge 2 ]"
run || fails "one failing update ended it"
[ "$(grep -c '^update' "$fakes/calls")" = 2 ] || fails "update was not tried twice"
grep -q '^install .*libembree-dev' "$fakes/calls" || fails "nothing was installed"

fake dpkg-query 'echo "install ok installed"'
rm "$fakes/calls"
run || fails "it failed with nothing to do"
[ ! -e "$fakes/calls" ] || fails "it called apt-get with nothing to do"
