#!/usr/bin/env python3
"""Runs the benchmarks and keeps their figures, without what only says whose machine it was. Standard library only.

    tools/bench.py build/release/bin/weir_bench graph/ docs/measurements/graph-compile.json
    tools/bench.py --bounds bench/bounds.json build/release/bin/weir_bench graph/

The second argument is a regular expression of benchmark names. Each is repeated; the JSON is Google Benchmark's own, with
the processor's name added. With bounds nothing is written: exit status 1 when the fastest repetition of a benchmark is
above its bound ("us": microseconds of CPU time), or above a multiple of another's ("of": that one, "times": how often).
A bound whose benchmark did not run is an error.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

REPETITIONS = 10


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), "unknown")


def run(program, pattern, *more):
    with tempfile.TemporaryDirectory() as folder:
        raw = os.path.join(folder, "raw.json")
        subprocess.run([program, f"--benchmark_filter={pattern}", "--benchmark_enable_random_interleaving=true",
                        f"--benchmark_out={raw}", "--benchmark_out_format=json", *more], check=True)
        with open(raw, encoding="utf-8") as file:
            result = json.load(file)
    errors = [f"{b['name']}: {b['error_message']}" for b in result["benchmarks"] if b.get("error_occurred")]
    if errors:
        sys.exit("\n".join(errors))
    return result


def check(result, bounds):
    fastest = {}
    for b in result["benchmarks"]:
        if b["run_type"] == "iteration":
            us = b["cpu_time"] * {"ns": 1e-3, "us": 1, "ms": 1e3, "s": 1e6}[b["time_unit"]]
            fastest[b["run_name"]] = min(us, fastest.get(b["run_name"], us))
    bad = []
    for name, bound in bounds.items():
        missing = [n for n in (name, bound.get("of", name)) if n not in fastest]
        if missing:
            sys.exit(f"bench.py: there is a bound for {name}, but {missing[0]} did not run")
        most = bound["us"] if "us" in bound else bound["times"] * fastest[bound["of"]]
        print(f"{name}: {fastest[name]:.1f} us, bound {most:.1f} us")
        if fastest[name] > most:
            bad.append(f"{name} takes {fastest[name]:.1f} us; expected at most {most:.1f} us")
    if bad:
        sys.exit("\n".join(bad))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="weir_bench")
    parser.add_argument("filter", help="which benchmarks")
    parser.add_argument("out", nargs="?", help="JSON file to write")
    parser.add_argument("--bounds", metavar="FILE.json", help="what to hold them to")
    options = parser.parse_args()
    if bool(options.out) == bool(options.bounds):
        parser.error("expected either a file to write or --bounds")
    if options.bounds:
        with open(options.bounds, encoding="utf-8") as file:
            bounds = json.load(file)
        return check(run(options.program, options.filter, "--benchmark_min_time=0.05", "--benchmark_repetitions=5"), bounds)
    result = run(options.program, options.filter, f"--benchmark_repetitions={REPETITIONS}")
    for key in ("host_name", "executable"):
        result["context"].pop(key, None)
    result["context"]["processor"] = processor()
    temporary = options.out + ".part"
    with open(temporary, "w", encoding="utf-8") as file:
        json.dump(result, file, indent=1)
        file.write("\n")
    os.replace(temporary, options.out)


if __name__ == "__main__":
    main()
