#!/usr/bin/env python3
"""`weir view`'s words: what is wrong with them is said before a window opens, with status 2; without a display it says so, with
status 1; a script that can't be played ends with its line.

    cli_check.py --weir build/release/bin/weir --source .
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--weir", type=pathlib.Path, required=True)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    graph = arguments.source / "graphs" / "restir_di.json"
    cornell = arguments.source / "scenes" / "cornell.glb"
    blind = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    failures = []

    def expect(status, words, command, display=False):
        command = [arguments.weir, "view", *command]
        if display:
            command = ["xvfb-run", "-a", "-s", "-screen 0 1280x800x24", *command]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=120, env=os.environ if display else blind)
        said = done.stdout + done.stderr
        if done.returncode != status or words not in said:
            failures.append(f"{command}: status {done.returncode}, wanted {status} and '{words}' in:\n{said}")

    expect(0, "--script", ["--help"])
    expect(2, "nearest is '--scene'", [graph, "--scne", cornell])
    expect(2, "graph is required", [])
    expect(2, "expected WIDTHxHEIGHT", [graph, "--scene", cornell, "--size", "big"])
    expect(2, "--window 10x10", [graph, "--scene", cornell, "--window", "10x10"])
    expect(2, "--ui-scale", [graph, "--scene", cornell, "--ui-scale", "9"])
    expect(2, "expected output=file.exr", [graph, "--scene", cornell, "--out", "color"])
    expect(1, "There can be no window", [graph, "--scene", cornell])
    if shutil.which("xvfb-run") is None:
        print("NOTE: there is no xvfb-run: what needs a display was not looked at")
    else:
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder) / "bad.script"
            script.write_text("clik menu/File\n")
            small = ["--window", "640x480", "--size", "16x16", "--device", "cpu"]
            expect(2, "bad.script:1: 'clik' is not known; nearest is 'click'", [graph, "--scene", cornell, *small, "--script", script], True)
            script.write_text("click menu/Fiel\n")
            expect(1, "bad.script:1: click menu/Fiel: no widget 'menu/Fiel'; nearest is 'menu/File'", [graph, "--scene", cornell, *small, "--script", script], True)
            script.write_text("quit\n")
            expect(2, "nowhere.json", [arguments.source / "nowhere.json", "--scene", cornell, *small, "--script", script], True)
            expect(2, "nowhere.glb", [graph, "--scene", arguments.source / "nowhere.glb", *small, "--script", script], True)
            expect(2, "spatial.params.radus", [graph, "--scene", cornell, *small, "--script", script, "--set", "spatial.radus=3"], True)
            out = pathlib.Path(folder) / "last.exr"
            script.write_text("until-frames 2\nquit\n")
            expect(0, "", [graph, "--scene", cornell, *small, "--script", script, "--frames", "2", "--out", f"radiance={out}"], True)
            if not out.exists():
                failures.append("--out wrote nothing when the window was closed")
    for failure in failures:
        print(failure, file=sys.stderr)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
