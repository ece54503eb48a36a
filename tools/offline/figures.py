"""How far two pictures are apart, each known by parts with independent seeds, and how much of that is noise. Relative differences are
of luminance (linear Rec.709) against the second picture, of tiles against no less than 1 % of its mean, as in `weir compare`."""
import math

import exr

SIDE = 16  # pixels of a tile
WEIGHTS = (0.2126, 0.7152, 0.0722)
MEAN_BOUND, TILE_BOUND, TILE_SHARE = 0.003, 0.01, 0.95


def tiles(picture):
    """Means of R, G, B and luminance of each tile, row by row."""
    columns, rows = picture.width // SIDE, picture.height // SIDE
    found = [[0.0] * 4 for _ in range(columns * rows)]
    for y in range(rows * SIDE):
        for column in range(columns):
            tile, start = found[y // SIDE * columns + column], y * picture.width + column * SIDE
            for c in range(3): tile[c] += sum(picture.rgb[c][start:start + SIDE])
    for tile in found:
        for c in range(3): tile[c] /= SIDE * SIDE
        tile[3] = sum(w * v for w, v in zip(WEIGHTS, tile))
    return found


def total(grid, c): return sum(t[c] for t in grid) / len(grid)


def percentile(values, share):
    """The smallest value that at least this share of all is not above."""
    return sorted(values)[max(0, math.ceil(share * len(values)) - 1)]


def spread(values):
    """Standard error of the mean of independent parts."""
    mean = sum(values) / len(values)
    return math.sqrt(sum((v - mean) ** 2 for v in values) / (len(values) - 1) / len(values))


def relative(a, b, c, floor):
    """Of each tile; the same in both is no difference, also where both are black."""
    return [0.0 if s[c] == t[c] else (s[c] - t[c]) / max(t[c], floor) for s, t in zip(a, b)]


def summary(differences):
    sizes = [abs(d) for d in differences]
    return {"mean_absolute": sum(sizes) / len(sizes), "p95": percentile(sizes, TILE_SHARE), "largest": max(sizes),
            "share_within_1_percent": sum(s <= TILE_BOUND for s in sizes) / len(sizes)}


def halves(grids):
    """Difference of the means of odd and even parts, scaled to be as noisy as the mean of all parts; free of any bias."""
    odd, even = grids[0::2], grids[1::2]
    scale = math.sqrt(len(grids) * (1 / len(odd) + 1 / len(even)))
    return [[(sum(g[i][c] for g in odd) / len(odd) - sum(g[i][c] for g in even) / len(even)) / scale for c in range(4)]
            for i in range(len(grids[0]))]


def compare(pictures_a, pictures_b):
    grids_a, grids_b = [tiles(p) for p in pictures_a], [tiles(p) for p in pictures_b]
    a, b = tiles(exr.Picture.mean(pictures_a)), tiles(exr.Picture.mean(pictures_b))
    floor = 0.01 * total(b, 3)
    noise_a, noise_b = halves(grids_a), halves(grids_b)
    noise = [abs((u[3] - v[3]) / max(t[3], floor)) for u, v, t in zip(noise_a, noise_b, b)]
    result = {"mean": {}, "tiles": {}}
    for c, name in enumerate(("red", "green", "blue", "luminance")):
        reference = total(b, c)
        error = math.hypot(spread([total(g, c) for g in grids_a]), spread([total(g, c) for g in grids_b]))
        result["mean"][name] = {"relative_difference": total(a, c) / reference - 1, "standard_error": error / reference}
        result["tiles"][name] = summary(relative(a, b, c, 0.01 * reference))
    result["tiles"]["count"] = len(b)
    result["tiles"]["noise_alone"] = {"mean_absolute": sum(noise) / len(noise), "p95": percentile(noise, TILE_SHARE)}
    worst = sorted(range(len(b)), key=lambda i: -abs(relative(a, b, 3, floor)[i]))[:5]
    columns = pictures_b[0].width // SIDE
    result["tiles"]["worst"] = [{"x": i % columns * SIDE, "y": i // columns * SIDE, "weir": a[i][3], "cycles": b[i][3]} for i in worst]
    luminance, tile = result["mean"]["luminance"], result["tiles"]["luminance"]
    result["bounds"] = {"mean": MEAN_BOUND, "tile": TILE_BOUND, "share_of_tiles": TILE_SHARE}
    result["met"] = (abs(luminance["relative_difference"]) <= MEAN_BOUND and tile["mean_absolute"] <= MEAN_BOUND and
                     tile["share_within_1_percent"] >= TILE_SHARE)
    alone = result["tiles"]["noise_alone"]
    # Whether two renderers without any difference would have failed.
    hopeless = not result["met"] and (alone["mean_absolute"] > MEAN_BOUND or alone["p95"] > TILE_BOUND)
    result["verdict"] = "met" if result["met"] else "undecided: noise alone is above the bounds, render more" if hopeless else "not met"
    return result
