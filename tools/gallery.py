#!/usr/bin/env python3
"""Renders every scene of a folder of glTF scenes (shared scenes, one folder each) into a contact sheet.

  tools/gallery.py --scenes FOLDER --out OUTDIR [--page FILE.md] [--only NAME] [--size 320x240] [--frames 8] [--shown]
  tools/gallery.py --scenes FOLDER --out docs/gallery --page docs/gallery.md --frames 24 --shown

OUTDIR gets one PNG a scene, the page (OUTDIR/index.md unless told) a table of them with what each file is known to show. A
scene that fails is a row with the program's own message, and the exit status is then 1. `--shown`: just those whose licences
allow showing the picture.
"""
import argparse
import os
import subprocess
import sys

SKY = ["--environment", "scenes/sky.hdr"]
# name: (file below the scenes' folder, options, what it must show, credit if it may be shown)
SCENES = {
    "sponza": ("sponza/sponza.glb", ["--lights", "500", "--camera=-8,4,-0.5,0,3.5,-0.2,70"], "courtyard, masked plants and chains", None),
    "modern-hall": ("modern-hall/modern-hall.glb", ["--exposure", "1"], "interior lit by 13 small area lights",
                    "“Modern Hall” by NewSee2l035, CC-BY 3.0"),
    "veach-ajar": ("veach-ajar/veach-ajar.glb", ["--exposure", "4"], "light behind a door: black in direct light but for the gap",
                   None),
    "scifi-helmet": ("scifi-helmet/scifi-helmet.glb", SKY, "metallic helmet", "“SciFi Helmet” by Michael Pavlovic, CC0"),
    "metal-rough-spheres": ("metal-rough-spheres/metal-rough-spheres.glb", SKY, "12 rows of spheres",
                            "“PBR Spheres” by the Babylon.js team, CC-BY 4.0"),
    "roughness-spheres": ("roughness-spheres/roughness-spheres.glb", SKY, "roughness by factor and by texture look alike",
                          "Roughness scale by Tomasz Stachowiak, CC0"),
    "boombox-spec-gloss": ("boombox-spec-gloss/boombox-spec-gloss.glb", SKY, "specular-glossiness, lit display", None),
    "alpha-blend-mode-test": ("alpha-blend-mode-test/alpha-blend-mode-test.glb", SKY, "alpha modes; cutoffs agree with the marks",
                              "“Alpha Blend Mode Test” by Ed Mackey, CC-BY 4.0"),
    "sphere-punctual-lights": ("sphere-punctual-lights/sphere-punctual-lights.glb", ["--exposure", "3"], "1 point, 1 directional, 2 spots",
                               "Draco test data “sphere_lights”, Google, Apache-2.0"),
    "box-animated": ("box-animated/box-animated.glb", [*SKY, "--animate", "--time-step", "0", "--time", "1.5"], "inner box lifted, outer turning", None),
    "cesium-man": ("cesium-man/cesium-man.glb", [*SKY, "--animate", "--time-step", "0", "--time", "0.5"], "a walking man", None),
    "rigged-simple": ("rigged-simple/rigged-simple.glb", [*SKY, "--animate", "--time-step", "0", "--time", "0.8"], "a bent column", None),
    "fox": ("fox/fox.glb", [*SKY, "--animate", "--time-step", "0", "--clip", "Run", "--time", "0.3"], "a running fox",
            "“Fox” by PixelMannen (CC0), tomkranis and AsoboStudio (CC-BY 4.0)"),
    "simple-morph": ("simple-morph/SimpleMorph.gltf", [*SKY, "--animate", "--time-step", "0", "--time", "1"], "a triangle, its tip moved", None),
    "animated-morph-sphere": ("animated-morph-sphere/AnimatedMorphSphere.gltf", [*SKY, "--animate", "--time-step", "0", "--time", "1"], "a deformed sphere",
                              "“Animated Morph Sphere” by Howard Wolosky, CC0"),
    "simple-sparse-accessor": ("simple-sparse-accessor/SimpleSparseAccessor.gltf", SKY, "a strip with a raised edge", None),
    "texture-settings-test": ("texture-settings-test/TextureSettingsTest.gltf", SKY, "every cell has a green tick; the single-sided plane before the first casts its shadow on it",
                              "“Texture Settings Test” by Ed Mackey, CC-BY 4.0"),
    "texture-coordinate-test": ("texture-coordinate-test/TextureCoordinateTest.gltf", [*SKY, "--camera=0,0,-4,0,0,0,40"], "corners named where they are",
                                "“Texture Coordinate Test” by Ed Mackey, CC-BY 4.0"),
    "normal-tangent-test": ("normal-tangent-test/NormalTangentTest.gltf", SKY, "each pair is lit alike",
                            "“Normal Tangent Test” by Ed Mackey, CC-BY 4.0"),
    "cameras": ("cameras/Cameras.gltf", SKY, "a square, perspective", None),
    "box-interleaved": ("box-interleaved/BoxInterleaved.gltf", SKY, "a box", None),
    "duck-quantized": ("duck-quantized/Duck.gltf", SKY, "a yellow duck", None),
    "duck-draco": ("duck-draco/Duck.gltf", SKY, "the same yellow duck", None),
}


def find(folder, wanted):
    """The file, or the only glTF file of its folder: names of the files inside differ from one copy to the next."""
    path = os.path.join(folder, wanted)
    if os.path.exists(path):
        return path
    inside = os.path.dirname(path)
    files = sorted(f for f in os.listdir(inside) if f.endswith((".gltf", ".glb"))) if os.path.isdir(inside) else []
    return os.path.join(inside, files[0]) if files else None


def groups(folder):
    """The asset generator's groups: name, file."""
    root = os.path.join(folder, "asset-generator")
    for group in sorted(os.listdir(root)) if os.path.isdir(root) else []:
        for file in sorted(os.listdir(os.path.join(root, group))):
            if file.endswith((".gltf", ".glb")):
                yield os.path.splitext(file)[0], os.path.join(root, group, file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--weir", default="build/release/bin/weir")
    parser.add_argument("--graph", default="graphs/restir_di.json")
    parser.add_argument("--scenes", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--page")
    parser.add_argument("--only", action="append", help="names that contain this; may be given again")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--shown", action="store_true")
    args = parser.parse_args()
    os.makedirs(args.out, exist_ok=True)
    page = args.page or os.path.join(args.out, "index.md")
    pictures = os.path.relpath(args.out, os.path.dirname(page) or ".")

    jobs = [(name, find(args.scenes, file), options, note, credit) for name, (file, options, note, credit) in SCENES.items()
            if credit or not args.shown]
    if not args.shown:
        jobs += [(name, path, [*SKY, *(["--animate", "--time-step", "0", "--time", "1"] if name.startswith("Animation") else [])], "", None)
                 for name, path in groups(args.scenes)]
    if args.only:
        jobs = [job for job in jobs if any(word in job[0] for word in args.only)]

    failed = 0
    rows = ["| scene | picture | shows | |", "|---|---|---|---|"]
    for name, path, options, note, credit in jobs:
        if path is None:
            print(f"{name}: absent", file=sys.stderr)
            continue
        command = [args.weir, "render", args.graph, "--scene", path, "--size", args.size, "--frames", str(args.frames), "--average",
                   str(args.frames), *options, "--out", "color=" + os.path.join(args.out, name + ".png")]
        done = subprocess.run(command, capture_output=True, text=True)
        said = " ".join(done.stderr.split())
        if done.returncode != 0:
            failed += 1
            print(f"{name}: exit status {done.returncode}: {said}", file=sys.stderr)
            rows.append(f"| {name} | – | {note} | {said} |")
        else:
            print(f"{name}: done {said}", flush=True)
            rows.append(f"| {name} | ![{name}]({os.path.join(pictures, name)}.png) | {note} | {credit or ''} |")
    with open(page, "w") as file:
        file.write("\n".join(["# Gallery", "", f"Made by `tools/gallery.py`: `{args.graph}`, {args.size}, the mean of {args.frames} frames; "
                              "direct light only.", "", *rows]) + "\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
