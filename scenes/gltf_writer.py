"""Geometry and the glTF writer of Weir's own scenes. Standard library only; the same calls give the same bytes. Metres, +Y up."""
import json
import math
import struct

FLOAT, USHORT = 5126, 5123


def sub(a, b): return tuple(x - y for x, y in zip(a, b))
def cross(a, b): return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def looking(direction):
    """Quaternion x y z w that turns -Z, where cameras and directional lights point, this way and keeps +Y upright."""
    back = unit(tuple(0.0 - d for d in direction))
    right = unit(cross((0, 1, 0), back))
    up = cross(back, right)
    w = math.sqrt(max(0.0, 1 + right[0] + up[1] + back[2])) / 2
    return [(up[2] - back[1]) / (4 * w), (back[0] - right[2]) / (4 * w), (right[1] - up[0]) / (4 * w), w]


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

    def box(self, low, high, turned=None):
        """A closed box between two corners; `turned` moves every corner, without mirroring."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        for corners in (((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)), ((x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)),
                        ((x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)), ((x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)),
                        ((x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)), ((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1))):
            self.quad(*(turned(p) if turned else p for p in corners))
        return self

    def lathe(self, centre, profile, segments):
        """Flat facets around the axis of Y, outsides where the profile of (radius, height) rises; a radius of 0 is a tip."""
        def at(r, y, s):
            angle = 2 * math.pi * s / segments
            return (centre[0] + r * math.sin(angle), centre[1] + y, centre[2] + r * math.cos(angle))
        for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
            for s in range(segments):
                corners = [at(r0, y0, s), at(r0, y0, s + 1), at(r1, y1, s + 1), at(r1, y1, s)]
                if r0 == 0: del corners[1]
                elif r1 == 0: del corners[2]
                self.polygon(corners)
        return self

    def polygon(self, corners):
        """Flat, convex, counter-clockwise as seen from the front."""
        normal, base = unit(cross(sub(corners[1], corners[0]), sub(corners[-1], corners[0]))), len(self.positions)
        self.positions += corners
        self.normals += [normal] * len(corners)
        for i in range(1, len(corners) - 1): self.indices += [base, base + i, base + i + 1]
        return self

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

    def material(self, name, color=(0.73, 0.73, 0.73), metallic=0.0, roughness=1.0, emission=None, lambert=False, **more):
        """`lambert`: nothing but Lambert's law, for glTF's own default is a dielectric that reflects 4 % and more at its surface."""
        pbr = {"baseColorFactor": [*color, 1.0], "metallicFactor": metallic, "roughnessFactor": roughness}
        entry = {"name": name, "pbrMetallicRoughness": pbr, **more}
        if emission:
            strength = max(emission)
            entry["emissiveFactor"] = [e / strength for e in emission]
            self.extend(entry, "KHR_materials_emissive_strength", {"emissiveStrength": strength})
        if lambert: self.extend(entry, "KHR_materials_specular", {"specularFactor": 0.0})
        return self.add("materials", entry)

    def use(self, extension):
        used = self.json.setdefault("extensionsUsed", [])
        if extension not in used: used.append(extension)

    def extend(self, entry, extension, value):
        entry.setdefault("extensions", {})[extension] = value
        self.use(extension)

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

    def light(self, name, kind, color, intensity, **placed):
        self.use("KHR_lights_punctual")
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"type": kind, "color": [round(c, 4) for c in color], "intensity": round(intensity, 6)})
        self.node(name=name, **placed, extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def point_light(self, name, position, color, candela):
        self.light(name, "point", color, candela, translation=[round(p, 5) for p in position])

    def sun(self, name, direction, color, lux):
        """`direction`: the way that its light goes."""
        self.light(name, "directional", color, lux, rotation=looking(direction))

    def camera(self, eye, target, degrees, aspect=16 / 9):
        index = self.add("cameras", {"name": "main", "type": "perspective", "perspective": {
            "yfov": math.radians(degrees), "znear": 0.01, "zfar": 100.0, "aspectRatio": aspect}})
        self.node(name="main", camera=index, translation=list(eye), rotation=looking(sub(target, eye)))

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
