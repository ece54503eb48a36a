#!/usr/bin/env bash
# A bench over several processes of this machine, by GNU parallel: one shard each, then their files become one.
#
#   tools/bench_parallel.sh SHARDS GRAPH... --scene FILE [weir bench's other options] --out FILE.json
#
# Shards write FILE.shard-I.json; a run that was stopped goes on where it was. Times of shards that share a GPU are of a shared
# GPU: give each one of its own by WEIR_SHARD_OPTIONS, in which {} is the shard's number from 0, such as '--device {}'.
# WEIR: the program, default build/release/bin/weir. JOBS: how many run at a time, default all.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/bench_shards.sh"
read_arguments "$@"
parallel -j "${JOBS:-$shards}" --halt soon,fail=1 --line-buffer --tagstring 'shard {}' \
  "$(quoted "$weir" bench "${arguments[@]}") --out $(quoted "$stem").shard-{}.json --shard {}/$shards ${WEIR_SHARD_OPTIONS:-}" \
  ::: $(seq 0 $((shards - 1)))
merge
