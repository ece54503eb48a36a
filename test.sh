#!/usr/bin/env bash
# Installs what is needed, builds everything, checks format and lint, and runs every test.
#
#   ./test.sh            all of it
#   ./test.sh --quick    without clang-tidy
set -euo pipefail

quick=false
for argument in "$@"; do
  case "$argument" in
    --quick) quick=true ;;
    -h | --help) sed -n '2,5p' "${BASH_SOURCE[0]}" | sed 's/^# \{0,1\}//'; exit 0 ;;
    *) echo "test.sh: '$argument' is not known; see --help" >&2; exit 2 ;;
  esac
done

cd "$(dirname "${BASH_SOURCE[0]}")"
tools/build.sh
tools/format.sh --check
if ! $quick; then python3 tools/tidy.py build/release; fi
ctest --preset release -j2 --output-on-failure
