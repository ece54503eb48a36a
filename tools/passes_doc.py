#!/usr/bin/env python3
"""Writes docs/passes.md and docs/graph.schema.json from what the passes say of themselves. Standard library only.

    tools/passes_doc.py build/release/bin/weir            writes both
    tools/passes_doc.py --check build/release/bin/weir    exit status 1 if one isn't current
"""
import argparse
import json
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PASSES = os.path.join(ROOT, "docs", "passes.md")
SCHEMA = os.path.join(ROOT, "docs", "graph.schema.json")
HEAD = """# Passes

Written by `tools/passes_doc.py` from `weir passes --json`; don't edit it. Every pass of the plugins that come with Weir:
its ports, its parameters, and what it takes from scene and frame.
"""


def cell(text):
    return text.replace("|", "\\|").replace("\n", " ")


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(cell(c) for c in row) + " |" for row in rows]) + "\n"


def number(value):
    return str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, (int, float)) else f"`{value}`" if value else "empty"


def carries(port):
    if port["kind"] == "image":
        text = f"image {port['format']}"
    else:
        text = f"{port['layout']['name']} ({port['layout']['stride']} bytes)"
        if "elements" in port:
            text += f", {port['elements']}"
        elif port["perPixel"] == "any":
            text += ", any number a pixel"
        elif isinstance(port["perPixel"], dict):
            source, name = next(iter(port["perPixel"].items()))
            text += f", `{name}` a pixel" if source == "param" else f", as many a pixel as in `{name}`"
        elif port["perPixel"] != 1:
            text += f", {port['perPixel']} a pixel"
    if port["scale"][0] != port["scale"][1]:
        text += f", at {port['scale'][0]}/{port['scale'][1]} of the frame's size"
    return text


def port_row(side, port):
    notes = [port["doc"]] if port["doc"] else []
    if port.get("required") is False:
        notes.append("may stay unconnected")
    if "passesThrough" in port:
        notes.append(f"when disabled, its input `{port['passesThrough']}`")
    return [side, f"`{port['name']}`", carries(port), "; ".join(notes)]


def param_row(param):
    allowed = "–"
    if "choices" in param:
        allowed = ", ".join(f"`{c}`" for c in param["choices"])
    elif "low" in param and "high" in param:
        allowed = f"{param['low']:.10g} … {param['high']:.10g}"
    kind = param["type"] + (", specialises" if param["specialises"] else "")
    return [f"`{param['name']}`", kind, number(param["default"]), allowed, param["unit"], param["doc"]]


def section(entry):
    text = f"\n## {entry['type']}\n{entry['doc']}.\n\n"
    rows = [port_row("in", p) for p in entry["inputs"]] + [port_row("out", p) for p in entry["outputs"]]
    text += table(["", "port", "carries", ""], rows)
    if entry["params"]:
        text += "\n" + table(["parameter", "type", "default", "allowed", "unit", ""], [param_row(p) for p in entry["params"]])
    if entry["needs"]:
        text += "\nTakes " + ", ".join(f"`{n}`" for n in entry["needs"]) + ".\n"
    return text


def run(*command):
    """What the program prints, of the plugins that come with it."""
    environment = {k: v for k, v in os.environ.items() if k != "WEIR_PLUGIN_PATH"}
    return subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weir", help="the program")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    said = json.loads(run(options.weir, "passes", "--json"))
    if said["problems"]:
        sys.exit("passes_doc.py: " + "; ".join(p["message"] for p in said["problems"]))
    files = {PASSES: HEAD + "".join(section(entry) for entry in said["passes"]), SCHEMA: run(options.weir, "graph", "schema")}
    for path, text in files.items():
        if not options.check:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        elif not os.path.exists(path) or open(path, encoding="utf-8").read() != text:
            sys.exit(f"{os.path.relpath(path, ROOT)} is not current: run tools/passes_doc.py " + os.path.relpath(options.weir, ROOT))


if __name__ == "__main__":
    main()
