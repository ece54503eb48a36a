#!/usr/bin/env python3
"""Error at equal time of restir_di's estimators: MIS weights, visibility in them, rays along the BSDF.

Every combination renders the same scene in independent restarts; measured are the GPU's time for a frame and the error (relMSE) of ONE
frame after N frames (the mean over the restarts) and of the mean of those N frames: reuse makes frames alike, so that the two can rank
methods in opposite order. Error times time is what says which is better: an estimator without reuse halves its error in twice the time.

  tools/modes.py --weir build/release/bin/weir --scene scenes/cornell.glb --size 640x640 --frames 32 --restarts 8 --json modes.json --markdown modes.md
  tools/modes.py ... --mis z pairwise --rays on --bsdf-rays 0 1 2 --set spatial.neighbours=5 -- --lights 500

Words after -- go to every `weir render`. Without --reference the reference is reference.AllLights, averaged over --reference-frames.
"""
import argparse
import concurrent.futures
import itertools
import json
import math
import os
import subprocess
import sys
import tempfile

SWITCH = {"on": "true", "off": "false"}


def unbiased(mis, rays, visibility, bsdf_rays):
    """As the table in docs/estimators.md has it."""
    return mis != "biased" and (rays == "on" or (visibility == "off" and bsdf_rays == 0))


def settings_of(mis, rays, visibility, bsdf_rays, passes):
    settings = ["initial.visibility=" + SWITCH[visibility], "initial.bsdfRays=%d" % bsdf_rays]
    for name in passes:
        settings += ["%s.mis=%s" % (name, mis), "%s.visibilityRays=%s" % (name, SWITCH[rays])]
    return settings


def mean_and_error(values):
    """Mean and its standard error; None for the latter from a single value."""
    mean = math.fsum(values) / len(values)
    if len(values) < 2:
        return mean, None
    return mean, math.sqrt(math.fsum((v - mean) ** 2 for v in values) / (len(values) * (len(values) - 1)))


class Failed(Exception):
    """What was wrong, and the exit status for it: 2 bad input, 1 failed while running."""

    def __init__(self, text, status):
        super().__init__(text)
        self.status = status


def write_whole(path, text):
    """Beside it first, then renamed: a file is there whole or not at all."""
    with open(path + ".unfinished", "w") as file:
        file.write(text)
    os.replace(path + ".unfinished", path)


class Weir:
    def __init__(self, binary, words):
        self.binary, self.words = binary, words

    def run(self, *words):
        try:
            done = subprocess.run([self.binary, *words], capture_output=True, text=True)
        except OSError as error:
            raise Failed("%s: %s" % (self.binary, error.strerror), 2) from error
        if done.returncode != 0:
            raise Failed("weir " + " ".join(words) + "\n" + done.stderr.strip(), done.returncode)
        return done.stdout

    def render(self, graph, *words):
        return self.run("render", graph, *self.words, *words)

    def compare(self, picture, reference):
        return json.loads(self.run("compare", picture, reference, "--json", "--no-flip"))


def errors(weir, graph, settings, args, reference, folder, restart):
    """Of one restart: the comparison of its last frame with the reference, and that of the mean of its frames."""
    picture, mean = (os.path.join(folder, name) for name in ("picture.exr", "mean.exr"))
    common = words_of(settings) + ["--frames", str(args.frames), "--seed", str(args.seed + 7919 * restart)]
    weir.render(graph, *common, "--out", "radiance=" + picture)
    weir.render(graph, *common, "--average", str(args.frames), "--out", "radiance=" + mean)
    result = weir.compare(picture, reference), weir.compare(mean, reference)
    if any(error["relative_bias"] is None for error in result):
        raise Failed("the reference is black: no error is relative to it", 2)
    os.remove(picture)
    os.remove(mean)
    return result


def times(weir, graph, settings, args, folder):
    """What --stats says of frames that nothing else runs beside."""
    stats = os.path.join(folder, "stats.json")
    weir.render(graph, *words_of(settings), "--frames", str(args.timed_frames), "--seed", str(args.seed), "--out",
                "radiance=" + os.path.join(folder, "timed.exr"), "--stats", stats)
    with open(stats) as file:
        return json.load(file)


def words_of(settings):
    return [word for s in settings for word in ("--set", s)]


def row_of(settings, restarts, figures, args):
    """One combination: the times of a frame and the errors over restarts."""
    row = {"settings": settings, "device": figures["device"], "frame_ms": figures["frame"]["gpu_ms"]["median"],
           "frame_p95_ms": figures["frame"]["gpu_ms"]["p95"],
           "passes_ms": {p["name"]: p["gpu_ms"]["median"] for p in figures["passes"]}, "rays": figures["rays"]}
    for name, values in (("one_frame", [last[args.metric] for last, _ in restarts]), ("mean", [mean[args.metric] for _, mean in restarts]),
                         ("relative_bias", [mean["relative_bias"] for _, mean in restarts])):
        row[name], row[name + "_error"] = mean_and_error(values)
    row["one_frame_at_equal_time"] = row["one_frame"] * row["frame_ms"]
    row["mean_at_equal_time"] = row["mean"] * row["frame_ms"] * args.frames
    return row


def table(rows, metric):
    """Markdown, best single frame at equal time first."""
    lines = ["| mis | rays | Initial.visibility | bsdfRays | unbiased | frame, ms | rays/frame | %s, one frame | × ms | %s, mean | × ms | bias, %% |"
             % (metric, metric), "|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for r in sorted(rows, key=lambda row: row["one_frame_at_equal_time"]):
        def figure(name):
            error = r[name + "_error"]
            return "%.4g" % r[name] + (" ± %.1g" % error if error is not None else "")
        bias = "%+.3f" % (100 * r["relative_bias"])
        if r["relative_bias_error"] is not None:
            bias += " ± %.3f" % (100 * r["relative_bias_error"])
        lines.append("| %s | %s | %s | %d | %s | %.3f | %d | %s | %.4g | %s | %.4g | %s |" %
                     (r["mis"], r["visibilityRays"], r["visibility"], r["bsdfRays"], "yes" if r["unbiased"] else "no", r["frame_ms"],
                      r["rays"], figure("one_frame"), r["one_frame_at_equal_time"], figure("mean"), r["mean_at_equal_time"], bias))
    return "\n".join(lines) + "\n"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--weir", default="build/release/bin/weir")
    parser.add_argument("--graph", default="graphs/restir_di.json")
    parser.add_argument("--reference-graph", default="graphs/all_lights.json")
    parser.add_argument("--reference", help="EXR of the same view; default: rendered by --reference-graph")
    parser.add_argument("--reference-frames", type=int, default=16)
    parser.add_argument("--scene", required=True)
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--frames", type=int, default=32)
    parser.add_argument("--restarts", type=int, default=4)
    parser.add_argument("--timed-frames", type=int, default=64, help="of the render that gives the times")
    parser.add_argument("--jobs", type=int, default=1, help="renders at once while errors are measured; times are measured alone")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--metric", default="relmse", choices=["relmse", "relmse_trimmed", "mse", "mape"])
    parser.add_argument("--mis", nargs="+", default=["biased", "z", "balance", "pairwise"], choices=["biased", "z", "balance", "pairwise"])
    parser.add_argument("--rays", nargs="+", default=["off", "on"], choices=["off", "on"])
    parser.add_argument("--visibility", nargs="+", default=["on", "off"], choices=["off", "on"], help="of Initial")
    parser.add_argument("--bsdf-rays", nargs="+", type=int, default=[0])
    parser.add_argument("--passes", nargs="+", default=["temporal", "spatial"], help="the graph's passes that reuse")
    parser.add_argument("--set", nargs="+", default=[], help="for every combination, as weir's --set")
    parser.add_argument("--unbiased", action="store_true", help="leave out combinations that are known to be biased")
    parser.add_argument("--json")
    parser.add_argument("--markdown")
    parser.add_argument("words", nargs="*", help="after --: for every weir render (--lights, --camera, --device, ...)")
    args = parser.parse_args()
    if min(args.restarts, args.frames, args.timed_frames, args.jobs) < 1:
        parser.error("--restarts, --frames, --timed-frames and --jobs must be at least 1")
    for path in filter(None, (args.json, args.markdown)):  # now, not after an hour of measuring
        folder = os.path.dirname(path) or "."
        if os.path.isdir(path) or not os.path.isdir(folder) or not os.access(folder, os.W_OK):
            parser.error("can't write '%s'" % path)
    return args


def main():
    args = arguments()
    weir = Weir(args.weir, ["--scene", args.scene, "--size", args.size, *args.words])
    with tempfile.TemporaryDirectory(prefix="weir-modes-") as work:
        reference = args.reference
        if not reference:
            reference = os.path.join(work, "reference.exr")
            count = str(args.reference_frames)
            sets = [word for s in args.set if s.startswith("gbuffer.") for word in ("--set", s)]
            weir.render(args.reference_graph, *sets, "--frames", count, "--average", count, "--seed", str(args.seed + 1), "--out",
                        "radiance=" + reference)
        combinations = []
        for mis, rays, visibility, bsdf_rays in itertools.product(args.mis, args.rays, args.visibility, args.bsdf_rays):
            is_unbiased = unbiased(mis, rays, visibility, bsdf_rays)
            if is_unbiased or not args.unbiased:
                combinations.append((args.set + settings_of(mis, rays, visibility, bsdf_rays, args.passes),
                                     {"mis": mis, "visibilityRays": rays, "visibility": visibility, "bsdfRays": bsdf_rays, "unbiased": is_unbiased}))
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            runs = [[pool.submit(errors, weir, args.graph, settings, args, reference, tempfile.mkdtemp(dir=work), r) for r in range(args.restarts)]
                    for settings, _ in combinations]
            try:
                restarts = [[run.result() for run in of_one] for of_one in runs]
            except Failed:
                pool.shutdown(cancel_futures=True)
                raise
        rows = []
        for (settings, names), of_one in zip(combinations, restarts):
            row = row_of(settings, of_one, times(weir, args.graph, settings, args, work), args)
            row.update(names)
            rows.append(row)
            print("%-8s rays %-3s visibility %-3s bsdfRays %d: %.3f ms, %s %.4g, of the mean %.4g" %
                  (row["mis"], row["visibilityRays"], row["visibility"], row["bsdfRays"], row["frame_ms"], args.metric, row["one_frame"], row["mean"]),
                  file=sys.stderr, flush=True)
    text = table(rows, args.metric)
    print(text, end="")
    if args.markdown:
        write_whole(args.markdown, text)
    if args.json:
        write_whole(args.json, json.dumps({"scene": os.path.basename(args.scene), "words": args.words, "size": args.size, "frames": args.frames,
                                           "restarts": args.restarts, "metric": args.metric, "set": args.set, "rows": rows}, indent=1))


if __name__ == "__main__":
    try:
        main()
    except Failed as failure:
        print("modes: %s" % failure, file=sys.stderr)
        sys.exit(failure.status)
