#!/usr/bin/env bash
# Every C++ file is formatted by .clang-format: `make format` does it. Releases of clang-format differ in a few lines;
# Debian 12's counts, and others are skipped (exit code 77).
# Usage: format.sh SOURCE
set -eu
cd "$1"
command -v clang-format > /dev/null || { echo "clang-format is missing: .ci/install format"; exit 1; }
clang-format --version | grep -q 'version 14\.' || { echo "skipped: this is not clang-format 14"; exit 77; }
git ls-files '*.h' '*.cpp' | xargs clang-format --dry-run --Werror
