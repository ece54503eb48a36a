# Shared by bench_parallel.sh and bench_slurm.sh; sourced, not run.

weir=${WEIR:-$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/build/release/bin/weir}

# Words as a shell reads them back.
quoted() { printf '%q ' "$@" | sed 's/ $//'; }

# Sets shards, arguments (without --out) and stem (--out without .json).
read_arguments() {
  shards=${1:-}; shift || true
  if ! [[ "$shards" =~ ^[1-9][0-9]*$ ]]; then
    echo "$(basename "$0"): '$shards' is no number of shards; see the head of the file" >&2; exit 2
  fi
  arguments=(); local out=
  while [ $# -gt 0 ]; do
    case "$1" in
      --out) out=${2:-}; shift 2 || { echo "$(basename "$0"): --out needs a file" >&2; exit 2; } ;;
      --out=*) out=${1#--out=}; shift ;;
      --shard|--shard=*) echo "$(basename "$0"): --shard is given by this script" >&2; exit 2 ;;
      *) arguments+=("$1"); shift ;;
    esac
  done
  case "$out" in *.json) stem=${out%.json} ;; *) echo "$(basename "$0"): --out FILE.json is required" >&2; exit 2 ;; esac
}

merge() {
  local files=() i
  for ((i = 0; i < shards; ++i)); do files+=("$stem.shard-$i.json"); done
  "$weir" bench merge "${files[@]}" --out "$stem.json"
}
