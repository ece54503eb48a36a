#!/usr/bin/env bash
# A bench as a Slurm job array: one shard a task, then their files become one. Waits until all is done.
#
#   tools/bench_slurm.sh SHARDS GRAPH... --scene FILE [weir bench's other options] --out FILE.json
#
# Shards write FILE.shard-I.json and FILE.shard-I.log, on a file system that the nodes share; a run that was stopped goes on where it
# was. SBATCH_OPTIONS: for sbatch, such as '--gres=gpu:1 --partition=gpus', so that each task has a GPU of its own. WEIR: the
# program, as the nodes see it; default build/release/bin/weir.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/bench_shards.sh"
read_arguments "$@"
command="$(quoted "$weir" bench "${arguments[@]}") --out $(quoted "$stem").shard-\$SLURM_ARRAY_TASK_ID.json"
command+=" --shard \$SLURM_ARRAY_TASK_ID/$shards"
# shellcheck disable=SC2086  # options are words
sbatch --wait --array="0-$((shards - 1))" --job-name=weir-bench --output="$stem.shard-%a.log" ${SBATCH_OPTIONS:-} \
  --wrap "$command" || { tail -n 5 "$stem".shard-*.log >&2; exit 1; }
merge
