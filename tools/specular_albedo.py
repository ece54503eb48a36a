#!/usr/bin/env python3
"""Writes framework/scene/specular_albedo_table.inc: E(n·v, α), how much of the light that meets a GGX surface without
absorption leaves it after a single reflection (bsdf.glsl's lobe with F = 1). framework/scene/specular_albedo.h says how
the table is read.

E is the mean of G2 / G1 over the visible normals, which are drawn by spherical caps (Dupuy and Benyoub 2023): a midpoint
rule over the angle around the view and a Gauss-Legendre rule over the cap's height. Takes about a minute.
"""
import math
import pathlib

COLUMNS, ROWS = 64, 32
ANGLES, HEIGHTS = 48, 192


def gauss_legendre(n):
    nodes = []
    for i in range(n):
        z = math.cos(math.pi * (i + 0.75) / (n + 0.5))
        while True:
            p, before = 1.0, 0.0
            for j in range(n):
                p, before = ((2 * j + 1) * z * p - j * before) / (j + 1), p
            slope = n * (z * p - before) / (z * z - 1)
            z -= p / slope
            if abs(p / slope) < 1e-15:
                break
        nodes.append(((1 + z) / 2, 1 / ((1 - z * z) * slope * slope)))
    return nodes


RULE = gauss_legendre(HEIGHTS)
COSINES = [math.cos(math.pi * (k + 0.5) / ANGLES) for k in range(ANGLES)]


def albedo(mu, alpha):
    a2 = alpha * alpha
    sine = math.sqrt(max(0.0, 1 - mu * mu))
    length = math.hypot(alpha * sine, mu)
    vx, vz = alpha * sine / length, mu / length
    gv = math.sqrt(mu * mu * (1 - a2) + a2)
    total = 0.0
    for u, weight in RULE:
        below = u * (1 + vz)  # 1 - height on the sphere
        hz = (1 - u) * (1 + vz)
        square = below * (2 - below)
        root = math.sqrt(square)
        for c in COSINES:
            hx = alpha * (root * c + vx)
            lz = 2 * (hx * sine + hz * mu) * hz / (hx * hx + a2 * square * (1 - c * c) + hz * hz) - mu
            if lz > 0:  # G2 / G1
                gl = math.sqrt(lz * lz * (1 - a2) + a2)
                total += weight * lz * (mu + gv) / (mu * gl + lz * gv)
    return total / ANGLES


def entry(column, row):
    if column == 0:
        return 1.0
    alpha = max(row / (ROWS - 1), 1e-6)  # stands for the limit: E depends on n·v / α there
    u = (column / (COLUMNS - 1)) ** 2
    return albedo(min(1.0, alpha * u / (1 + alpha - u)), alpha)


def main():
    lines = []
    for row in range(ROWS):
        values = [str(round(entry(column, row) * 65535)) for column in range(COLUMNS)]
        for start in range(0, COLUMNS, 16):
            lines.append(", ".join(values[start:start + 16]) + ",")
    path = pathlib.Path(__file__).resolve().parent.parent / "framework/scene/specular_albedo_table.inc"
    path.write_text("// By tools/specular_albedo.py.\n" + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
