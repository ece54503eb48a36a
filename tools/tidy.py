#!/usr/bin/env python3
"""clang-tidy 14 over the program (framework, passes, plugins, sandbox), as .clang-tidy says. Standard library only.

    tools/tidy.py [BUILD_FOLDER] [--only TEXT]     default build/release; --only: files whose path holds TEXT

A file that passed is not looked at again until it, a header that it includes, its compile command, .clang-tidy or
clang-tidy itself changes: .cache/clang-tidy/ holds one empty file for each such combination. Exit status 1: findings.

Headers take most of the time, so the files of a folder that are compiled alike are looked at as one text, their headers
read once. Files that something is said of, which may be no more than that two give different things the same name, are
then looked at apart from the others: only what is said of a file by itself counts.
"""
import argparse
import bisect
import collections
import concurrent.futures
import functools
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CACHE = os.path.join(ROOT, ".cache", "clang-tidy")
FOLDERS = ("framework", "passes", "plugins", "sandbox")
# Nothing but the implementation of somebody else's header.
SKIPPED = {"framework/gpu/vma.cpp", "framework/gpu/volk.cpp"}
# g++ knows these, clang 14 doesn't.
DROPPED_FLAGS = {"-fno-gnu-unique"}
MOST_TOGETHER = 16


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
    text = [general, " ".join(words).replace(ROOT, "."), name, digest(os.path.join(ROOT, name))]
    folder = os.path.dirname(name)
    while folder:  # any folder may leave out checks
        own = os.path.join(ROOT, folder, ".clang-tidy")
        text.append(digest(own) if os.path.exists(own) else "")
        folder = os.path.dirname(folder)
    text += sorted(f"{os.path.relpath(os.path.realpath(s), ROOT)} {digest(s)}" for s in sources)
    return hashlib.sha256("\n".join(text).encode()).hexdigest()


def own_names(name):
    """What a file seems to define in its unnamed namespaces: functions with what they take."""
    with open(os.path.join(ROOT, name), encoding="utf-8") as file:
        parts = re.findall(r"^namespace \{\n(.*?)^\}  // namespace$", file.read(), re.DOTALL | re.MULTILINE)
    definition = r"^(?!using |namespace |template|//|#|\})[\w:<][\w:<>,*&\[\] ]*?\b(\w+)\s*(?:[{=;]|\[|: |(\(.*))"
    return set(re.findall(definition, "\n".join(parts), re.MULTILINE))


def batches(pending, database):
    """The files to look at, as lists of those that lie in one folder, are compiled alike, and define no name twice."""
    alike = collections.defaultdict(list)
    for name in pending:
        words = database[name][0]
        alike[os.path.dirname(name), " ".join(words[:words.index("-o")])].append(name)
    for names in alike.values():
        parts = []
        for name in names:
            own = own_names(name)
            part = next((p for p in parts if len(p[0]) < MOST_TOGETHER and not p[1] & own), None)
            if part is None:
                part = ([], set())
                parts.append(part)
            part[0].append(name)
            part[1].update(own)
        yield from (part[0] for part in parts)


def together(names, words, build, place):
    """clang-tidy's arguments for `names` as one text, and the last line of each in it. The text is a file that is in
    their folder for clang-tidy alone, so that includes and .clang-tidy are found as from there."""
    text, lines = "", []
    for number, name in enumerate(names):
        with open(os.path.join(ROOT, name), encoding="utf-8") as file:
            # A macro's definition makes readability-duplicate-include forget what was included before.
            text += f"#define WEIR_LINTED_{number}\n{file.read()}\n"
            lines.append(text.count("\n"))
    folder = os.path.join(ROOT, os.path.dirname(names[0]))
    shown = os.path.join(folder, "lint_together.cpp")
    stored = os.path.join(place, "text.cpp")
    words = [shown if os.path.realpath(os.path.join(build, w)) == os.path.join(ROOT, names[0]) else w for w in words]
    overlay = {"version": 0, "use-external-names": False, "roots": [{"name": folder, "type": "directory", "contents": [
        {"name": os.path.basename(shown), "type": "file", "external-contents": stored}]}]}
    for file, content in ((stored, text), (os.path.join(place, "overlay.yaml"), json.dumps(overlay)),
                          (os.path.join(place, "compile_commands.json"),
                           json.dumps([{"directory": build, "file": shown, "arguments": words}]))):
        with open(file, "w", encoding="utf-8") as out:
            out.write(content)
    return ["-p", place, "--vfsoverlay", os.path.join(place, "overlay.yaml"), shown], lines


def named(said, names, lines):
    """Which of the files of one text are spoken of."""
    places = [int(line) for line in re.findall(r"lint_together\.cpp:(\d+):\d+: (?:error|warning)", said)]
    return {names[bisect.bisect_left(lines, place)] for place in places if place <= lines[-1]}


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

    def look(names):
        """Yields each file with what clang-tidy says of it, None: nothing."""
        alone = len(names) == 1
        with tempfile.TemporaryDirectory() as place:
            arguments, lines = (["-p", CACHE, os.path.join(ROOT, names[0])], []) if alone else together(names, database[names[0]][0], build, place)
            run = subprocess.run([program, "--quiet", *arguments], capture_output=True, text=True)
        if run.returncode == 0 or alone:
            for name in names:
                yield name, None if run.returncode == 0 else run.stdout.strip() or run.stderr
            return
        apart = named(run.stdout, names, lines) or set(names)
        for name in sorted(apart):
            yield from look([name])
        if len(apart) < len(names):
            yield from look([name for name in names if name not in apart])

    def timed(names):
        start = time.monotonic()
        return list(look(names)), time.monotonic() - start

    bad, done = [], 0
    work = sorted(batches(pending, database), key=len, reverse=True)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for said, seconds in pool.map(timed, work):
            done += len(said)
            print(f"[{done}/{len(pending)}] {seconds:5.1f} s {said[0][0]}" + (f" and {len(said) - 1} more" if said[1:] else ""), flush=True)
            for name, findings in said:
                if findings is None:
                    open(stamps[name], "w", encoding="utf-8").close()
                else:
                    bad.append(name)
                    print(findings, flush=True)

    # What no file of today stands for any more, and is a month old, goes.
    current = set(stamps.values())
    for entry in os.scandir(CACHE):
        if len(entry.name) == 64 and entry.path not in current and time.time() - entry.stat().st_mtime > 30 * 86400:
            os.remove(entry.path)
    if bad:
        sys.exit(f"clang-tidy: findings in {len(bad)} files: " + ", ".join(bad))


if __name__ == "__main__":
    main()
