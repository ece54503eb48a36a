#!/usr/bin/env bash
# Runs every known bug of tests/mutants through the situation that should show it, and clean runs for false alarms. By default figures go
# to out/mutants.json and out/mutants.md; docs/measurements has those of a GPU, which docs/mutants.md shows.
#
#   tools/mutants.sh                                      all bugs, and three clean runs of every situation, on the CPU: some minutes
#   tools/mutants.sh --device 0 --effort 8                all bugs on a GPU
#   tools/mutants.sh --device 0 --clean-only --clean 8    clean runs, eight of every situation
#
# Options go to the program `mutants` (see its --help). Where it is, if not in build/release/bin: WEIR_MUTANTS.
# Exit status: 0 all were caught; 1 some were not, or there were more false alarms than chance explains; 2 bad options.
set -euo pipefail

for argument in "$@"; do
  case "$argument" in
    -h | --help) sed -n '2,10p' "${BASH_SOURCE[0]}" | sed 's/^# \{0,1\}//'; exit 0 ;;
  esac
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${WEIR_MUTANTS:-build/release/bin/mutants}
if [ -z "${WEIR_MUTANTS:-}" ]; then
  cmake --preset release >/dev/null
  cmake --build --preset release --target mutants
fi
[ $# -gt 0 ] || set -- --device cpu --clean 3
mkdir -p out
case " $* " in *" --json "*) ;; *) set -- --json out/mutants.json "$@" ;; esac
case " $* " in *" --table "*) ;; *) set -- --table out/mutants.md "$@" ;; esac
exec "$program" "$@"
