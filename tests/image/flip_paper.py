"""FLIP written down a second time, straight from the papers, in plain Python and double precision: filters as full
two-dimensional sums, nothing separated, trimmed or shared. Slow, and meant to be: it is what framework/image/flip.cpp is
checked against.

LDR: Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", 2020; section numbers below are its.
HDR: Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", 2021.
A picture is a list of rows of (r, g, b).
"""
import math

PPD = 0.7 * 3840 / 0.7 * math.pi / 180  # section 4.1: 0.7 m from a 0.7 m wide screen of 3840 pixels

# BT.709 primaries and D65 (x, y), from which the matrix follows.
PRIMARIES, WHITE = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06)), (0.3127, 0.3290)


def solve3(m, v):
    """x with m x = v, by Cramer's rule."""
    def det(a):
        return (a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
                + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]))
    whole = det(m)
    return [det([[v[r] if c == k else m[r][c] for c in range(3)] for r in range(3)]) / whole for k in range(3)]


def xyz(x, y):
    return [x / y, 1.0, (1 - x - y) / y]


WHITE_XYZ = xyz(*WHITE)
_columns = [xyz(*p) for p in PRIMARIES]
_scale = solve3([[_columns[c][r] for c in range(3)] for r in range(3)], WHITE_XYZ)
TO_XYZ = [[_columns[c][r] * _scale[c] for c in range(3)] for r in range(3)]


def relative_xyz(rgb):
    return [sum(TO_XYZ[r][c] * rgb[c] for c in range(3)) / WHITE_XYZ[r] for r in range(3)]


def linear(v):
    v = min(max(v, 0.0), 1.0)
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def ycxcz(rgb):
    """Section 4.1.1."""
    x, y, z = relative_xyz(rgb)
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)]


def from_ycxcz(o):
    y = (o[0] + 16) / 116
    return solve3(TO_XYZ, [(o[1] / 500 + y) * WHITE_XYZ[0], y * WHITE_XYZ[1], (y - o[2] / 200) * WHITE_XYZ[2]])


def hunt_lab(rgb):
    """CIELAB (CIE 15), a and b times 0.01 L: section 4.1.2."""
    def f(t):
        return t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
    fx, fy, fz = (f(t) for t in relative_xyz(rgb))
    lightness = 116 * fy - 16
    return [lightness, 0.01 * lightness * 500 * (fx - fy), 0.01 * lightness * 200 * (fy - fz)]


def hyab(a, b):
    return abs(a[0] - b[0]) + math.hypot(a[1] - b[1], a[2] - b[2])


def convolve(plane, kernel):
    """Borders repeated. `kernel`: (dx, dy) -> weight; a sum over offsets that look along +x, +y."""
    height, width = len(plane), len(plane[0])
    result = []
    for y in range(height):
        row = []
        for x in range(width):
            total = 0.0
            for (dx, dy), w in kernel:
                total += w * plane[min(max(y + dy, 0), height - 1)][min(max(x + dx, 0), width - 1)]
            row.append(total)
        result.append(row)
    return result


def offsets(radius):
    return [(dx, dy) for dy in range(-radius, radius + 1) for dx in range(-radius, radius + 1)]


# Table 1: a1, b1, a2, b2 of each channel's contrast sensitivity.
CSF = ((1, 0.0047, 0, 1e-5), (1, 0.0053, 0, 1e-5), (34.1, 0.04, 13.5, 0.025))


def sensitivity(channel, ppd):
    a1, b1, a2, b2 = CSF[channel]
    radius = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi ** 2)) * ppd)
    taps = []
    for dx, dy in offsets(radius):
        r2 = (dx * dx + dy * dy) / ppd ** 2
        taps.append(a1 * math.sqrt(math.pi / b1) * math.exp(-math.pi ** 2 * r2 / b1)
                    + a2 * math.sqrt(math.pi / b2) * math.exp(-math.pi ** 2 * r2 / b2))
    whole = sum(taps)
    return [(o, t / whole) for o, t in zip(offsets(radius), taps) if t / whole > 1e-14]


def detector(kind, ppd, along_x):
    """Section 4.2: first (edges) or second (points) derivative of a Gaussian of 0.082 degrees; its positive weights sum
    to 1, its negative ones to -1."""
    sigma = 0.5 * 0.082 * ppd
    radius = math.ceil(3 * sigma)
    taps = []
    for dx, dy in offsets(radius):
        x = dx if along_x else dy
        g = math.exp(-(dx * dx + dy * dy) / (2 * sigma * sigma))
        taps.append(-x * g if kind == "edge" else (x * x / sigma ** 2 - 1) * g)
    positive, negative = sum(t for t in taps if t > 0), -sum(t for t in taps if t < 0)
    return [(o, t / (positive if t > 0 else negative)) for o, t in zip(offsets(radius), taps) if t != 0]


def features(picture, ppd):
    """Lengths of the gradients for edges and for points, of normalised luminance."""
    grey = [[(ycxcz(p)[0] + 16) / 116 for p in row] for row in picture]
    result = []
    for kind in ("edge", "point"):
        x, y = (convolve(grey, detector(kind, ppd, along)) for along in (True, False))
        result.append([[math.hypot(a, b) for a, b in zip(r, s)] for r, s in zip(x, y)])
    return result


def seen(picture, ppd):
    """What contrast sensitivity leaves of it, in Hunt-adjusted CIELAB."""
    planes = [[[ycxcz(p)[c] for p in row] for row in picture] for c in range(3)]
    planes = [convolve(plane, sensitivity(c, ppd)) for c, plane in enumerate(planes)]
    height, width = len(picture), len(picture[0])
    return [[hunt_lab([min(max(v, 0.0), 1.0) for v in from_ycxcz([planes[c][y][x] for c in range(3)])])
             for x in range(width)] for y in range(height)]


CMAX = hyab(hunt_lab((0, 1, 0)), hunt_lab((0, 0, 1))) ** 0.7


def colour_difference(a, b):
    """Section 4.1.3: q_c = 0.7, p_c = 0.4, p_t = 0.95."""
    d, knee = hyab(a, b) ** 0.7, 0.4 * CMAX
    return 0.95 / knee * d if d < knee else 0.95 + (d - knee) / (CMAX - knee) * 0.05


def flip_linear(test, reference, ppd=PPD):
    a, b, fa, fb = seen(test, ppd), seen(reference, ppd), features(test, ppd), features(reference, ppd)
    result = []
    for y in range(len(test)):
        row = []
        for x in range(len(test[0])):
            colour = colour_difference(a[y][x], b[y][x])
            feature = max(abs(fa[k][y][x] - fb[k][y][x]) for k in range(2))
            feature = (feature / math.sqrt(2)) ** 0.5  # q_f = 0.5
            row.append(colour ** (1 - feature) if colour > 0 else 0.0)
        result.append(row)
    return result


def ldr_flip(test, reference, ppd=PPD):
    """Of sRGB-encoded values."""
    decode = lambda picture: [[tuple(linear(v) for v in p) for p in row] for row in picture]
    return flip_linear(decode(test), decode(reference), ppd)


# HDR: Narkowicz' fit of ACES, exposure 0.6 taken in.
A, B, C, D, E = 0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14


def aces(v):
    return min(max((A * v * v + B * v) / (C * v * v + D * v + E), 0.0), 1.0)


def exposures(reference):
    """Start, stop and number: the brightest and the median luminance go to where the tone map gives 0.85."""
    t = 0.85
    a, b, c = A - t * C, B - t * D, -t * E
    shoulder = (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a)
    luminances = sorted(sum(TO_XYZ[1][c] * max(p[c], 0.0) for c in range(3)) for row in reference for p in row)
    median = luminances[(len(luminances) - 1) // 2]
    start, stop = math.log2(shoulder / luminances[-1]), math.log2(shoulder / median)
    return start, stop, max(2, math.ceil(stop - start))


def hdr_flip(test, reference, ppd=PPD):
    start, stop, count = exposures(reference)
    most = [[0.0] * len(test[0]) for _ in test]
    for i in range(count):
        factor = 2 ** (start + (stop - start) * i / (count - 1))
        shown = lambda picture: [[tuple(aces(factor * max(v, 0.0)) for v in p) for p in row] for row in picture]
        one = flip_linear(shown(test), shown(reference), ppd)
        most = [[max(p, q) for p, q in zip(r, s)] for r, s in zip(most, one)]
    return most
