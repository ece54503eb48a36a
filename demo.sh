#!/usr/bin/env bash
# From a fresh machine to a picture: installs what is needed, builds, renders a scene without a window into out/demo.png
# and prints what each pass cost. Run it again at any time: what is done already is not done again.
set -euo pipefail

usage() {
  cat <<'TEXT'
./demo.sh          install, build, render scenes/cornell.glb through graphs/restir_di.json into out/demo.png
./demo.sh --view   install, build, open the window on that scene and graph (docs/sandbox.md)
./demo.sh --help   this text
TEXT
}

view=false
case "${1:-}" in
  "") ;;
  -h | --help) usage; exit 0 ;;
  --view) view=true ;;
  *) echo "demo.sh: '$1' is not known" >&2; usage >&2; exit 2 ;;
esac
if [ $# -gt 1 ]; then echo "demo.sh: '$2' is not known" >&2; exit 2; fi

cd "$(dirname "${BASH_SOURCE[0]}")"
start=$SECONDS
tools/build.sh weir_app

if $view; then exec build/release/bin/weir view graphs/restir_di.json --scene scenes/cornell.glb --exposure 2; fi

mkdir -p out
echo "rendering after $((SECONDS - start)) s of set-up"
build/release/bin/weir render graphs/restir_di.json --scene scenes/cornell.glb --size 512x512 \
  --frames 12 --average 12 --exposure 2 --out color=out/demo.png --stats out/demo.json

python3 - out/demo.json <<'PYTHON'
import json, sys
stats = json.load(open(sys.argv[1]))
width, height = stats["size"]
print(f"\n{stats['device']}, {width}x{height}, {stats['frames']} frames\n")
print(f"{'pass':<10}{'type':<22}{'GPU ms':>9}{'p95':>9}")
rows = [(p["name"], p["type"], p["gpu_ms"]) for p in stats["passes"]] + [("frame", "", stats["frame"]["gpu_ms"])]
for name, kind, ms in rows:
    times = f"{ms['median']:>9.2f}{ms['p95']:>9.2f}" if ms else f"{'no timer':>18}"
    print(f"{name:<10}{kind:<22}{times}")
PYTHON

echo
echo "The picture: $PWD/out/demo.png"
echo "The window:  ./demo.sh --view"
