"""interior.glb: a furnished room in which every surface is Lambertian and flat, so that another renderer can be asked for the same
picture without a word about material models (docs/offline.md). Sun through a window with bars and blinds, a ceiling panel, a
lantern of emissive facets behind a paper shade, a point light over the table. Thin parts are down to 4 mm. No two faces that are seen lie in
one plane, and the camera sees no back of a single-sided face."""
import math

from gltf_writer import Gltf, Random, Shape, cross, sub, unit

# Metres: the room is x -2.5 .. 2.5, y 0 .. 2.7, z -3 .. 3; the window is in the wall at -x.
X, HEIGHT, Z, REVEAL = 2.5, 2.7, 3.0, 0.2
WINDOW_Y, WINDOW_Z = (0.9, 2.25), (-1.7, 0.3)


def turned(degrees, centre):
    """About Y, then moved to `centre`."""
    s, c = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    return lambda p: (centre[0] + c * p[0] + s * p[2], centre[1] + p[1], centre[2] - s * p[0] + c * p[2])


def walls(g, paint):
    x, z, h = X, Z, HEIGHT
    g.mesh("floor", Shape().quad((-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z)), paint("boards", (0.42, 0.27, 0.16)))
    plain = Shape().quad((-x, h, -z), (x, h, -z), (x, h, z), (-x, h, z))  # ceiling
    plain.quad((x, 0, z), (-x, 0, z), (-x, h, z), (x, h, z))  # behind the camera
    g.mesh("ceiling and near wall", plain, paint("white", (0.78, 0.77, 0.74)))
    g.mesh("back wall", Shape().quad((-x, 0, -z), (x, 0, -z), (x, h, -z), (-x, h, -z)), paint("ochre", (0.66, 0.47, 0.24)))
    g.mesh("right wall", Shape().quad((x, 0, -z), (x, 0, z), (x, h, z), (x, h, -z)), paint("sage", (0.30, 0.46, 0.31)))
    left = Shape()
    rows, columns = (0, *WINDOW_Y, h), (z, WINDOW_Z[1], WINDOW_Z[0], -z)
    for r in range(3):
        for c in range(3):
            if r == c == 1: continue
            left.quad((-x, rows[r], columns[c]), (-x, rows[r], columns[c + 1]), (-x, rows[r + 1], columns[c + 1]), (-x, rows[r + 1], columns[c]))
    g.mesh("left wall", left, paint("blue", (0.25, 0.36, 0.55)))
    (y0, y1), (z0, z1), out = WINDOW_Y, WINDOW_Z, -x - REVEAL
    reveal = Shape().quad((out, y0, z1), (-x, y0, z1), (-x, y0, z0), (out, y0, z0)).quad((out, y1, z0), (-x, y1, z0), (-x, y1, z1), (out, y1, z1))
    reveal.quad((out, y0, z0), (-x, y0, z0), (-x, y1, z0), (out, y1, z0)).quad((-x, y0, z1), (out, y0, z1), (out, y1, z1), (-x, y1, z1))
    g.mesh("reveal", reveal, paint("plaster", (0.72, 0.72, 0.72)))


def window(g, paint):
    (y0, y1), (z0, z1), middle = WINDOW_Y, WINDOW_Z, -X - 0.14
    bars = Shape()
    for z in (z0 + 0.01, (z0 + z1) / 2, z1 - 0.01): bars.box((middle - 0.02, y0 - 0.01, z - 0.02), (middle + 0.02, y1 + 0.01, z + 0.02))
    bars.box((middle - 0.015, 1.72, z0 - 0.01), (middle + 0.015, 1.75, z1 + 0.01))
    g.mesh("bars", bars, paint("frame", (0.62, 0.60, 0.55)))
    slats, tilt = Shape(), math.radians(30)
    for i in range(9):
        y = y1 - 0.05 - 0.075 * i
        def tilted(p, y=y): return (-X - 0.06 + math.cos(tilt) * p[0] - math.sin(tilt) * p[1], y + math.sin(tilt) * p[0] + math.cos(tilt) * p[1], p[2])
        slats.box((-0.03, -0.002, z0 + 0.015), (0.03, 0.002, z1 - 0.015), tilted)
    g.mesh("slats", slats, paint("slat", (0.75, 0.68, 0.52)))


def furniture(g, paint):
    wood = paint("wood", (0.46, 0.29, 0.14))
    at = turned(12, (-0.35, 0, -0.5))
    table = Shape().box((-0.8, 0.72, -0.45), (0.8, 0.76, 0.45), at)
    for x in (-0.7, 0.7):
        for z in (-0.35, 0.35): table.box((x - 0.03, 0, z - 0.03), (x + 0.03, 0.73, z + 0.03), at)
    g.mesh("table", table, wood)
    chair = Shape().box((-0.21, 0.43, -0.21), (0.21, 0.465, 0.21))
    for x in (-0.18, 0.18):
        chair.box((x - 0.018, 0, 0.15), (x + 0.018, 0.44, 0.186))
        chair.box((x - 0.018, 0, -0.2), (x + 0.018, 0.92, -0.164))
    for y in (0.58, 0.7, 0.82): chair.box((-0.17, y, -0.19), (0.17, y + 0.06, -0.175))
    chairs = {**g.geometry(chair), "material": paint("chair", (0.55, 0.12, 0.09))}
    chairs = g.add("meshes", {"name": "chair", "primitives": [chairs]})
    for x, z, degrees in ((-0.75, -1.25, 15), (0.15, -1.45, -8), (-0.85, 0.35, 200), (0.65, 0.25, 120)):
        half = math.radians(degrees) / 2
        g.node(name="chair", mesh=chairs, translation=[x, 0, z], rotation=[0, math.sin(half), 0, math.cos(half)])
    g.mesh("rug", Shape().box((-1.35, 0, -1.15), (1.35, 0.012, 1.15), turned(5, (-0.3, 0, -0.4))), paint("rug", (0.50, 0.18, 0.22)))
    sofa = Shape().box((1.45, 0.08, -0.9), (2.35, 0.4, 1.1)).box((2.15, 0.39, -0.9), (2.4, 0.85, 1.1))
    sofa.box((1.5, 0.39, -1.02), (2.38, 0.6, -0.85)).box((1.5, 0.39, 1.05), (2.38, 0.6, 1.22))
    g.mesh("sofa", sofa, paint("cloth", (0.16, 0.24, 0.40)))
    bowl = [(0.05, 0.0), (0.11, 0.02), (0.16, 0.06), (0.185, 0.11)]
    g.mesh("bowl", Shape().lathe((-0.15, 0.762, -0.4), bowl, 20), paint("bowl", (0.80, 0.78, 0.72), doubleSided=True))
    ball = [(0.13 * math.sin(math.pi * i / 8), 0.13 - 0.13 * math.cos(math.pi * i / 8)) for i in range(9)]
    ball[0], ball[-1] = (0, 0.0), (0, 0.26)
    g.mesh("ball", Shape().lathe((-0.75, 0.761, -0.5), ball, 14), paint("ball", (0.75, 0.42, 0.08)))
    for i, (x, y, w, h, color) in enumerate(((-1.75, 1.15, 0.7, 0.9, (0.12, 0.30, 0.42)), (-0.85, 1.4, 0.5, 0.5, (0.62, 0.16, 0.12)))):
        frame = Shape()
        for low, high in (((x, y, 0), (x + w, y + 0.03, 0.04)), ((x, y + h - 0.03, 0), (x + w, y + h, 0.04)),
                          ((x, y + 0.02, 0.002), (x + 0.03, y + h - 0.02, 0.038)), ((x + w - 0.03, y + 0.02, 0.002), (x + w, y + h - 0.02, 0.038))):
            frame.box(*[(p[0], p[1], p[2] - Z + 0.005) for p in (low, high)])
        g.mesh("frame", frame, wood)
        back = -Z + 0.02
        canvas = Shape().quad((x + 0.02, y + 0.02, back), (x + w - 0.02, y + 0.02, back), (x + w - 0.02, y + h - 0.02, back), (x + 0.02, y + h - 0.02, back))
        g.mesh("canvas", canvas, paint("canvas %d" % i, color))


def shelf(g, paint, random):
    x0, x1, z0, z1 = 0.35, 2.2, -Z + 0.01, -Z + 0.33
    boards = Shape()
    for x in (x0, (x0 + x1) / 2, x1): boards.box((x - 0.012, 0, z0), (x + 0.012, 2.1, z1))
    levels = (0.1, 0.5, 0.9, 1.3, 1.7)
    for y in levels: boards.box((x0 + 0.01, y, z0 + 0.005), (x1 - 0.01, y + 0.02, z1 - 0.005))
    g.mesh("shelf", boards, paint("pale wood", (0.64, 0.50, 0.33)))
    colors = ((0.55, 0.08, 0.06), (0.08, 0.16, 0.42), (0.12, 0.34, 0.14), (0.70, 0.55, 0.16), (0.42, 0.40, 0.38), (0.30, 0.10, 0.32))
    books = [Shape() for _ in colors]
    for y in levels:
        for left, right in ((x0, (x0 + x1) / 2), ((x0 + x1) / 2, x1)):
            x, end = left + 0.02, right - 0.02 - 0.25 * random.number()
            while True:
                width, height, depth = 0.018 + 0.035 * random.number(), 0.2 + 0.14 * random.number(), 0.16 + 0.1 * random.number()
                if x + width > end: break
                book = books[int(random.number() * len(books))]
                book.box((x, y + 0.021, z0 + 0.02), (x + width, y + 0.021 + height, z0 + 0.02 + depth))
                x += width + 0.002
    for i, book in enumerate(books): g.mesh("books", book, paint("binding %d" % i, colors[i]))


def plant(g, paint, random):
    x, z = -2.0, -2.35
    g.mesh("pot", Shape().lathe((x, 0, z), [(0.15, 0.0), (0.22, 0.38)], 16), paint("pot", (0.50, 0.23, 0.14), doubleSided=True))
    g.mesh("soil", Shape().polygon([(x + 0.2 * math.sin(a * math.pi / 8), 0.33, z + 0.2 * math.cos(a * math.pi / 8)) for a in range(16)]),
           paint("soil", (0.09, 0.06, 0.04)))
    leaves = Shape()
    for i in range(36):
        angle, out, up = 2.4 * i, 0.06 + 0.2 * random.number(), 0.5 + 0.55 * random.number()
        root = (x + out * math.sin(angle), up, z + out * math.cos(angle))
        along = unit((math.sin(angle), 0.9 - 1.6 * random.number(), math.cos(angle)))
        side = unit(cross(along, (math.cos(angle), 0.4 * random.number(), -math.sin(angle))))
        side = unit(cross(side, along))
        length, half = 0.16 + 0.08 * random.number(), 0.035
        def leaf(u, v): return tuple(root[k] + u * length * along[k] + v * half * side[k] for k in range(3))
        leaves.polygon([leaf(0, 0), leaf(0.45, 1), leaf(1, 0), leaf(0.45, -1)])
    g.mesh("leaves", leaves, paint("leaf", (0.13, 0.33, 0.08), doubleSided=True))


def lamps(g, paint):
    x, z, y = 0.3, 1.0, HEIGHT - 0.05
    panel = Shape().quad((x - 0.5, y, z - 0.25), (x + 0.5, y, z - 0.25), (x + 0.5, y, z + 0.25), (x - 0.5, y, z + 0.25))
    g.mesh("panel", panel, paint("panel", (0.6, 0.6, 0.6), emission=(9.0, 8.5, 7.5)))
    frame = Shape()
    for s in (-1, 1):
        frame.box((x - 0.54, y - 0.06, z + s * 0.27 - 0.02), (x + 0.54, HEIGHT + 0.01, z + s * 0.27 + 0.02))
        frame.box((x + s * 0.52 - 0.02, y - 0.055, z - 0.26), (x + s * 0.52 + 0.02, HEIGHT + 0.01, z + 0.26))
    g.mesh("panel frame", frame, paint("metal", (0.55, 0.55, 0.57)))
    centre = (1.35, 1.45, -1.75)
    lantern = [(0, -0.1), (0.075, -0.06), (0.09, 0.0), (0.075, 0.06), (0, 0.1)]
    g.mesh("lantern", Shape().lathe(centre, lantern, 8), paint("lantern", (0.7, 0.7, 0.7), emission=(26.0, 17.0, 8.0)))
    g.mesh("shade", Shape().lathe(centre, [(0.24, -0.18), (0.17, 0.16)], 16), paint("paper", (0.80, 0.74, 0.60), doubleSided=True))
    stand = Shape().box((-0.012, 0.02, -0.012), (0.012, 1.36, 0.012), lambda p: (centre[0] + p[0], p[1], centre[2] + p[2]))
    stand.box((-0.14, 0, -0.14), (0.14, 0.025, 0.14), turned(20, (centre[0], 0, centre[2])))
    g.mesh("stand", stand, paint("iron", (0.12, 0.12, 0.13)))
    g.point_light("bulb", (-0.35, 1.75, -0.5), (1.0, 0.86, 0.62), 2.2)
    g.sun("sun", sub((0.4, 0, 0.1), (-X, 1.75, -0.75)), (1.0, 0.93, 0.82), 14.0)


def write(path):
    g, random = Gltf(), Random(4)
    def paint(name, color, **more): return g.material(name, color, lambert=True, **more)
    walls(g, paint)
    window(g, paint)
    furniture(g, paint)
    shelf(g, paint, random)
    plant(g, paint, random)
    lamps(g, paint)
    g.camera((1.5, 1.55, 2.85), (-0.55, 0.95, -1.0), 62.0, 1.0)
    g.write(path)
