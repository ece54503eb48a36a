#!/usr/bin/env bash
# clang-format 14 over every C and C++ file that git knows (GLSL is laid out by hand).
#
#   tools/format.sh            mends them
#   tools/format.sh --check    only says what is wrong (exit status 1 if anything is)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

format=$(command -v clang-format-14 || command -v clang-format)
version=$("$format" --version)
case "$version" in
  *"version 14."*) ;;
  *) echo "format.sh: clang-format 14 is wanted (other versions lay out differently), found: $version" >&2; exit 1 ;;
esac
mode=(-i)
[ "${1:-}" != --check ] || mode=(--dry-run -Werror)
git ls-files -z --cached --others --exclude-standard -- '*.cpp' '*.c' '*.h' | xargs -0 -r -P2 -n40 "$format" "${mode[@]}"
