#!/usr/bin/env python3
"""Checks by closed forms that Cycles is asked for what glTF says, and that both renderers mean the same by bounces.

    tools/offline/units.py [--blender PROGRAM] [--weir PROGRAM [--device NAME]] [--whole-lamps]

A Lambertian floor of albedo rho is seen from above in one point: under a point light of I candela (rho I cos / pi d^2), a sun of E lux
(rho E cos / pi), and lamps of L nit above it and at a grazing angle (Lambert's polygon formula). In a closed box whose walls emit L and reflect
rho every point shows L (1 + rho + ... + rho^(n+1)) after n bounces of indirect light. With --weir the same scenes go through
graphs/reference.json too. Exit status 1 when a colour is off by more than 0.1 %. --whole-lamps: what cycles.py cuts lamps up for.
"""
import argparse
import math
import os
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
sys.path[:0] = [HERE, os.path.join(ROOT, "scenes")]
import compare  # noqa: E402
import exr  # noqa: E402
from gltf_writer import Gltf, Shape, cross, unit  # noqa: E402

ALBEDO, COLOR = (0.7, 0.4, 0.2), (1.0, 0.5, 0.25)
BOUND = 0.001


def on_floor(add):
    """The scene and the radiance that it shows; `add` puts a light in and gives the irradiance for a colour of 1."""
    g = Gltf()
    g.mesh("floor", Shape().quad((-9, 0, 9), (9, 0, 9), (9, 0, -9), (-9, 0, -9)), g.material("floor", ALBEDO, lambert=True))
    # Not straight down, so that the picture has an up; 0.01 degrees: a point.
    g.camera((0.3, 4, 0.3), (0, 0, 0), 0.01, 1.0)
    irradiance = add(g)
    return g, [a * irradiance * c / math.pi for a, c in zip(ALBEDO, COLOR)]


def point(g):
    g.point_light("point", (1, 2, 0), COLOR, 7.0)
    return 7.0 * (2 / math.sqrt(5)) / 5


def sun(g):
    g.sun("sun", (-1, -2, 0), COLOR, 3.0)
    return 3.0 * 2 / math.sqrt(5)


def emissive(g, corners):
    g.mesh("lamp", Shape().quad(*corners), g.material("lamp", (0, 0, 0), emission=[20.0 * c for c in COLOR], lambert=True))
    total = 0.0
    for a, b in zip(corners, corners[1:] + corners[:1]):
        u, v = unit(a), unit(b)
        total += math.acos(sum(x * y for x, y in zip(u, v))) * unit(cross(u, v))[1]
    return 20.0 * abs(total) / 2


def lamp(g): return emissive(g, [(0.2, 1.5, -0.4), (1.0, 1.5, -0.4), (1.0, 1.5, 0.4), (0.2, 1.5, 0.4)])


def grazing(g):
    """Upright, 5 cm behind the floor's point, to its side: where Cycles' sampling by solid angle is far off."""
    return emissive(g, [(-0.05, 0.3, 0.9), (-0.05, 0.3, 0.4), (-0.05, 0.7, 0.4), (-0.05, 0.7, 0.9)])


def box(bounces):
    g, inside = Gltf(), Shape().box((-1, -1, -1), (1, 1, 1))
    inside.indices = [i for k in range(0, len(inside.indices), 3) for i in reversed(inside.indices[k:k + 3])]
    inside.normals = [tuple(-x for x in n) for n in inside.normals]
    g.mesh("box", inside, g.material("wall", ALBEDO, emission=[2.0 * c for c in COLOR], lambert=True))
    g.camera((0.1, 0.2, 0.4), (-0.1, 0, -0.5), 40.0, 1.0)
    return g, [2.0 * c * sum(a ** k for k in range(bounces + 2)) for a, c in zip(ALBEDO, COLOR)]


def cases():
    for add in (point, sun, lamp, grazing): yield (add.__name__, 0, *on_floor(add))
    for bounces in (0, 1, 3, 64): yield ("box, %d" % bounces, bounces, *box(bounces))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--weir")
    parser.add_argument("--device", help="Weir's")
    parser.add_argument("--whole-lamps", action="store_true")
    options = parser.parse_args()
    # What compare.weir() asks for.
    options.graph, options.size, options.frames = os.path.join(ROOT, "graphs", "reference.json"), 8, 128
    return options


def off(path, expected):
    p = exr.read(path)
    return [sum(plane) / len(plane) / e - 1 for plane, e in zip(p.rgb, expected)]


def main():
    options, bad = arguments(), False
    print("%-10s %-32s %s" % ("", "expected", "off by, % (R, G, B)"))
    with tempfile.TemporaryDirectory() as folder:
        for name, bounces, g, expected in cases():
            options.scene, picture = os.path.join(folder, "scene.glb"), os.path.join(folder, "picture.exr")
            g.write(options.scene)
            def cycles():
                more = ["--whole-lamps"] if options.whole_lamps else []
                compare.cycles(options.blender, options.scene, picture, *more, samples=4096, bounces=bounces, size="8x8", seed=1)
            def weir():
                options.set = ["path.maxBounces=%d" % bounces, "path.samples=256"]
                compare.weir(options, picture, 1)
            for program, render in (("Cycles", cycles),) + ((("Weir", weir),) if options.weir else ()):
                render()
                errors = off(picture, expected)
                print("%-10s %-32s %-7s %s" % (name, "  ".join("%.6f" % e for e in expected), program,
                                               "  ".join("%+.4f" % (100 * e) for e in errors)), flush=True)
                bad |= not all(abs(e) <= BOUND for e in errors)
                os.remove(picture)
    return bad


if __name__ == "__main__":
    sys.exit(main())
