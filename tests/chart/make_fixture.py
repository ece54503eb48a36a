#!/usr/bin/env python3
"""Writes a bench file of made-up figures, with pictures, for tests of `weir chart`: make_fixture.py FILE.json [--per-scene N].
Standard library only; every name says that nothing here was measured."""
import argparse
import json
import math
import os
import struct
import zlib

HOSTILE = "</script><script>window.broken = 1</script><img src=x onerror='window.broken = 2'>&\"<!--"


class Random:
    """A small generator of its own, so that files are the same everywhere."""

    def __init__(self, seed): self.state = seed

    def number(self):
        self.state = (self.state * 6364136223846793005 + 1442695040888963407) % 2**64
        return (self.state >> 33) / 2**31


def png(path, side, pixel):
    rows = b"".join(b"\0" + bytes(max(0, min(255, int(v))) for x in range(side) for v in pixel(x, y)) for y in range(side))
    def chunk(name, data): return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def truth(x, y):
    wave = 90 + 60 * math.sin(x / 9) * math.cos(y / 13)
    return (wave + 40, wave, 160 - wave / 2)


def pictures(folder, name, side, noise, random):
    """A noisy picture and its map of errors, both from the same noise."""
    errors = [[noise * (random.number() + random.number() - 1) for _ in range(side)] for _ in range(side)]
    png(os.path.join(folder, name + ".png"), side, lambda x, y: [v + 255 * errors[y][x] for v in truth(x, y)])
    png(os.path.join(folder, name + ".flip.png"), side, lambda x, y: [255 * min(1, abs(errors[y][x]) * k) for k in (2.5, 1, 1.4)])


def interval(value, spread): return {"value": value, "low": value * (1 - spread), "high": value * (1 + spread)}


def configuration(number, scene, graph, settings, with_pictures, folder, side, random):
    """Costs that grow with the settings and errors that fall with them, each a little off."""
    count, spread, reuse = settings["pick.count"], settings["spread.steps"], settings["reuse.enabled"]
    cost = {"surfaces": 0.62, "pick": 0.02 * count ** 0.8 * (1.25 if settings["pick.check"] else 1)}
    if reuse: cost["reuse"] = 0.4
    cost["spread"] = 0.35 * spread
    cost["show"] = 0.1
    cost = {name: ms * (0.97 + 0.06 * random.number()) for name, ms in cost.items()}
    total = sum(cost.values()) + 0.05
    error = (1.6 if graph == "plain.json" else 0.8) / (count ** 0.45 * (1 + 1.1 * spread) * (4 if reuse else 1)) * (0.85 + 0.3 * random.number()) * (1 if settings["pick.check"] else 1.5)
    error *= scene["level"]
    types = {"surfaces": "gbuffer.Made", "pick": "made_up.Pick", "reuse": "made_up.Reuse", "spread": "made_up.Spread", "show": "output.Made"}
    name = "%016x" % (0xc0ffee0000 + number)
    options = "".join(" --set %s=%s" % (k, json.dumps(v)) for k, v in settings.items())
    result = {
        "id": name, "graph": graph, "name": "made-up-" + graph[:-5], "scene": {k: scene[k] for k in ("file", "digest", "lights", "camera")}, "size": [640, 360],
        "settings": settings, "parameters": {**settings, "show.exposure": 1.5, "pick.mode": "even"},
        "command": "weir bench graphs/%s --scene %s%s --out again.json" % (graph, scene["file"], options), "frames": 100, "warmup": 40,
        "passes": [{"name": k, "type": types[k], "gpu_ms": {"median": ms, "p95": ms * 1.04, "p99": ms * 1.1}, "cpu_ms": 0.01, "bytes_read": 1000000, "bytes_written": 500000, "rays": 230400} for k, ms in cost.items()],
        "frame": {"gpu_ms": {"median": total, "p95": total * 1.05, "p99": total * 1.12}, "cpu_ms": 0.08, "wall_ms": total * 1.02},
        "memory": {"transient_bytes": 41000000, "history_bytes": 29000000, "scene_bytes": 190000000, "aliased_saving_bytes": 8000000}, "rays": 691200,
        "error": {"repeats": 4, "frames": 256, "reference": {"what": "made up", "exact": True},
                  "relmse": {"median": interval(error, 0.12), "mean": interval(error * 1.4, 0.3), "trimmed": interval(error * 0.7, 0.06)},
                  "relmse_mean64": interval(error / 40, 0.2), "relmse_mean256": interval(error / 150, 0.25), "flip": interval(0.4 * error ** 0.3, 0.02),
                  "bias": {"value": -0.0004, "low": -0.001, "high": 0.0002}, "correlation_time": interval(3.1 if reuse else 1.0, 0.2)}}
    if number % 3: result["floor"] = {"gpu_ms": total / 1.4, "multiple": 1.4, "parts": [{"name": "made-up rays", "gpu_ms": total / 2}]}
    if with_pictures:
        pictures(folder, name, side, min(0.9, 1.2 * math.sqrt(error)), random)
        base = os.path.basename(folder)
        result["pictures"] = {"crop": [100, 50, side, side], "frame": "%s/%s.png" % (base, name), "flip": "%s/%s.flip.png" % (base, name), "reference": base + "/reference.png"}
    return result


def make_hostile(configurations):
    """What a page must bear: markup in every text, no error measured, an error of zero."""
    first = configurations[0]
    first["name"] = first["command"] = first["error"]["reference"]["what"] = HOSTILE
    first["parameters"]["pick.mode"] = first["settings"]["pick.mode"] = HOSTILE
    del configurations[1]["error"]
    configurations[2]["error"]["relmse"]["median"] = {"value": 0, "low": 0, "high": 0}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--per-scene", type=int, default=40)
    parser.add_argument("--side", type=int, default=48, help="of the pictures")
    parser.add_argument("--pictures", type=int, default=12, help="configurations that have any")
    parser.add_argument("--tame", action="store_true", help="nothing that a page must bear: for a look at it")
    options = parser.parse_args()
    folder = options.file.rsplit(".", 1)[0] + ".pictures"
    os.makedirs(folder, exist_ok=True)
    png(os.path.join(folder, "reference.png"), options.side, truth)
    random, configurations = Random(7), []
    scenes = [{"file": "made/up/stripes.glb", "digest": "11", "lights": "500 made up", "camera": "front", "level": 1.0},
              {"file": "made/up/checker.glb", "digest": "22", "lights": "100 made up", "camera": "front", "level": 0.2}]
    grid = [(graph, {"pick.count": count, "pick.check": check, "reuse.enabled": reuse, "spread.steps": steps})
            for steps in (1, 2, 3, 4) for count in (8, 32, 128, 512) for reuse in (True, False) for check in (True, False) for graph in ("reuse.json", "plain.json")]
    for scene in scenes:
        for i in range(options.per_scene):
            graph, settings = grid[i % len(grid)]
            settings = dict(settings, **{"spread.radius": 10 * (1 + i // len(grid))})
            configurations.append(configuration(len(configurations), scene, graph, settings, i < options.pictures, folder, options.side, random))
    if not options.tame: make_hostile(configurations)
    with open(options.file, "w", encoding="utf-8") as file:
        json.dump({"weir_bench": 1, "device": "Made-up device", "driver": "made up 1.0", "trace": "pipeline", "weir": "0.0/made-up", "configurations": configurations}, file, indent=1)


if __name__ == "__main__":
    main()
