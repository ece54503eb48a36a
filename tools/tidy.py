#!/usr/bin/env python3
"""clang-tidy 14 over the program (framework, passes, plugins, sandbox), as .clang-tidy says. Standard library only.

    tools/tidy.py [BUILD_FOLDER] [--only TEXT]     default build/release; --only: files whose path holds TEXT

A file that passed is not looked at again until it, a header that it includes, its compile command, .clang-tidy or
clang-tidy itself changes: .cache/clang-tidy/ holds one empty file for each such combination. Exit status 1: findings.
"""
import argparse
import concurrent.futures
import functools
import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CACHE = os.path.join(ROOT, ".cache", "clang-tidy")
FOLDERS = ("framework", "passes", "plugins", "sandbox")
# Nothing but the implementation of somebody else's header.
SKIPPED = {"framework/gpu/vma.cpp", "framework/gpu/volk.cpp"}
# g++ knows these, clang 14 doesn't.
DROPPED_FLAGS = {"-fno-gnu-unique"}


def clang_tidy():
    program = shutil.which("clang-tidy-14") or shutil.which("clang-tidy")
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout if program else ""
    if "version 14." not in version:
        sys.exit("tidy.py: clang-tidy 14 is wanted (other versions find other things)")
    return program, version


def commands(build):
    """Source file relative to the root → its arguments as clang 14 takes them, and its object."""
    found = {}
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        for entry in json.load(file):
            name = os.path.relpath(entry["file"], ROOT)
            if name.split(os.sep)[0] not in FOLDERS or name in SKIPPED:
                continue
            words = shlex.split(entry["command"])
            if os.path.basename(words[0]) == "ccache":
                words = words[1:]
            words = ["-std=c++2b" if w in ("-std=c++23", "-std=gnu++23") else w for w in words if w not in DROPPED_FLAGS]
            found[name] = (words, entry["output"] if "output" in entry else words[words.index("-o") + 1])
    return found


def included(build):
    """Object → the files that it was made from, as the last build saw them."""
    text = subprocess.run(["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True, check=True).stdout
    result, current = {}, []
    for line in text.splitlines():
        if line and not line.startswith(" "):
            current = result.setdefault(line.split(":")[0], [])
        elif line.strip():
            current.append(os.path.normpath(os.path.join(build, line.strip())))
    return result


@functools.lru_cache(maxsize=None)
def digest(path):
    """Of a project file its bytes; of a system header its size, which is enough to notice another version."""
    real = os.path.realpath(path)
    if not real.startswith(ROOT + os.sep):
        return str(os.path.getsize(real)) if os.path.exists(real) else "gone"
    with open(real, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def key(name, words, sources, general):
    own = os.path.join(ROOT, name.split(os.sep)[0], ".clang-tidy")  # a folder may leave out checks
    text = [general, digest(own) if os.path.exists(own) else "", " ".join(words).replace(ROOT, "."), name, digest(os.path.join(ROOT, name))]
    text += sorted(f"{os.path.relpath(os.path.realpath(s), ROOT)} {digest(s)}" for s in sources)
    return hashlib.sha256("\n".join(text).encode()).hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", default="build/release")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    build = os.path.abspath(options.build)
    program, version = clang_tidy()
    os.makedirs(CACHE, exist_ok=True)
    database = commands(build)
    with open(os.path.join(CACHE, "compile_commands.json"), "w", encoding="utf-8") as file:
        json.dump([{"directory": build, "file": os.path.join(ROOT, n), "arguments": w} for n, (w, _) in database.items()], file)

    general = version + digest(os.path.join(ROOT, ".clang-tidy"))
    made_from = included(build)
    stamps = {name: os.path.join(CACHE, key(name, words, made_from.get(output, []), general))
              for name, (words, output) in database.items() if options.only in name}
    pending = [name for name, stamp in stamps.items() if not os.path.exists(stamp)]
    print(f"clang-tidy: {len(pending)} of {len(stamps)} files to look at", flush=True)

    def look(name):
        start = time.monotonic()
        run = subprocess.run([program, "-p", CACHE, "--quiet", os.path.join(ROOT, name)], capture_output=True, text=True)
        return name, run, time.monotonic() - start

    bad, done = [], 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, run, seconds in pool.map(look, pending):
            done += 1
            print(f"[{done}/{len(pending)}] {seconds:5.1f} s {name}", flush=True)
            if run.returncode == 0:
                open(stamps[name], "w", encoding="utf-8").close()
            else:
                bad.append(name)
                print(run.stdout + ("" if run.stdout.strip() else run.stderr), flush=True)

    # What no file of today stands for any more, and is a month old, goes.
    current = set(stamps.values())
    for entry in os.scandir(CACHE):
        if len(entry.name) == 64 and entry.path not in current and time.time() - entry.stat().st_mtime > 30 * 86400:
            os.remove(entry.path)
    if bad:
        sys.exit(f"clang-tidy: findings in {len(bad)} files: " + ", ".join(bad))


if __name__ == "__main__":
    main()
