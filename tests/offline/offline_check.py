#!/usr/bin/env python3
"""Checks the parts of tools/offline that need no Blender: offline_check.py WEIR. The OpenEXR reader and the tile figures against Weir's
own, what glb.py makes of our scenes and what it refuses, and verdicts on pictures whose difference is known."""
import array
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [os.path.join(ROOT, "tools", "offline"), os.path.join(ROOT, "scenes")]
import exr  # noqa: E402
import figures  # noqa: E402
import glb  # noqa: E402
from gltf_writer import Gltf, Random, Shape  # noqa: E402

failures = []


def check(what, good):
    if not good: failures.append(what)


def near(a, b, tolerance): return abs(a - b) <= tolerance


def reading(weir, folder):
    """The same two pictures by two readers and two ways to sum tiles."""
    paths = [os.path.join(folder, "%d.exr" % seed) for seed in (1, 2)]
    for seed, path in enumerate(paths, 1):
        subprocess.run([weir, "render", os.path.join(ROOT, "graphs", "all_lights.json"), "--scene", os.path.join(ROOT, "scenes", "cornell-lambert.glb"),
                        "--size", "48x32", "--device", os.environ.get("WEIR_TEST_DEVICE", "cpu"), "--seed", str(seed), "--out", "radiance=" + path], check=True, stdout=subprocess.DEVNULL)
    told = json.loads(subprocess.run([weir, "compare", *paths, "--tiles", "16", "--json"], check=True, stdout=subprocess.PIPE).stdout)
    a, b = (figures.tiles(exr.read(path)) for path in paths)
    check("tiles", len(a) == len(told["tiles"]["list"]) == 6)
    for i, tile in enumerate(told["tiles"]["list"]):
        scale = 1e-6 * max(tile["luminance_reference"], 1e-3)
        check("reference of tile %d" % i, near(b[i][3], tile["luminance_reference"], scale))
        for c in range(3): check("difference of tile %d" % i, near(a[i][c] - b[i][c], tile["difference"][c], scale))
    relative = figures.relative(a, b, 3, 0.01 * figures.total(b, 3))
    check("worst tile", near(max(map(abs, relative)), told["tiles"]["max_relative"], 1e-6))


def picture(random, size, level, noise):
    """Uniform noise about `level`, which may depend on x and y."""
    values = [level(i % size, i // size) * (1 + noise * (2 * random.number() - 1)) for i in range(size * size)]
    return exr.Picture(size, size, [array.array("d", values) for _ in range(3)])


def verdicts():
    """Noise of 1 % / sqrt(3) a pixel: 0.036 % in a tile of a part, 0.018 % in the mean of four; bounds are 9 and more of these away."""
    random, flat = Random(11), lambda x, y: 1.0
    def both(level, noise=0.01): return figures.compare([picture(random, 64, level, noise) for _ in range(4)], [picture(random, 64, flat, noise) for _ in range(4)])
    same = both(flat)
    check("same is met", same["met"] and same["verdict"] == "met")
    check("noise alone", 0.0001 < same["tiles"]["noise_alone"]["p95"] < 0.001)
    brighter = both(lambda x, y: 1.005)
    check("0.5 % brighter", not brighter["met"] and brighter["verdict"] == "not met")
    check("by 0.5 %", near(brighter["mean"]["luminance"]["relative_difference"], 0.005, 0.0003))
    # Two tiles of sixteen that are off in opposite ways: in the mean nothing is.
    corner = both(lambda x, y: 1.02 if x < 16 and y < 16 else 0.98 if x >= 48 and y >= 48 else 1.0)
    check("two tiles off", not corner["met"] and near(corner["tiles"]["luminance"]["share_within_1_percent"], 14 / 16, 1e-9))
    worst = {(t["x"], t["y"]) for t in corner["tiles"]["worst"][:2]}
    check("which ones", worst == {(0, 0), (48, 48)})
    check("noisy", both(flat, 0.9)["verdict"].startswith("undecided"))


def refused(change):
    """Whether a scene with this change is refused."""
    g = Gltf()
    material = g.material("m", lambert=True)
    g.camera((0, 0, 4), (0, 0, 0), 40.0, 1.0)
    change(g, material)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.glb")
        g.write(path)
        try: glb.Glb(path)
        except glb.Unsupported as error: return str(error)
    return ""


def scenes():
    def at(name): return os.path.join(ROOT, "scenes", name + ".glb")
    interior, box = glb.Glb(at("interior")), glb.Glb(at("cornell-lambert"))
    check("triangles of the interior", sum(len(m[2]) for m in interior.meshes) == 3842)
    check("triangles of the box", sum(len(m[2]) for m in box.meshes) == 32)
    check("lights", sorted(light[0] for light in interior.lights) == ["directional", "point"])
    check("lamp", near(max(max(m[2]) for m in box.materials), 17.0, 1e-6))
    try:
        glb.Glb(at("cornell"))
        check("a dielectric is refused", False)
    except glb.Unsupported as error: check("why", "not purely Lambertian" in str(error))
    check("plain", refused(lambda g, m: g.mesh("a", Shape().quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), m)) == "")
    check("spot", "spot lights" in refused(lambda g, m: g.light("s", "spot", (1, 1, 1), 1.0)))
    check("smooth", "smoothly" in refused(lambda g, m: g.mesh("s", Shape().sphere(4, 6), m)))
    check("metal", "Lambertian" in refused(lambda g, m: g.material("metal", metallic=1.0, lambert=True)))
    check("alpha", "alphaMode" in refused(lambda g, m: g.material("cut", lambert=True, alphaMode="MASK")))
    mirrored = Gltf()
    mirrored.mesh("a", Shape().quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), mirrored.material("m", lambert=True), scale=[-1, 1, 1])
    mirrored.camera((0, 0, 4), (0, 0, 0), 40.0, 1.0)
    with tempfile.TemporaryDirectory() as folder:
        mirrored.write(os.path.join(folder, "m.glb"))
        _, p, triangles, _ = glb.Glb(os.path.join(folder, "m.glb")).meshes[0]
    a, b, c = (p[i] for i in triangles[0])
    check("a mirrored triangle keeps its front", (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0)


with tempfile.TemporaryDirectory() as temporary: reading(sys.argv[1], temporary)
verdicts()
scenes()
for failure in failures: print("FAILED: " + failure)
sys.exit(bool(failures))
