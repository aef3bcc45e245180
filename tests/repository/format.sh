#!/usr/bin/env bash
# Every C++ file is formatted by .clang-format: `make format` does it.
# Usage: format.sh SOURCE
set -eu
cd "$1"
command -v clang-format > /dev/null || { echo "clang-format is missing: .ci/install format"; exit 1; }
git ls-files '*.h' '*.cpp' | xargs clang-format --dry-run --Werror
