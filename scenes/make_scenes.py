#!/usr/bin/env python3
"""Writes Weir's own small scenes beside this file, the same bytes every time. Standard library only.

    scenes/make_scenes.py [FOLDER]

cornell.glb               a box with red and green walls, two blocks and a quad lamp in the ceiling
cornell-1000-points.glb   the same box, lit by 1000 coloured point lights instead
materials.glb             spheres, metallic (rows) by roughness (columns), under a quad and a point light
cornell-moving.glb        the box with a turning block, a skinned column, a morphing ball and a lamp that moves and grows; a clip
                          for each of them, and one for all
sky.hdr                   an environment: a clear sky with a low sun over dark ground, 64 x 32 texels
alpha-mask.glb            leaf and grid cut-outs (a generated PNG) that throw shadows on a floor
Metres, +Y up. Every file passes the Khronos validator (tools/gltf-validator).
"""
import json
import math
import os
import struct
import sys
import zlib

FLOAT, USHORT = 5126, 5123
WHITE, RED, GREEN = (0.73, 0.73, 0.73), (0.63, 0.065, 0.05), (0.14, 0.45, 0.091)


def sub(a, b): return tuple(x - y for x, y in zip(a, b))
def cross(a, b): return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


class Random:
    """SplitMix64, so that the files do not depend on Python's version."""

    def __init__(self, seed): self.state = seed

    def number(self):
        self.state = (self.state + 0x9E3779B97F4A7C15) & (2**64 - 1)
        z = self.state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & (2**64 - 1)
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & (2**64 - 1)
        return ((z ^ (z >> 31)) >> 11) * 2.0**-53


class Shape:
    """Triangles with normals and, when `uvs` is filled, texture coordinates."""

    def __init__(self): self.positions, self.normals, self.uvs, self.indices = [], [], [], []

    def quad(self, a, b, c, d, uv=False):
        """Corners counter-clockwise as seen from the front; texture upright with `a` at the bottom left."""
        normal, base = unit(cross(sub(b, a), sub(d, a))), len(self.positions)
        self.positions += [a, b, c, d]
        self.normals += [normal] * 4
        if uv: self.uvs += [(0, 1), (1, 1), (1, 0), (0, 0)]
        self.indices += [base, base + 1, base + 2, base, base + 2, base + 3]
        return self

    def block(self, centre, size, degrees):
        """A box that stands on its base centre, turned about Y."""
        s, c = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
        hx, h, hz = size[0] / 2, size[1], size[2] / 2

        def at(x, y, z): return (centre[0] + c * x + s * z, centre[1] + y, centre[2] - s * x + c * z)
        for a, b in (((-hx, hz), (hx, hz)), ((hx, hz), (hx, -hz)), ((hx, -hz), (-hx, -hz)), ((-hx, -hz), (-hx, hz))):
            self.quad(at(a[0], 0, a[1]), at(b[0], 0, b[1]), at(b[0], h, b[1]), at(a[0], h, a[1]))
        return self.quad(at(-hx, h, hz), at(hx, h, hz), at(hx, h, -hz), at(-hx, h, -hz))

    def sphere(self, rings, segments):
        """Unit sphere, smooth; one vertex at each pole."""
        def add(y, radius, angle):
            n = (radius * math.sin(angle), y, radius * math.cos(angle))
            self.positions.append(n)
            self.normals.append(unit(n))
        add(1, 0, 0)
        for r in range(1, rings):
            theta = math.pi * r / rings
            for s in range(segments): add(math.cos(theta), math.sin(theta), 2 * math.pi * s / segments)
        add(-1, 0, 0)
        last = len(self.positions) - 1
        def at(r, s): return 0 if r == 0 else last if r == rings else 1 + (r - 1) * segments + s % segments
        for r in range(rings):
            for s in range(segments):
                a, b, c, d = at(r + 1, s), at(r + 1, s + 1), at(r, s + 1), at(r, s)
                if r + 1 < rings: self.indices += [a, b, c] if r == 0 else [a, b, c, a, c, d]
                else: self.indices += [a, c, d]
        return self


class Gltf:
    """Collects one file; every method that adds something returns its index."""

    def __init__(self):
        self.binary = bytearray()
        self.json = {"asset": {"version": "2.0", "generator": "weir scenes/make_scenes.py"}, "scene": 0,
                     "scenes": [{"nodes": []}]}

    def add(self, kind, entry):
        self.json.setdefault(kind, []).append(entry)
        return len(self.json[kind]) - 1

    def view(self, data, target=None):
        while len(self.binary) % 4: self.binary.append(0)
        entry = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if target: entry["target"] = target
        self.binary += data
        return self.add("bufferViews", entry)

    def floats(self, values, bounds=False, target=34962):
        width = len(values[0])
        data = b"".join(struct.pack("<%df" % width, *v) for v in values)
        kind = {1: "SCALAR", 16: "MAT4"}.get(width, "VEC%d" % width)
        entry = {"bufferView": self.view(data, target), "componentType": FLOAT, "count": len(values), "type": kind}
        if bounds:
            stored = [struct.unpack_from("<%df" % width, data, i * 4 * width) for i in range(len(values))]
            entry["min"] = [min(v[k] for v in stored) for k in range(width)]
            entry["max"] = [max(v[k] for v in stored) for k in range(width)]
        return self.add("accessors", entry)

    def geometry(self, shape):
        """Attributes and indices of a primitive, without material."""
        attributes = {"POSITION": self.floats(shape.positions, True), "NORMAL": self.floats(shape.normals)}
        if shape.uvs: attributes["TEXCOORD_0"] = self.floats(shape.uvs)
        data = struct.pack("<%dH" % len(shape.indices), *shape.indices)
        indices = self.add("accessors", {"bufferView": self.view(data, 34963), "componentType": USHORT,
                                         "count": len(shape.indices), "type": "SCALAR"})
        return {"attributes": attributes, "indices": indices}

    def material(self, name, color=WHITE, metallic=0.0, roughness=1.0, emission=None, **more):
        pbr = {"baseColorFactor": [*color, 1.0], "metallicFactor": metallic, "roughnessFactor": roughness}
        entry = {"name": name, "pbrMetallicRoughness": pbr, **more}
        if emission:
            strength = max(emission)
            entry["emissiveFactor"] = [e / strength for e in emission]
            entry["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
            self.use("KHR_materials_emissive_strength")
        return self.add("materials", entry)

    def use(self, extension):
        used = self.json.setdefault("extensionsUsed", [])
        if extension not in used: used.append(extension)

    def node(self, **entry):
        index = self.add("nodes", entry)
        self.json["scenes"][0]["nodes"].append(index)
        return index

    def mesh(self, name, shape, material, **placed):
        return self.node(name=name, mesh=self.add("meshes", {"name": name, "primitives": [{**self.geometry(shape), "material": material}]}),
                         **placed)

    def clip(self, name, tracks):
        """`tracks`: (node, path, interpolation, times, values); values are tuples, or numbers for weights."""
        clip = {"name": name, "channels": [], "samplers": []}
        for node, path, interpolation, times, values in tracks:
            values = [v if isinstance(v, tuple) else (v,) for v in values]
            clip["samplers"].append({"input": self.floats([(t,) for t in times], True, None),
                                     "output": self.floats(values, False, None), "interpolation": interpolation})
            clip["channels"].append({"sampler": len(clip["samplers"]) - 1, "target": {"node": node, "path": path}})
        self.add("animations", clip)

    def point_light(self, name, position, color, candela):
        self.use("KHR_lights_punctual")
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"type": "point", "color": [round(c, 4) for c in color], "intensity": round(candela, 6)})
        self.node(name=name, translation=[round(p, 5) for p in position],
                  extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def camera(self, eye, target, degrees, aspect=16 / 9):
        """A camera node; quaternion from the basis right, up, back."""
        back = unit(sub(eye, target))
        right = unit(cross((0, 1, 0), back))
        up = cross(back, right)
        w = math.sqrt(max(0.0, 1 + right[0] + up[1] + back[2])) / 2
        q = [(up[2] - back[1]) / (4 * w), (back[0] - right[2]) / (4 * w), (right[1] - up[0]) / (4 * w), w]
        index = self.add("cameras", {"name": "main", "type": "perspective", "perspective": {
            "yfov": math.radians(degrees), "znear": 0.01, "zfar": 100.0, "aspectRatio": aspect}})
        self.node(name="main", camera=index, translation=list(eye), rotation=q)

    def write(self, path):
        while len(self.binary) % 4: self.binary.append(0)
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.binary)
        with open(path, "wb") as out:
            out.write(struct.pack("<4sII", b"glTF", 2, size))
            out.write(struct.pack("<I4s", len(text), b"JSON") + text)
            out.write(struct.pack("<I4s", len(self.binary), b"BIN\0") + bytes(self.binary))


# The room spans x -1..1, y 0..2, z -1..1 and is open towards +Z.
BLOCKS = (((-0.35, 0.0, -0.3), (0.6, 1.2, 0.6), 18.0), ((0.37, 0.0, 0.35), (0.6, 0.6, 0.6), -17.0))


def cornell_room(g, blocks=True):
    white = g.material("white")
    room = Shape()
    room.quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1))  # floor
    room.quad((-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1))  # ceiling
    room.quad((-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1))  # back
    g.mesh("room", room, white)
    g.mesh("left wall", Shape().quad((-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)), g.material("red", RED))
    g.mesh("right wall", Shape().quad((1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1)), g.material("green", GREEN))
    if blocks:
        g.mesh("tall block", Shape().block(*BLOCKS[0]), white)
        g.mesh("short block", Shape().block(*BLOCKS[1]), white)
    g.camera((0, 1, 3.9), (0, 1, 0), 39.0, 1.0)


def cornell(path):
    g = Gltf()
    cornell_room(g)
    lamp = Shape().quad((-0.25, 1.98, -0.2), (0.25, 1.98, -0.2), (0.25, 1.98, 0.2), (-0.25, 1.98, 0.2))
    g.mesh("lamp", lamp, g.material("lamp", (0.78, 0.78, 0.78), emission=(17.0, 12.0, 4.0)))
    g.write(path)


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
    for name, make in (("cornell", cornell), ("cornell-1000-points", cornell_points), ("cornell-moving", cornell_moving),
                       ("materials", materials), ("alpha-mask", alpha_mask)):
        path = os.path.join(folder, name + ".glb")
        make(path)
        print("%s: %d bytes" % (path, os.path.getsize(path)))
    path = os.path.join(folder, "sky.hdr")
    sky(path)
    print("%s: %d bytes" % (path, os.path.getsize(path)))


if __name__ == "__main__":
    main()
