#!/usr/bin/env bash
# The pictures of docs/sandbox.md, taken of the window itself on a display of its own (Xvfb).
#
#   tools/sandbox_pictures.sh SCENE [OUTDIR]      SCENE: Sponza, sponza.glb; OUTDIR: docs/images
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,4p' "${BASH_SOURCE[0]}" | sed 's/^# \{0,1\}//' >&2; exit 2; }
scene=$(realpath "$1"); here=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
out=$(realpath -m "${2:-$here/docs/images}")
weir=$here/build/release/bin/weir
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
mkdir -p "$out"
cp "$here/graphs/restir_di.json" "$work/restir_di.json"
cat >"$work/pictures.script" <<SCRIPT
until-frames 12
click graph/spatial
point graph/spatial/radius
wait 4
shoot $out/sandbox-graph.png
click graph/initial/port/reservoirs
wait 2
point picture
wait 5
shoot $out/sandbox-port.png
click shown/port
click shown/port/tonemap.color
click tab/Scene
wait 4
shoot $out/sandbox-scene.png
click tab/Compare
wait 2
until-frames 70
set graph/spatial/radius 20
until-frames 130
wait 10
click compare/show-reference
point picture
wait 4
shoot $out/sandbox-compare.png
click compare/none
drop $work/none.glb
key ctrl+o
wait 4
shoot $out/sandbox-files.png
key escape
quit
SCRIPT
xvfb-run -a -s "-screen 0 1600x1000x24" "$weir" view "$work/restir_di.json" --scene "$scene" --lights 500 \
  --camera=-9,1.5,0.3,9,3,0,75 --size 256x144 --window 1280x720 --device cpu --reference "$here/graphs/all_lights.json" --script "$work/pictures.script"
