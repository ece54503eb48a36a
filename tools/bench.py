#!/usr/bin/env python3
"""Runs the benchmarks and keeps their figures, without what only says whose machine it was. Standard library only.

    tools/bench.py build/release/bin/weir_bench graph/ docs/measurements/graph-compile.json

The second argument is a regular expression of benchmark names. Each is repeated; the JSON is Google Benchmark's own, with
the processor's name added.
"""
import argparse
import json
import os
import subprocess
import tempfile

REPETITIONS = 10


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), "unknown")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="weir_bench")
    parser.add_argument("filter", help="which benchmarks")
    parser.add_argument("out", help="JSON file to write")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        raw = os.path.join(folder, "raw.json")
        subprocess.run([options.program, f"--benchmark_filter={options.filter}", f"--benchmark_repetitions={REPETITIONS}",
                        "--benchmark_enable_random_interleaving=true", f"--benchmark_out={raw}",
                        "--benchmark_out_format=json"], check=True)
        with open(raw, encoding="utf-8") as file:
            result = json.load(file)
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
