"""A glTF binary as plain lists of what Blender and Weir can both show without doubt: flat Lambertian triangles, emission, point and
directional lights, one camera. Anything else is an error: a comparison must not leave parts of a scene out."""
import json
import math
import struct

EXTENSIONS = {"KHR_materials_emissive_strength", "KHR_materials_specular", "KHR_lights_punctual"}
INDEX = {5121: "B", 5123: "H", 5125: "I"}


class Unsupported(Exception):
    """Says which part of the file it is."""


def only(entry, allowed, where):
    for key in entry:
        if key not in allowed: raise Unsupported("%s: '%s' is not compared" % (where, key))


def multiply(a, b): return [[sum(a[r][k] * b[k][c] for k in range(4)) for c in range(4)] for r in range(4)]
def at_point(m, p): return tuple(sum(m[r][k] * p[k] for k in range(3)) + m[r][3] for r in range(3))


def transform(node):
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    s, t = node.get("scale", (1, 1, 1)), node.get("translation", (0, 0, 0))
    r = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
         (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
         (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    return [[r[i][k] * s[k] for k in range(3)] + [t[i]] for i in range(3)] + [[0, 0, 0, 1]]


class Glb:
    """`meshes`: (name, corners in the world, triangles counter-clockwise, material index); `lights`: (kind, matrix, colour,
    intensity in candela or lux); `camera`: (matrix, vertical field of view in radians)."""

    def __init__(self, path):
        with open(path, "rb") as file: data = file.read()
        if len(data) < 28 or data[:4] != b"glTF": raise Unsupported("'%s' is not a glTF binary" % path)
        size, = struct.unpack_from("<I", data, 12)
        self.json, self.binary = json.loads(data[20:20 + size]), data[28 + size:]
        for name in self.json.get("extensionsUsed", []):
            if name not in EXTENSIONS: raise Unsupported("extension %s is not compared" % name)
        for name in ("skins", "animations", "textures"):
            if name in self.json: raise Unsupported("%s are not compared" % name)
        self.meshes, self.lights, self.camera = [], [], None
        self.materials = [self.material(m) for m in self.json["materials"]]
        identity = [[float(r == c) for c in range(4)] for r in range(4)]
        for index in self.json["scenes"][self.json.get("scene", 0)]["nodes"]: self.node(index, identity)
        if self.camera is None: raise Unsupported("'%s' has no camera" % path)

    def accessor(self, index):
        a = self.json["accessors"][index]
        only(a, ("bufferView", "byteOffset", "componentType", "count", "type", "min", "max"), "accessor %d" % index)
        view = self.json["bufferViews"][a["bufferView"]]
        only(view, ("buffer", "byteOffset", "byteLength", "target"), "buffer view %d" % a["bufferView"])
        offset = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        if a["type"] == "VEC3" and a["componentType"] == 5126:
            flat = struct.unpack_from("<%df" % (3 * a["count"]), self.binary, offset)
            return [flat[i:i + 3] for i in range(0, len(flat), 3)]
        if a["type"] == "SCALAR" and a["componentType"] in INDEX:
            return struct.unpack_from("<%d%s" % (a["count"], INDEX[a["componentType"]]), self.binary, offset)
        raise Unsupported("accessor %d is neither a float VEC3 nor a list of indices" % index)

    def material(self, m):
        """Name, linear base colour, emitted radiance in nit, whether both sides are fronts."""
        where = "material '%s'" % m.get("name", "")
        only(m, ("name", "pbrMetallicRoughness", "emissiveFactor", "extensions", "doubleSided"), where)
        pbr, extensions = m.get("pbrMetallicRoughness", {}), m.get("extensions", {})
        only(pbr, ("baseColorFactor", "metallicFactor", "roughnessFactor"), where)
        # glTF's default for specularFactor is 1: a dielectric coat whose formula is glTF's own.
        if pbr.get("metallicFactor", 1) != 0 or extensions.get("KHR_materials_specular", {}).get("specularFactor", 1) != 0:
            raise Unsupported(where + " is not purely Lambertian (metallicFactor 0 and specularFactor 0)")
        strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
        return (m.get("name", ""), pbr.get("baseColorFactor", (1, 1, 1, 1))[:3],
                [f * strength for f in m.get("emissiveFactor", (0, 0, 0))], m.get("doubleSided", False))

    def node(self, index, parent):
        n = self.json["nodes"][index]
        only(n, ("name", "mesh", "camera", "children", "translation", "rotation", "scale", "extensions"), "node %d" % index)
        matrix = multiply(parent, transform(n))
        if "mesh" in n: self.mesh(n["mesh"], matrix)
        if "camera" in n and self.camera is None:
            perspective = self.json["cameras"][n["camera"]]["perspective"]
            self.camera = (matrix, perspective["yfov"])
        if "KHR_lights_punctual" in n.get("extensions", {}):
            light = self.json["extensions"]["KHR_lights_punctual"]["lights"][n["extensions"]["KHR_lights_punctual"]["light"]]
            only(light, ("name", "type", "color", "intensity"), "light of node %d" % index)
            if light["type"] not in ("point", "directional"): raise Unsupported("%s lights are not compared" % light["type"])
            self.lights.append((light["type"], matrix, light.get("color", (1, 1, 1)), light.get("intensity", 1.0)))
        for child in n.get("children", []): self.node(child, matrix)

    def mesh(self, index, matrix):
        m = self.json["meshes"][index]
        (a, b, c), (d, e, f), (g, h, i) = (row[:3] for row in matrix[:3])
        mirrored = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0
        for primitive in m["primitives"]:
            where = "mesh '%s'" % m.get("name", "")
            only(primitive, ("attributes", "indices", "material"), where)
            only(primitive["attributes"], ("POSITION", "NORMAL"), where)
            positions, flat = self.accessor(primitive["attributes"]["POSITION"]), self.accessor(primitive["indices"])
            triangles = [flat[k:k + 3] for k in range(0, len(flat), 3)]
            if "NORMAL" in primitive["attributes"]: self.check_flat(positions, self.accessor(primitive["attributes"]["NORMAL"]), triangles, where)
            if mirrored: triangles = [(t[0], t[2], t[1]) for t in triangles]
            self.meshes.append((m.get("name", "mesh"), [at_point(matrix, p) for p in positions], triangles, primitive["material"]))

    @staticmethod
    def check_flat(positions, normals, triangles, where):
        """Renderers differ in how light behaves where shading normals and surfaces disagree."""
        for t in triangles:
            p, q, r = (positions[k] for k in t)
            u, v = [q[k] - p[k] for k in range(3)], [r[k] - p[k] for k in range(3)]
            face = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            length = math.sqrt(sum(x * x for x in face))
            if any(sum(face[k] * normals[i][k] for k in range(3)) < 0.99999 * length for i in t):
                raise Unsupported(where + " is shaded smoothly")
