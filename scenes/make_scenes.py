#!/usr/bin/env python3
"""Writes Weir's own small scenes beside this file, the same bytes every time. Standard library only.

    scenes/make_scenes.py [FOLDER]

cornell.glb               a box with red and green walls, two blocks and a quad lamp in the ceiling
cornell-lambert.glb       the same box of Lambertian surfaces, for comparison with other renderers (docs/offline.md)
cornell-1000-points.glb   the first box, lit by 1000 coloured point lights instead
materials.glb             spheres, metallic (rows) by roughness (columns), under a quad and a point light
cornell-moving.glb        the box with a turning block, a skinned column, a morphing ball and a lamp that moves and grows; a clip
                          for each of them, and one for all
sky.hdr                   an environment: a clear sky with a low sun over dark ground, 64 x 32 texels
interior.glb              a furnished room of Lambertian surfaces: sun through blinds, two area lamps, a point light (docs/offline.md)
alpha-mask.glb            leaf and grid cut-outs (a generated PNG) that throw shadows on a floor
Metres, +Y up. Every file passes the Khronos validator (tools/gltf-validator).
"""
import math
import os
import struct
import sys
import zlib

import interior
from gltf_writer import USHORT, Gltf, Random, Shape, sub, unit

WHITE, RED, GREEN = (0.73, 0.73, 0.73), (0.63, 0.065, 0.05), (0.14, 0.45, 0.091)

# The room spans x -1..1, y 0..2, z -1..1 and is open towards +Z.
BLOCKS = (((-0.35, 0.0, -0.3), (0.6, 1.2, 0.6), 18.0), ((0.37, 0.0, 0.35), (0.6, 0.6, 0.6), -17.0))


def cornell_room(g, blocks=True, lambert=False):
    white = g.material("white", lambert=lambert)
    room = Shape()
    room.quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1))  # floor
    room.quad((-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1))  # ceiling
    room.quad((-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1))  # back
    g.mesh("room", room, white)
    g.mesh("left wall", Shape().quad((-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)), g.material("red", RED, lambert=lambert))
    g.mesh("right wall", Shape().quad((1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1)), g.material("green", GREEN, lambert=lambert))
    if blocks:
        g.mesh("tall block", Shape().block(*BLOCKS[0]), white)
        g.mesh("short block", Shape().block(*BLOCKS[1]), white)
    g.camera((0, 1, 3.9), (0, 1, 0), 39.0, 1.0)


def cornell(path, lambert=False):
    g = Gltf()
    cornell_room(g, lambert=lambert)
    lamp = Shape().quad((-0.25, 1.98, -0.2), (0.25, 1.98, -0.2), (0.25, 1.98, 0.2), (-0.25, 1.98, 0.2))
    g.mesh("lamp", lamp, g.material("lamp", (0.78, 0.78, 0.78), emission=(17.0, 12.0, 4.0), lambert=lambert))
    g.write(path)


def cornell_lambert(path): cornell(path, lambert=True)


def in_block(p, margin):
    for centre, size, degrees in BLOCKS:
        s, c = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
        x, z = p[0] - centre[0], p[2] - centre[2]
        local = (c * x - s * z, s * x + c * z)
        if abs(local[0]) < size[0] / 2 + margin and abs(local[1]) < size[2] / 2 + margin and p[1] < size[1] + margin:
            return True
    return False


def cornell_points(path):
    g, random = Gltf(), Random(1000)
    cornell_room(g)
    placed = 0
    while placed < 1000:
        p = (random.number() * 1.9 - 0.95, random.number() * 1.9 + 0.05, random.number() * 1.9 - 0.95)
        if in_block(p, 0.03): continue
        color = [0.1 + 0.9 * random.number() for _ in range(3)]
        # Three decades of intensity, about 5 candela in all.
        g.point_light("", p, color, 0.0005 * 10 ** (2.0 * random.number() ** 2))
        placed += 1
    for node in g.json["nodes"]:
        if node.get("name") == "": del node["name"]
    g.write(path)


def turn(axis, degrees):
    """Quaternion x y z w."""
    s = math.sin(math.radians(degrees) / 2)
    return (axis[0] * s, axis[1] * s, axis[2] * s, math.cos(math.radians(degrees) / 2))


def column(g, material, base, height, half, rings):
    """A square column on two joints, the upper one half way up. The node of the upper joint."""
    shape, joints, weights = Shape(), [], []
    corners = ((-half, half), (half, half), (half, -half), (-half, -half))
    for (x0, z0), (x1, z1) in zip(corners, corners[1:] + corners[:1]):
        for r in range(rings): shape.quad((x0, height * r / rings, z0), (x1, height * r / rings, z1),
                                          (x1, height * (r + 1) / rings, z1), (x0, height * (r + 1) / rings, z0))
    shape.quad(*((x, height, z) for x, z in corners))
    for p in shape.positions:
        upper = min(1.0, max(0.0, (p[1] / height - 0.3) / 0.4))
        joints.append((0, 1 if upper > 0 else 0, 0, 0))
        weights.append((1.0 - upper, upper, 0.0, 0.0))
    primitive = {**g.geometry(shape), "material": material}
    data = b"".join(struct.pack("<4H", *j) for j in joints)
    primitive["attributes"]["JOINTS_0"] = g.add("accessors", {"bufferView": g.view(data, 34962), "componentType": USHORT,
                                                              "count": len(joints), "type": "VEC4"})
    primitive["attributes"]["WEIGHTS_0"] = g.floats(weights)
    upper = g.add("nodes", {"name": "upper joint", "translation": [0, height / 2, 0]})
    lower = g.node(name="lower joint", translation=list(base), children=[upper])
    inverse = g.floats([(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -y, 0, 1) for y in (0, height / 2)], False, None)
    skin = g.add("skins", {"name": "column", "joints": [lower, upper], "skeleton": lower, "inverseBindMatrices": inverse})
    g.node(name="column", mesh=g.add("meshes", {"name": "column", "primitives": [primitive]}), skin=skin)
    return upper


def cornell_moving(path):
    g = Gltf()
    cornell_room(g, blocks=False)
    white = g.material("block", (0.7, 0.7, 0.75))
    block = g.mesh("block", Shape().block((0, 0, 0), (0.5, 0.8, 0.5), 0), white, translation=[-0.45, 0, -0.35])
    upper = column(g, g.material("column", (0.35, 0.5, 0.7)), (0.45, 0, -0.35), 1.2, 0.12, 10)

    ball = Shape().sphere(10, 20)
    primitive = {**g.geometry(ball), "material": g.material("ball", (0.7, 0.55, 0.25), roughness=0.5)}
    # Squashed to half its height; a normal of the ellipsoid (x, y/2, z) is (n.x, 2 n.y, n.z).
    normals = [unit((n[0], 2 * n[1], n[2])) for n in ball.normals]
    primitive["targets"] = [{"POSITION": g.floats([(0, -p[1] / 2, 0) for p in ball.positions], True),
                             "NORMAL": g.floats([sub(m, n) for m, n in zip(normals, ball.normals)])}]
    ball = g.node(name="ball", mesh=g.add("meshes", {"name": "ball", "primitives": [primitive], "weights": [0.0]}),
                  translation=[0.1, 0.25, 0.45], scale=[0.25] * 3)
    lamp = g.mesh("lamp", Shape().quad((-0.25, 0, -0.2), (0.25, 0, -0.2), (0.25, 0, 0.2), (-0.25, 0, 0.2)),
                  g.material("lamp", (0.78, 0.78, 0.78), emission=(17.0, 12.0, 4.0)), translation=[0, 1.9, 0])
    tracks = {
        "block": [(block, "rotation", "LINEAR", (0, 0.5, 1, 1.5, 2), [turn((0, 1, 0), d) for d in (0, 90, 180, 270, 360)]),
                  (block, "translation", "CUBICSPLINE", (0, 1, 2),
                   [(0, 0, 0), (-0.45, 0, -0.35), (0, 0, 0), (0, 0, 0), (-0.25, 0.3, -0.35), (0, 0, 0),
                    (0, 0, 0), (-0.45, 0, -0.35), (0, 0, 0)])],
        "column": [(upper, "rotation", "LINEAR", (0, 0.5, 1.5, 2), [turn((0, 0, 1), d) for d in (0, 45, -45, 0)])],
        "ball": [(ball, "weights", "LINEAR", (0, 1, 2), [0.0, 1.0, 0.0])],
        "lamp": [(lamp, "translation", "LINEAR", (0, 0.5, 1.5, 2), [(0, 1.9, 0), (0.4, 1.8, 0.2), (-0.4, 1.9, -0.2), (0, 1.9, 0)]),
                 (lamp, "scale", "LINEAR", (0, 1, 2), [(1, 1, 1), (1.6, 1, 1.2), (1, 1, 1)])],
    }
    g.clip("everything", [track for name in tracks for track in tracks[name]])
    for name in tracks: g.clip(name, tracks[name])
    g.write(path)


def materials(path):
    g = Gltf()
    floor = g.material("floor", (0.5, 0.5, 0.5), roughness=0.6)
    g.mesh("floor", Shape().quad((-4, 0, 3), (4, 0, 3), (4, 0, -3), (-4, 0, -3)), floor)
    sphere = g.geometry(Shape().sphere(24, 48))
    rows, columns = 4, 7
    for r in range(rows):
        for c in range(columns):
            metallic, roughness = r / (rows - 1), max(0.03, c / (columns - 1))
            material = g.material("metallic %.2f roughness %.2f" % (metallic, roughness), (0.9, 0.6, 0.3),
                                  round(metallic, 4), round(roughness, 4))
            mesh = g.add("meshes", {"primitives": [{**sphere, "material": material}]})
            g.node(mesh=mesh, scale=[0.4] * 3, translation=[round((c - (columns - 1) / 2) * 1.0, 4), 0.4, round((r - (rows - 1) / 2) * 1.1, 4)])
    lamp = Shape().quad((-1.5, 4, -1), (1.5, 4, -1), (1.5, 4, 1), (-1.5, 4, 1))
    g.mesh("lamp", lamp, g.material("lamp", (0, 0, 0), emission=(8.0, 8.0, 8.0)))
    g.point_light("point", (-3.0, 2.5, 2.5), (1.0, 0.85, 0.6), 12.0)
    g.camera((0, 4.2, 6.2), (0, 0.2, 0), 42.0)
    g.write(path)


def png(width, height, texel):
    """An RGBA PNG; texel(x, y) gives four bytes."""
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(width)) for y in range(height))
    def chunk(kind, data): return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def leaf(x, y, size=128):
    """A pointed leaf with a stem; the edge is soft, so that the cut-off matters."""
    u, v = (x + 0.5) / size * 2 - 1, 1 - (y + 0.5) / size * 2
    half = 0.75 * max(0.0, 1 - v * v) ** 0.8 * (1 - 0.35 * v)
    inside = (half - abs(u)) * size / 6
    if v < -0.6: inside = max(inside, (0.05 - abs(u)) * size / 6)
    alpha = min(max(inside + 0.5, 0.0), 1.0)
    vein = 1.25 if abs(u) < 0.03 or abs((v * 5 + abs(u) * 4) % 1 - 0.5) < 0.06 else 1.0
    return [min(255, int(c * vein)) for c in (70, 120 + 30 * v, 40)] + [int(alpha * 255 + 0.5)]


def grid(x, y, size=64):
    return (150, 150, 160, 255 if x % 16 < 4 or y % 16 < 4 else 0)


def alpha_mask(path):
    g = Gltf()
    g.mesh("floor", Shape().quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)), g.material("floor", (0.6, 0.58, 0.55)))
    sampler = g.add("samplers", {"magFilter": 9729, "minFilter": 9987})
    cutouts = []
    for name, size, texel, cutoff in (("leaf", 128, leaf, 0.5), ("grid", 64, grid, 0.25)):
        image = g.add("images", {"name": name, "mimeType": "image/png", "bufferView": g.view(png(size, size, texel))})
        texture = g.add("textures", {"sampler": sampler, "source": image})
        material = g.material(name, (1, 1, 1), 0.0, 0.8, alphaMode="MASK", alphaCutoff=cutoff, doubleSided=True)
        g.json["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": texture}
        cutouts.append(material)
    quad = g.geometry(Shape().quad((-0.5, 0, 0), (0.5, 0, 0), (0.5, 1, 0), (-0.5, 1, 0), uv=True))
    leaf_mesh = g.add("meshes", {"name": "leaf", "primitives": [{**quad, "material": cutouts[0]}]})
    grid_mesh = g.add("meshes", {"name": "grid", "primitives": [{**quad, "material": cutouts[1]}]})
    random = Random(7)
    for i in range(12):
        yaw, tilt = 2 * math.pi * random.number(), 0.6 * random.number() - 0.3
        qy, qx = (math.sin(yaw / 2), math.cos(yaw / 2)), (math.sin(tilt / 2), math.cos(tilt / 2))
        rotation = [qy[1] * qx[0], qy[0] * qx[1], -qy[0] * qx[0], qy[1] * qx[1]]
        size = 0.6 + 0.6 * random.number()
        angle = 2 * math.pi * i / 12
        radius = 0.6 + 1.0 * random.number()
        g.node(mesh=leaf_mesh, rotation=rotation, scale=[size] * 3,
               translation=[radius * math.sin(angle), 0.02 + 0.6 * random.number(), radius * math.cos(angle)])
    # Negative scale on purpose: a mirrored cut-out has to keep its front and its shadow.
    g.node(mesh=grid_mesh, scale=[2.4, 1.6, 1.0], translation=[0, 0.01, -1.9])
    g.node(mesh=grid_mesh, scale=[-1.2, 1.2, 1.0], rotation=[0, math.sin(math.pi / 4), 0, math.cos(math.pi / 4)],
           translation=[-2.2, 0.01, 0.3])
    lamp = Shape().quad((-0.6, 3.2, -0.6), (0.6, 3.2, -0.6), (0.6, 3.2, 0.6), (-0.6, 3.2, 0.6))
    g.mesh("lamp", lamp, g.material("lamp", (0, 0, 0), emission=(9.0, 9.0, 8.0)))
    g.point_light("point", (1.8, 2.2, 1.5), (1.0, 0.8, 0.55), 9.0)
    g.camera((0.4, 2.3, 4.6), (0, 0.55, -0.1), 45.0)
    g.write(path)


def rgbe(color):
    """Three bytes of mantissa and one of exponent, rounded."""
    largest = max(color)
    if largest < 1e-30: return (0, 0, 0, 0)
    exponent = math.frexp(largest)[1]
    if round(largest * 2.0 ** (8 - exponent)) > 255: exponent += 1
    return tuple(round(c * 2.0 ** (8 - exponent)) for c in color) + (exponent + 128,)


def runs(values):
    """A channel of a scan line: runs of four and more, the rest as it is."""
    out, i = bytearray(), 0
    def run(at):
        length = 1
        while at + length < len(values) and length < 127 and values[at + length] == values[at]: length += 1
        return length
    while i < len(values):
        if run(i) >= 4:
            out += bytes((128 + run(i), values[i]))
            i += run(i)
            continue
        start = i
        while i < len(values) and i - start < 128 and run(i) < 4: i += 1
        out += bytes([i - start]) + bytes(values[start:i])
    return out


def radiance(path, width, height, texel):
    """A Radiance picture; texel(x, y) gives linear red, green and blue."""
    with open(path, "wb") as out:
        out.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width))
        for y in range(height):
            line = [rgbe(texel(x, y)) for x in range(width)]
            out.write(bytes((2, 2, width >> 8, width & 255)))
            for channel in range(4): out.write(runs([texel[channel] for texel in line]))


def sky(path, width=64, height=32):
    """Blue above, white at the horizon, brown below; the sun is one texel, 37 degrees high, to the front right."""
    sun = (54, 9)  # column, row: the middle of a picture shows -Z, so this is between +X and +Z
    def texel(x, y):
        if (x, y) == sun: return (700.0, 620.0, 500.0)
        up = math.cos(math.pi * (y + 0.5) / height)
        if up < 0: return (0.12, 0.1, 0.08)
        t = up ** 0.5
        return tuple(a + (b - a) * t for a, b in zip((0.9, 0.95, 1.0), (0.15, 0.35, 0.8)))
    radiance(path, width, height, texel)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    for name, make in (("cornell", cornell), ("cornell-lambert", cornell_lambert), ("cornell-1000-points", cornell_points), ("cornell-moving", cornell_moving),
                       ("interior", interior.write), ("materials", materials), ("alpha-mask", alpha_mask)):
        path = os.path.join(folder, name + ".glb")
        make(path)
        print("%s: %d bytes" % (path, os.path.getsize(path)))
    path = os.path.join(folder, "sky.hdr")
    sky(path)
    print("%s: %d bytes" % (path, os.path.getsize(path)))


if __name__ == "__main__":
    main()
