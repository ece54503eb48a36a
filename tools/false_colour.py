#!/usr/bin/env python3
"""Prints the polynomials of shaders/view/false_colour.glsl: a map from [0, 1] to colours of which equal steps look equally
far apart, dark violet over blue and green to light yellow. Standard library only.

The map is a line through OKLab (Ottosson 2020): lightness grows evenly, the hue turns one way, chroma stays below what
sRGB can show, and the places on it are spread evenly by arc length. A polynomial of degree 6 is fitted to each of the
encoded sRGB channels by least squares, and what is printed beside it says how even it is.
"""
import math
import sys

STEPS, DEGREE = 256, 6


def to_linear(L, a, b):
    l, m, s = ((L + 0.3963377774 * a + 0.2158037573 * b) ** 3, (L - 0.1055613458 * a - 0.0638541728 * b) ** 3,
               (L - 0.0894841775 * a - 1.2914855480 * b) ** 3)
    return (4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)


def to_oklab(rgb):
    r, g, b = rgb
    l, m, s = (math.cbrt(x) if hasattr(math, "cbrt") else x ** (1 / 3) for x in
               (0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b, 0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b,
                0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b))
    return (0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s, 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s)


def encode(x):
    return 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055


def decode(v):
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def most_chroma(L, hue):
    low, high = 0.0, 0.4
    for _ in range(40):
        middle = (low + high) / 2
        inside = all(0 <= c <= 1 for c in to_linear(L, middle * math.cos(hue), middle * math.sin(hue)))
        low, high = (middle, high) if inside else (low, middle)
    return low


def smoothed(values, reach):
    n = len(values)
    return [sum(values[min(max(j, 0), n - 1)] for j in range(i - reach, i + reach + 1)) / (2 * reach + 1) for i in range(n)]


def line():
    places = [i / STEPS for i in range(STEPS + 1)]
    lightness = [0.24 + 0.68 * t for t in places]
    hue = [math.radians(305 - 200 * t ** 1.05) for t in places]
    most = [most_chroma(L, h) for L, h in zip(lightness, hue)]
    chroma = most
    for _ in range(60):
        chroma = smoothed([min(c, 0.96 * m) for c, m in zip(chroma, most)], 30)
    chroma = [min(c, 0.97 * m) for c, m in zip(chroma, most)]
    lab = [(L, c * math.cos(h), c * math.sin(h)) for L, c, h in zip(lightness, chroma, hue)]
    length = [0.0]
    for a, b in zip(lab, lab[1:]):
        length.append(length[-1] + math.dist(a, b))
    even, k = [], 0
    for t in places:
        while k + 2 < len(length) and length[k + 1] < t * length[-1]:
            k += 1
        f = (t * length[-1] - length[k]) / (length[k + 1] - length[k])
        even.append(tuple(a + f * (b - a) for a, b in zip(lab[k], lab[k + 1])))
    return places, [tuple(encode(min(max(c, 0.0), 1.0)) for c in to_linear(*p)) for p in even]


def fit(places, values):
    n = DEGREE + 1
    rows = [[sum(t ** (i + j) for t in places) for j in range(n)] + [sum(v * t ** i for t, v in zip(places, values))]
            for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for r in range(n):
            if r != i:
                f = rows[r][i] / rows[i][i]
                rows[r] = [a - f * b for a, b in zip(rows[r], rows[i])]
    return [round(rows[i][n] / rows[i][i], 4) for i in range(n)]


def main():
    places, colours = line()
    polynomials = [fit(places, [c[k] for c in colours]) for k in range(3)]
    fitted = [tuple(sum(a * t ** i for i, a in enumerate(p)) for p in polynomials) for t in places]
    off = max(abs(a - b) for f, c in zip(fitted, colours) for a, b in zip(f, c))
    linear = [tuple(decode(min(max(v, 0.0), 1.0)) for v in f) for f in fitted]
    lab = [to_oklab(c) for c in linear]
    steps = [math.dist(a, b) * STEPS for a, b in zip(lab, lab[1:])]
    luminance = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in linear]
    print(f"off the line by at most {off:.4f}; values from {min(map(min, fitted)):.4f} to {max(map(max, fitted)):.4f}")
    print(f"length of steps {min(steps):.3f} to {max(steps):.3f}, mean {sum(steps) / STEPS:.3f}; "
          f"luminance {luminance[0]:.4f} to {luminance[-1]:.4f}, smallest step {min(b - a for a, b in zip(luminance, luminance[1:])):.6f}")
    for i in range(DEGREE + 1):
        print(f"c{i} = vec3({', '.join(f'{p[i]:.4f}' for p in polynomials)})")
    return 0 if min(b - a for a, b in zip(luminance, luminance[1:])) > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
