#!/usr/bin/env python3
"""Throws every malformed glTF file of a folder at `weir scene` and `weir render` and checks how they end.

    tools/corpus.py [FOLDER] [--weir build/release/bin/weir] [--json OUT.json] [--jobs N] [--only TEXT] [--quick]

Good is: exit status 0, or 2 with a message; no signal; no sanitizer report; at most 5 s of processor time, compiling
shaders left out, and 1 GiB of memory each, with sanitizers or without. FOLDER
(default: malformed in $WEIR_SCENES, else in ../shared/scenes) may have an INDEX.tsv that names the files and their faults;
without it every .gltf and .glb counts. --quick renders only files that `weir scene` accepts. Exit status: 1 if any file
fails, 77 without a folder.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SECONDS, MEBIBYTES = 5.0, 1024
SANITIZER = re.compile(r"(AddressSanitizer|LeakSanitizer|runtime error:)[^\n]*")


def files_of(folder):
    index = folder / "INDEX.tsv"
    if index.exists():
        rows = [line.split("\t") for line in index.read_text().splitlines()[1:] if line.strip()]
        return [(row[0], row[1] if len(row) > 1 else "") for row in rows]
    found = [p for p in folder.rglob("*") if p.suffix in (".gltf", ".glb")]
    return [(str(p.relative_to(folder)), "") for p in sorted(found)]


def run(command):
    """How a process ended, what it took, and what is wrong with that (an empty text: nothing)."""
    env = dict(os.environ, ASAN_OPTIONS="detect_leaks=0:allocator_may_return_null=0:detect_odr_violation=0",
               UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1")
    cpu = 60
    start = time.monotonic()
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=output, env=env, preexec_fn=lambda:
                                   resource.setrlimit(resource.RLIMIT_CPU, (cpu, cpu + 1)))
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read().decode(errors="replace")
    result = {"exit": process.returncode, "cpu_seconds": round(usage.ru_utime + usage.ru_stime, 3),
              "wall_seconds": round(time.monotonic() - start, 3), "mebibytes": usage.ru_maxrss // 1024}
    message = [line for line in text.splitlines() if line.strip() and not line.startswith("warning:")]
    result["message"] = message[0][:300] if message else ""
    report = SANITIZER.search(text)
    problem = ""
    if report:
        problem = report.group(0)[:200]
    elif process.returncode < 0:
        problem = f"signal {-process.returncode}"
    elif process.returncode not in (0, 2):
        problem = f"exit status {process.returncode}"
    elif process.returncode == 2 and not message:
        problem = "refused without a message"
    elif result["cpu_seconds"] > SECONDS:
        problem = f"{result['cpu_seconds']} s of processor time"
    elif result["mebibytes"] > MEBIBYTES:
        problem = f"{result['mebibytes']} MiB"
    result["problem"] = problem
    return result


def run_warm(command):
    """As run(); what takes too long gets a second try, with the shaders that the first one has compiled and kept."""
    result = run(command)
    return run(command) if "processor time" in result["problem"] else result


def one(task):
    folder, name, faults, weir, quick = task
    path = str(folder / name)
    row = {"file": name, "faults": faults, "scene": run([weir, "scene", path])}
    if not (quick and row["scene"]["exit"] == 2):
        with tempfile.TemporaryDirectory() as out:
            row["render"] = run_warm([weir, "render", str(ROOT / "graphs/restir_di.json"), "--scene", path, "--size", "8x8",
                                      "--device", "cpu", "--out", f"color={out}/c.png"])
    for part in ("scene", "render"):
        if part in row:
            row[part]["message"] = row[part]["message"].replace(str(folder) + "/", "")
    return row


def as_text(head, rows):
    """JSON with a line for each file."""
    lines = ",\n".join("  " + json.dumps(row) for row in rows)
    return json.dumps(head)[:-1] + ', "files": [\n' + lines + "\n]}\n"


def table(rows):
    """By where the files come from: how many, and how they ended."""
    lines = ["| from | files | scenes | refused | failed | most processor time | most memory |",
             "|---|---|---|---|---|---|---|"]
    groups = {}
    for row in rows:
        groups.setdefault(row["file"].split("/")[0], []).append(row)
    for name, group in sorted(groups.items()) + [("all", rows)]:
        runs = [r[part] for r in group for part in ("scene", "render") if part in r]
        count = lambda test: sum(1 for r in group if test(r))
        failed = count(lambda r: any(r[p]["problem"] for p in ("scene", "render") if p in r))
        lines.append(f"| {name} | {len(group)} | {count(lambda r: r['scene']['exit'] == 0)} "
                     f"| {count(lambda r: r['scene']['exit'] == 2)} | {failed} "
                     f"| {max(r['cpu_seconds'] for r in runs):.2f} s | {max(r['mebibytes'] for r in runs)} MiB |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    scenes = pathlib.Path(os.environ.get("WEIR_SCENES", ROOT / "../shared/scenes"))
    parser.add_argument("folder", type=pathlib.Path, nargs="?", default=scenes / "malformed")
    parser.add_argument("--weir", default=str(ROOT / "build/release/bin/weir"))
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default="", help="only files with this in their name")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    folder = options.folder.resolve()
    if not folder.is_dir():
        print(f"*** NO MALFORMED FILES AT {folder}: SKIPPED ***", file=sys.stderr)
        return 77  # ctest's "skipped"
    sanitized = b"__asan_init" in pathlib.Path(options.weir).read_bytes()
    tasks = [(folder, name, faults, options.weir, options.quick)
             for name, faults in files_of(folder) if options.only in name]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        rows = list(pool.map(one, tasks))
    failed = 0
    for row in rows:
        for part in ("scene", "render"):
            if part in row and row[part]["problem"]:
                failed += 1
                print(f"FAILED {row['file']}: weir {part}: {row[part]['problem']}: {row[part]['message']}")
    if options.json:
        options.json.write_text(as_text({"limits": {"cpu_seconds": SECONDS, "mebibytes": MEBIBYTES},
                                         "sanitizers": sanitized}, rows))
    print(table(rows))
    return 1 if failed or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
