#!/usr/bin/env python3
"""Renders one picture with Blender's Cycles and with Weir and says how far apart they are: docs/offline.md.

    tools/offline/compare.py --scene scenes/interior.glb --bounces 64 --out /tmp/interior-full

Each side is rendered in parts with seeds of their own; parts that FOLDER already has with the same settings are kept, so that either side
can be rendered on another machine (--only) or with more samples later. The spread between parts gives the statistical error. FOLDER gets
the parts, both pictures and their difference as PNG, and figures.json, which is also printed. Exit status: 0 when the bounds are met,
1 when they are not ("verdict" says when that is noise), 2 when something failed.
"""
import argparse
import hashlib
import json
import os
import struct
import subprocess
import sys
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, HERE)
import exr  # noqa: E402
import figures  # noqa: E402


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0: sys.exit("%s\nfailed with status %d:\n%s" % (" ".join(command), done.returncode, done.stdout[-3000:]))
    return done.stdout


def cycles(blender, scene, out, *flags, **options):
    command = [blender, "-b", "-noaudio", "--factory-startup", "--python-exit-code", "1", "--python", os.path.join(HERE, "cycles.py"), "--",
               scene, out, *flags]
    for name, value in options.items(): command += ["--" + name, str(value)]
    run(command)
    if not os.path.exists(out): sys.exit("Blender wrote no '%s'" % out)


def weir(options, out, seed):
    command = [options.weir, "render", options.graph, "--scene", options.scene, "--size", "%dx%d" % (options.size, options.size),
               "--frames", str(options.frames), "--average", str(options.frames), "--seed", str(seed), "--out", "radiance=" + out,
               "--set", "gbuffer.jitter=true"]
    if options.device: command += ["--device", options.device]
    for value in options.set: command += ["--set", value]
    run(command)


def kept(path, settings):
    """Whether this part is there already, rendered with these settings."""
    try:
        with open(path + ".json") as file: return os.path.exists(path) and json.load(file) == settings
    except (OSError, ValueError): return False


def part(path, settings, render):
    if kept(path, settings): return path
    print("rendering %s" % path, file=sys.stderr)
    fresh = os.path.splitext(path)[0] + "-unfinished.exr"
    render(fresh)
    os.replace(fresh, path)
    with open(path + ".json", "w") as file: json.dump(settings, file, indent=2)
    return path


def parts(options):
    with open(options.scene, "rb") as file: scene = {"scene": os.path.basename(options.scene), "sha256": hashlib.sha256(file.read()).hexdigest()}
    found = {"cycles": [], "weir": []}
    size = "%dx%d" % (options.size, options.size)
    settings = {"cycles": {**scene, "samples": options.samples, "bounces": options.bounces, "size": size},
                "weir": {**scene, "graph": os.path.basename(options.graph), "frames": options.frames, "set": options.set, "size": size}}
    count = {"cycles": options.cycles_parts, "weir": options.parts}
    for seed in range(1, max(count.values()) + 1):
        for side in found:
            if options.only not in (None, side) or seed > count[side]: continue
            if side == "cycles":
                def render(out): cycles(options.blender, options.scene, out, samples=options.samples, bounces=options.bounces, size=size,
                                        seed=seed, threads=options.threads)
            else:
                def render(out): weir(options, out, seed)
            found[side].append(part(os.path.join(options.out, "%s-%d.exr" % (side, seed)), {**settings[side], "seed": seed}, render))
    return found, settings


def shown(value, exposure):
    """sRGB's curve."""
    value = max(0.0, value * exposure)
    return 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055


def pictures(folder, a, b):
    """Both sides, and their difference: grey is none, white and black are +-5 % of the reference."""
    middle = sum(sum(plane) for plane in b.rgb) / (3 * b.width * b.height)
    for name, p in (("weir", a), ("cycles", b)):
        exr.write_png(os.path.join(folder, name + ".png"), p.width, p.height,
                      lambda x, y, p=p: [shown(plane[y * p.width + x], 0.25 / middle) for plane in p.rgb])
    def difference(x, y):
        i = y * b.width + x
        return [0.5 + 10 * (pa[i] - pb[i]) / max(pb[i], 0.01 * middle) for pa, pb in zip(a.rgb, b.rgb)]
    exr.write_png(os.path.join(folder, "difference.png"), b.width, b.height, difference)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", required=True, help="a .glb of Lambertian surfaces with a camera")
    parser.add_argument("--bounces", type=int, required=True, help="0: direct light; n: up to n bounces of indirect light")
    parser.add_argument("--out", required=True, metavar="FOLDER", help="of this comparison's own")
    parser.add_argument("--size", type=int, default=256, help="pixels a side (%(default)s)")
    parser.add_argument("--parts", type=int, default=4, help="of each side, at least 2 (%(default)s)")
    parser.add_argument("--cycles-parts", type=int, help="of Cycles' side, where it wants more or fewer")
    parser.add_argument("--samples", type=int, default=1024, help="Cycles' samples a pixel and part (%(default)s)")
    parser.add_argument("--frames", type=int, default=1024, help="Weir's frames a part (%(default)s)")
    parser.add_argument("--only", choices=("cycles", "weir"), help="render the parts of this side, compare nothing")
    parser.add_argument("--graph", default=os.path.join(ROOT, "graphs", "reference.json"))
    parser.add_argument("--set", action="append", metavar="PASS.PARAM=VALUE", help="for Weir; default path.maxBounces=BOUNCES")
    parser.add_argument("--weir", default=os.path.join(ROOT, "build", "release", "bin", "weir"))
    parser.add_argument("--device", help="Weir's")
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="Cycles'")
    options = parser.parse_args()
    if options.cycles_parts is None: options.cycles_parts = options.parts
    if min(options.parts, options.cycles_parts) < 2: parser.error("--parts must be at least 2: the spread between them is the error")
    if options.size % figures.SIDE: parser.error("--size must be a multiple of %d, the side of a tile" % figures.SIDE)
    if options.set is None: options.set = ["path.maxBounces=%d" % options.bounces]
    return options


def main():
    options = arguments()
    os.makedirs(options.out, exist_ok=True)
    found, settings = parts(options)
    if options.only: return 0
    a, b = ([exr.read(path) for path in found[side]] for side in ("weir", "cycles"))
    result = {"cycles": settings["cycles"], "weir": settings["weir"], "parts": options.parts, "cycles_parts": options.cycles_parts,
              **figures.compare(a, b)}
    with open(os.path.join(options.out, "figures.json"), "w") as file: file.write(json.dumps(result, indent=2) + "\n")
    print(json.dumps(result, indent=2))
    pictures(options.out, exr.Picture.mean(a), exr.Picture.mean(b))
    return 0 if result["met"] else 1


if __name__ == "__main__":
    try: sys.exit(main())
    except SystemExit as stop:
        if isinstance(stop.code, str):
            print(stop.code, file=sys.stderr)
            sys.exit(2)
        raise
    except (OSError, ValueError, KeyError, IndexError, struct.error, zlib.error) as error:
        print("compare: %s" % error, file=sys.stderr)
        sys.exit(2)
