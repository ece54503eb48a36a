#!/usr/bin/env bash
# Installs what is missing, configures the release preset where that has not been done, and builds. What demo.sh and
# test.sh have in common; with nothing to do it takes about a second.
#
#   tools/build.sh [TARGET...]     default: everything; `weir_app` is the program and its plugins without the tests
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/install-deps.sh

# Objects of two checkouts are the same: paths are cached relative to the root.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1

build=build/release
configure=(cmake --preset release)
if [ -f "$build/CMakeCache.txt" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" "$build/CMakeCache.txt"; then
  configure+=(--fresh)  # the folder was moved
elif [ -f "$build/build.ninja" ] && [ ! CMakePresets.json -nt "$build/build.ninja" ]; then
  configure=()  # the build itself notices changes in CMake files
fi
if [ ${#configure[@]} -gt 0 ]; then
  log=$(mktemp)
  trap 'rm -f "$log"' EXIT
  "${configure[@]}" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
fi

targets=()
for target in "$@"; do targets+=(--target "$target"); done
cmake --build --preset release "${targets[@]}"
