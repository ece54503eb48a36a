#!/usr/bin/env bash
# Runs every known bug of tests/mutants through the situation that should show it, and clean runs for false alarms, and writes the table of
# docs/mutants.md.
#
#   tools/mutants.sh                                  all bugs and three clean seeds, on the CPU: some minutes
#   tools/mutants.sh --device 0 --effort 8 --clean 100    on a GPU: what docs/mutants.md shows
#
# Options go to the program `mutants` (see its --help). Where it is, if not in build/release/bin: WEIR_MUTANTS.
# Exit status: 0 all were caught, 1 some were not.
set -euo pipefail

for argument in "$@"; do
  case "$argument" in
    -h | --help) sed -n '2,9p' "${BASH_SOURCE[0]}" | sed 's/^# \{0,1\}//'; exit 0 ;;
  esac
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${WEIR_MUTANTS:-build/release/bin/mutants}
if [ -z "${WEIR_MUTANTS:-}" ]; then
  cmake --preset release >/dev/null
  cmake --build --preset release --target mutants
fi
[ $# -gt 0 ] || set -- --device cpu --clean 3
exec "$program" --json docs/measurements/mutants.json --table docs/measurements/mutants.md "$@"
