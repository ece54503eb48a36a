#!/usr/bin/env python3
"""The window, as a user meets it: opens it on a display of its own (Xvfb), plays session.script in it, and renders the graph
that was saved there without a window: the pictures must be the same, value for value.

    session_check.py --weir build/release/bin/weir --source . [--keep FOLDER]
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SIZE = "64x36"


def fail(text):
    print(text, file=sys.stderr)
    sys.exit(1)


def run(command, seconds=480, **more):
    done = subprocess.run(command, capture_output=True, text=True, timeout=seconds, **more)
    if done.returncode != 0:
        fail(f"{' '.join(map(str, command))}\nended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return done


def copy_plugin(binaries, folder, name, copy):
    """A copy of a plugin under a name of its own, with its shaders: for edits that nobody else sees."""
    folder.mkdir()
    manifest = json.loads((binaries / f"weir_{name}.json").read_text())
    library = (binaries / manifest["library"]).read_bytes()
    word = b"\0" + name.encode() + b"\0"  # what it calls itself; a name as long takes its place
    if word not in library or len(copy) != len(name):
        fail(f"{manifest['library']} can't be renamed to {copy}")
    (folder / f"libweir_{copy}.so").write_bytes(library.replace(word, b"\0" + copy.encode() + b"\0"))
    shutil.copytree(binaries / manifest["shaders"], folder / "shaders" / copy)
    manifest.update(name=copy, library=f"libweir_{copy}.so", shaders=f"shaders/{copy}")
    (folder / f"weir_{copy}.json").write_text(json.dumps(manifest))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--weir", type=pathlib.Path, required=True)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--keep", type=pathlib.Path, help="where the pictures are left")
    parser.add_argument("--scenes", type=pathlib.Path, help="folder with sponza/sponza.glb")
    arguments = parser.parse_args()
    if shutil.which("xvfb-run") is None:
        print("SKIPPED: there is no xvfb-run, so no display to open a window on")
        sys.exit(77)
    binaries = arguments.weir.resolve().parent
    scenes = arguments.scenes or pathlib.Path(os.environ.get("WEIR_SCENES", arguments.source / ".." / "shared" / "scenes"))
    scene = scenes / "sponza" / "sponza.glb"
    if not scene.exists():
        print(f"NOTE: {scene} is not there: a scene of our own takes its place")
        scene = arguments.source / "scenes" / "materials.glb"

    with tempfile.TemporaryDirectory() as temporary:
        out = pathlib.Path(temporary)
        copy_plugin(binaries, out / "plugins", "restir_di", "restir_me")
        shader = out / "plugins" / "shaders" / "restir_me" / "shade.glsl"
        (out / "bad.glb").write_bytes(b"glTF\2\0\0\0" + bytes(range(200)))
        (out / "bad.json").write_text('{ "version": 1, "passes": {')
        script = (arguments.source / "tests" / "view" / "session.script").read_text()
        for word, value in (("@OUT@", out), ("@SCENE@", scene.resolve()), ("@SHADER@", shader)):
            script = script.replace(word, str(value))
        (out / "session.script").write_text(script)
        graph = out / "graph.json"
        graph.write_text((arguments.source / "graphs" / "restir_di.json").read_text())

        environment = dict(os.environ, XDG_STATE_HOME=str(out / "state"))
        run(["xvfb-run", "-a", "-s", "-screen 0 1600x1000x24", arguments.weir, "view", graph, "--scene",
             arguments.source / "scenes" / "cornell.glb", "--size", SIZE, "--window", "1280x720", "--device", "cpu", "--validate",
             "--plugin-path", out / "plugins", "--script", out / "session.script"], env=environment)

        saved = json.loads((out / "saved.json").read_text())
        types = [saved["passes"][name]["type"] for name in ("gbuffer", "shade")]
        if types != ["gbuffer.Raster", "restir_me.Shade"] or saved["passes"]["spatial"]["params"]["radius"] != 12:
            fail(f"what was saved lacks the edits:\n{json.dumps(saved, indent=1)}")
        original = json.loads((arguments.source / "graphs" / "restir_di.json").read_text())
        if list(saved["passes"]) != list(original["passes"]) or saved["outputs"] != original["outputs"]:
            fail("saving changed what was not edited")
        run([arguments.weir, "render", out / "saved.json", "--scene", scene, "--lights", "500", "--replace-lights", "--size", SIZE, "--frames", "8",
             "--device", "cpu", "--plugin-path", out / "plugins", "--out", f"radiance={out / 'headless.exr'}"])
        compared = json.loads(run([arguments.weir, "compare", out / "window.exr", out / "headless.exr", "--json"]).stdout)
        if compared["mse"] != 0.0:
            fail(f"the window's picture is not the one without a window: {compared}")
        for picture in ("port", "broken", "whole"):
            if (out / f"{picture}.png").stat().st_size < 10000:
                fail(f"{picture}.png is hardly a picture of the window")
        ui = json.loads((out / "ui.json").read_text())
        print(f"the same picture; the window's own work {ui['ui_cpu_ms']['median']:.3f} ms (p95 {ui['ui_cpu_ms']['p95']:.3f}) "
              f"over {ui['frames']} frames")
        if arguments.keep:
            arguments.keep.mkdir(parents=True, exist_ok=True)
            for file in ("port.png", "broken.png", "whole.png", "saved.json", "ui.json"):
                shutil.copy(out / file, arguments.keep / file)


if __name__ == "__main__":
    main()
