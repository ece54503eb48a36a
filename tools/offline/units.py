#!/usr/bin/env python3
"""Checks that Cycles is asked for what glTF says, by closed forms: a Lambertian floor of albedo rho under a point light of I
candela (rho I cos / pi d^2), a sun of E lux (rho E cos / pi), and lamps of L nit above and at a grazing angle (Lambert's
polygon formula), seen from above through one narrow pixel. Exit status 1 when one is off by more than 0.1 %.

    tools/offline/units.py [--blender PROGRAM]
"""
import argparse
import math
import os
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "scenes")]
import compare  # noqa: E402
import exr  # noqa: E402
from gltf_writer import Gltf, Shape, cross, unit  # noqa: E402

ALBEDO = (0.7, 0.4, 0.2)


def floor():
    g = Gltf()
    g.mesh("floor", Shape().quad((-9, 0, 9), (9, 0, 9), (9, 0, -9), (-9, 0, -9)), g.material("floor", ALBEDO, lambert=True))
    # Looks at the origin, not straight down so that the picture has an up; 0.01 degrees: a point.
    g.camera((0.3, 4, 0.3), (0, 0, 0), 0.01, 1.0)
    return g


def point(g):
    g.point_light("point", (1, 2, 0), (1.0, 0.5, 0.25), 7.0)
    return 7.0 * (2 / math.sqrt(5)) / 5, (1.0, 0.5, 0.25)


def sun(g):
    g.sun("sun", (-1, -2, 0), (1.0, 0.5, 0.25), 3.0)
    return 3.0 * 2 / math.sqrt(5), (1.0, 0.5, 0.25)


def lamp(g): return emissive(g, [(0.2, 1.5, -0.4), (1.0, 1.5, -0.4), (1.0, 1.5, 0.4), (0.2, 1.5, 0.4)])


def grazing(g):
    """Upright, 5 cm behind the floor's point, to its side: where Cycles' sampling by solid angle is far off."""
    return emissive(g, [(-0.05, 0.3, 0.9), (-0.05, 0.3, 0.4), (-0.05, 0.7, 0.4), (-0.05, 0.7, 0.9)])


def emissive(g, corners):
    emission = (20.0, 10.0, 5.0)
    g.mesh("lamp", Shape().quad(*corners), g.material("lamp", (0, 0, 0), emission=emission, lambert=True))
    total = 0.0
    for a, b in zip(corners, corners[1:] + corners[:1]):
        u, v = unit(a), unit(b)
        total += math.acos(sum(x * y for x, y in zip(u, v))) * unit(cross(u, v))[1]
    return 20.0 * abs(total) / 2, (1.0, 0.5, 0.25)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blender", default="blender")
    options, bad = parser.parse_args(), False
    with tempfile.TemporaryDirectory() as folder:
        for make in (point, sun, lamp, grazing):
            g = floor()
            irradiance, color = make(g)
            scene, picture = (os.path.join(folder, make.__name__ + end) for end in (".glb", ".exr"))
            g.write(scene)
            compare.cycles(options.blender, scene, picture, samples=4096, bounces=0, size="8x8", seed=1)
            p = exr.read(picture)
            for c in range(3):
                expected = ALBEDO[c] * irradiance * color[c] / math.pi
                off = sum(p.rgb[c]) / len(p.rgb[c]) / expected - 1
                print("%-8s %s  expected %.6f  off by %+.4f %%" % (make.__name__, "RGB"[c], expected, 100 * off))
                bad |= not abs(off) <= 0.001
    return bad


if __name__ == "__main__":
    sys.exit(main())
