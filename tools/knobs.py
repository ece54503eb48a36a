#!/usr/bin/env python3
"""Changes one parameter of the ReSTIR passes at a time and measures what that does to cost and error.

Every row renders the same frames of graphs/restir_di.json and compares the last one with brute force (graphs/all_lights.json) of the
very same surfaces: the G-buffer's jitter is on, so that temporal rejection has something to reject.

  tools/knobs.py --weir build/release/bin/weir --scene sponza.glb --lights 500 --camera=... --size 1280x720 --json out.json
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

# parameter: (default in the graph, another value)
KNOBS = [
    ("initial.candidates", "32", "8"),
    ("initial.samples", "1", "2"),
    ("initial.uniformShare", "0.1", "0.5"),
    ("initial.triangles", "solidAngle", "area"),
    ("initial.lobeShare", "0.25", "0"),
    ("initial.visibility", "true", "false"),
    ("temporal.confidenceCap", "20", "4"),
    ("temporal.mis", "pairwise", "biased"),
    ("temporal.visibilityRays", "false", "true"),
    ("temporal.depthThreshold", "0.1", "0.001"),
    ("temporal.normalThreshold", "25", "2"),
    ("temporal.albedoThreshold", "1", "0.05"),
    ("spatial.iterations", "1", "2"),
    ("spatial.neighbours", "4", "8"),
    ("spatial.radius", "30", "8"),
    ("spatial.mis", "pairwise", "biased"),
    ("spatial.visibilityRays", "false", "true"),
    ("spatial.depthThreshold", "0.1", "0.001"),
    ("spatial.normalThreshold", "25", "2"),
    ("spatial.albedoThreshold", "1", "0.05"),
]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--weir", default="build/release/bin/weir")
    parser.add_argument("--graphs", default="graphs")
    parser.add_argument("--scene", required=True)
    parser.add_argument("--lights", default="0")
    parser.add_argument("--camera", default="")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--json")
    args = parser.parse_args()
    work = tempfile.mkdtemp(prefix="weir-knobs-")
    common = ["--scene", args.scene, "--size", args.size, "--set", "gbuffer.jitter=true"]
    if args.lights != "0":
        common += ["--lights", args.lights]
    if args.camera:
        common += ["--camera=" + args.camera]

    def weir(*words):
        done = subprocess.run([args.weir, *words], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit("weir " + " ".join(words) + "\n" + done.stderr)
        return done.stdout

    reference = os.path.join(work, "reference.exr")
    weir("render", args.graphs + "/all_lights.json", *common, "--first-frame", str(args.frames - 1), "--out",
         "radiance=" + reference)

    def measure(settings):
        picture, stats = os.path.join(work, "picture.exr"), os.path.join(work, "stats.json")
        sets = [word for s in settings for word in ("--set", s)]
        weir("render", args.graphs + "/restir_di.json", *common, *sets, "--frames", str(args.frames), "--out",
             "radiance=" + picture, "--stats", stats)
        with open(stats) as file:
            figures = json.load(file)
        error = json.loads(weir("compare", picture, reference, "--json", "--no-flip"))
        return {
            "settings": settings,
            "device": figures["device"],
            "passes_ms": {p["name"]: p["gpu_ms"]["median"] for p in figures["passes"]},
            "frame_ms": figures["frame"]["gpu_ms"]["median"],
            "rays": figures["rays"],
            "relmse": error["relmse"],
            "relmse_trimmed": error["relmse_trimmed"],
            "relative_bias": error["relative_bias"],
        }

    rows = [measure([])]
    print("| setting | its pass, ms | frame, ms | rays | relMSE | trimmed |\n|---|---|---|---|---|---|")
    first = rows[0]
    print("| as shipped | | %.3f | %d | %.4f | %.4f |" % (first["frame_ms"], first["rays"], first["relmse"], first["relmse_trimmed"]))
    for name, default, other in KNOBS:
        row = measure([name + "=" + other])
        rows.append(row)
        own = name.split(".")[0]
        print("| %s %s → %s | %.3f → %.3f | %.3f | %d | %.4f | %.4f |" %
              (name, default, other, first["passes_ms"][own], row["passes_ms"][own], row["frame_ms"], row["rays"], row["relmse"],
               row["relmse_trimmed"]), flush=True)
    if args.json:
        with open(args.json, "w") as file:
            json.dump({"scene": os.path.basename(args.scene), "lights": args.lights, "camera": args.camera, "size": args.size,
                       "frames": args.frames, "rows": rows}, file, indent=1)


if __name__ == "__main__":
    main()
