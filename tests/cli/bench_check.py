#!/usr/bin/env python3
"""Drives `weir bench` as people do: files that fit their schema, runs that are killed, shards by GNU parallel and by Slurm.

    bench_check.py WEIR SOURCE_DIR DEVICE CASE

Exit status 77: skipped, as what it needs isn't installed.
"""
import copy
import csv
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

WEIR, SOURCE, DEVICE, CASE = sys.argv[1:5]
WEIR = os.path.abspath(WEIR)
DEVICE = os.environ.get("WEIR_TEST_DEVICE", DEVICE)
SKIPPED = 77


def words(out, *more, frames=2):
    return ["bench", SOURCE + "/graphs/restir_di.json", "--scene", SOURCE + "/scenes/cornell.glb", "--size", "16x16", "--device", DEVICE,
            "--warmup", "1", "--frames", str(frames), "--out", out, *more]


SWEEP = ["--sweep", "initial.candidates=1,2,4", "--sweep", "spatial.enabled=true,false"]
ERRORS = ["--reference-graph", SOURCE + "/graphs/all_lights.json", "--repeats", "3", "--error-frames", "4"]


def run(*arguments, status=0):
    done = subprocess.run([WEIR, *arguments], capture_output=True, text=True)
    assert done.returncode == status, f"{arguments}: exit status {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def load(path):
    with open(path) as file:
        return json.load(file)


def ids(path):
    return [c["id"] for c in load(path)["configurations"]]


def case_schema(folder):
    """The file fits its schema, which refuses broken ones; CSV and pictures are there; each point's command measures that point."""
    import jsonschema
    schema = load(SOURCE + "/docs/bench.schema.json")
    jsonschema.Draft7Validator.check_schema(schema)
    out = os.path.join(folder, "a.json")
    run(*words(out, *SWEEP, *ERRORS, "--crop", "2,3,8,9", "--floor"))
    whole = load(out)
    for c in whole["configurations"]:
        floor = c["floor"]
        assert [p["name"] for p in floor["parts"]] == ["camera rays", "shadow rays", "buffers"], floor
        assert all(p["gpu_ms"] > 0 for p in floor["parts"]), floor
        assert abs(sum(p["gpu_ms"] for p in floor["parts"]) - floor["gpu_ms"]) < 1e-9 * floor["gpu_ms"], floor
        assert abs(floor["multiple"] * floor["gpu_ms"] - c["frame"]["gpu_ms"]["median"]) < 1e-6 * c["frame"]["gpu_ms"]["median"], floor
        assert "--floor" in c["command"], c["command"]
    jsonschema.validate(whole, schema)
    assert len(whole["configurations"]) == 6
    for break_it in (lambda c: c.pop("frame"), lambda c: c.update(id="x"), lambda c: c["error"].update(bias=1),
                     lambda c: c["passes"][0].update(gpu_ms=3), lambda c: c.update(unknown=1), lambda c: c["size"].append(3)):
        broken = copy.deepcopy(whole)
        break_it(broken["configurations"][0])
        assert not jsonschema.Draft7Validator(schema).is_valid(broken)
    with open(os.path.join(folder, "a.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    assert [r["id"] for r in rows] == ids(out)
    first = whole["configurations"][0]
    assert float(rows[0]["error.relmse.median.value"]) == first["error"]["relmse"]["median"]["value"]
    for c in whole["configurations"]:
        for name in ("frame", "reference", "flip"):
            with open(os.path.join(folder, c["pictures"][name]), "rb") as file:
                head = file.read(24)
            assert head[:4] == b"\x89PNG" and head[16:24] == bytes([0, 0, 0, 8, 0, 0, 0, 9]), c["pictures"][name]
        e = c["error"]
        assert e["relmse"]["median"]["low"] <= e["relmse"]["median"]["value"] <= e["relmse"]["median"]["high"]
        assert 0 < e["relmse_mean4"]["value"] < e["relmse"]["mean"]["value"], "a mean of four frames is nearer than one"
        assert c["rays"] > 256 and c["memory"]["scene_bytes"] > 0
    # What a switched-off pass costs is nothing, and it is named among the parameters.
    off = [c for c in whole["configurations"] if c["settings"]["spatial.enabled"] is False]
    assert len(off) == 3 and all("spatial" not in [p["name"] for p in c["passes"]] for c in off)
    command = shlex.split(whole["configurations"][3]["command"])
    assert command[0] == "weir"
    done = subprocess.run([WEIR, *command[1:]], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    again = load(os.path.join(folder, "point.json"))["configurations"]
    assert [c["id"] for c in again] == [whole["configurations"][3]["id"]]
    assert again[0]["error"]["relmse"] == whole["configurations"][3]["error"]["relmse"], "same seeds, same pictures"


def kill_when_begun(out, command):
    process = subprocess.Popen([WEIR, *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.time() + 240
    while not (os.path.exists(out) and ids(out)):
        assert time.time() < deadline and process.poll() is None, "it ended before it could be killed"
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert process.returncode == -signal.SIGKILL, "it was done before it could be killed: give it more to do"


def case_kill(folder):
    """A shard that is killed leaves a whole file; run again, it measures what is missing and nothing twice."""
    shards = [os.path.join(folder, f"{i}.json") for i in range(2)]
    commands = [words(shards[i], *SWEEP, "--shard", f"{i}/2", frames=100) for i in range(2)]
    kill_when_begun(shards[0], commands[0])
    before = load(shards[0])["configurations"]
    assert 1 <= len(before) < 3, len(before)
    run(*commands[1])
    # Not complete yet: merging says so, by name, and writes what there is.
    merged = os.path.join(folder, "m.json")
    done = run("bench", "merge", *shards, "--out", merged, status=1)
    assert f"{3 - len(before)} of 6 configurations" in done.stderr and "initial.candidates=4" in done.stderr, done.stderr
    done = run(*commands[0])
    assert f"{3 - len(before)} of 3 configurations measured, {len(before)} were there already" in done.stdout, done.stdout
    assert load(shards[0])["configurations"][:len(before)] == before
    run("bench", "merge", *reversed(shards), "--out", merged)
    at_once = load(shards[1])["plan"]["configurations"]
    assert ids(merged) == [c["id"] for c in at_once], "the plan's order, each once"
    assert not [f for f in os.listdir(folder) if not f.endswith((".json", ".csv"))], os.listdir(folder)
    # Started once more it does nothing; --fresh does all.
    assert "0 of 3 configurations measured, 3 were" in run(*commands[0]).stdout
    assert "3 of 3 configurations measured, 0 were" in run(*commands[0], "--fresh").stdout
    # Another setting is another measurement.
    assert "3 of 3" in run(*commands[0], "--seed", "3").stdout
    assert len(ids(shards[0])) == 6


def together(folder, script, environment):
    out = os.path.join(folder, "all.json")
    done = subprocess.run([SOURCE + "/tools/" + script, "2", *words(out, *SWEEP)[1:]], capture_output=True, text=True,
                          env={**os.environ, "WEIR": WEIR, **environment}, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    whole = load(out)
    assert ids(out) == [c["id"] for c in whole["plan"]["configurations"]] and len(ids(out)) == 6
    parts = [load(os.path.join(folder, f"all.shard-{i}.json")) for i in range(2)]
    assert [len(p["configurations"]) for p in parts] == [3, 3], "both shards had work"


def case_parallel(folder):
    if not shutil.which("parallel"):
        print("skipped: GNU parallel is not installed", file=sys.stderr)
        return SKIPPED
    together(folder, "bench_parallel.sh", {"PARALLEL_HOME": folder})
    return 0


def case_slurm(folder):
    import slurm_cluster
    missing = slurm_cluster.missing()
    if missing:
        print("skipped: not installed: " + " ".join(missing), file=sys.stderr)
        return SKIPPED
    with slurm_cluster.Cluster(folder) as cluster:
        together(folder, "bench_slurm.sh", cluster.environment)
    return 0


with tempfile.TemporaryDirectory(prefix="weir-bench-") as work:
    sys.exit({"schema": case_schema, "kill": case_kill, "parallel": case_parallel, "slurm": case_slurm}[CASE](work) or 0)
