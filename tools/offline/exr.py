"""Reads R, G, B of a scan-line OpenEXR file (uncompressed or ZIP; half or float) without any library, and writes small PNGs. What is read
here is read with none of Weir's code and none of Blender's."""
import array
import math
import struct
import sys
import zlib

BYTES = {1: 2, 2: 4}  # pixel type: half, float


class Picture:
    """`rgb`: three arrays of width * height doubles, row 0 at the top."""

    def __init__(self, width, height, rgb): self.width, self.height, self.rgb = width, height, rgb

    @staticmethod
    def mean(pictures):
        first = pictures[0]
        for p in pictures:
            if (p.width, p.height) != (first.width, first.height):
                raise ValueError("pictures of %dx%d and %dx%d pixels" % (first.width, first.height, p.width, p.height))
        return Picture(first.width, first.height, [array.array("d", (sum(v) / len(pictures) for v in zip(*(p.rgb[c] for p in pictures))))
                                                   for c in range(3)])


def attributes(data):
    if data[:4] != b"\x76\x2f\x31\x01": raise ValueError("not an OpenEXR file")
    if data[5] & 0x1a: raise ValueError("tiled, deep and multi-part files are not read")
    at, found = 8, {}
    def text():
        nonlocal at
        end = data.index(0, at)
        word, at = data[at:end].decode(), end + 1
        return word
    while data[at]:
        name, _ = text(), text()
        size, = struct.unpack_from("<i", data, at)
        found[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return found, at + 1


def channels(block):
    at, found = 0, []
    while block[at]:
        end = block.index(0, at)
        kind, _, x, y = struct.unpack_from("<iB3xii", block, end + 1)
        if kind not in BYTES or (x, y) != (1, 1): raise ValueError("channels must be half or float at full resolution")
        found.append((block[at:end].decode(), kind))
        at = end + 17
    return found


def unzipped(packed, size):
    """A ZIP block: bytes are differences, the even ones of the data first."""
    if len(packed) == size: return packed
    raw = bytearray(zlib.decompress(packed))
    for i in range(1, len(raw)): raw[i] = (raw[i - 1] + raw[i] - 128) & 255
    out = bytearray(size)
    out[0::2], out[1::2] = raw[:(size + 1) // 2], raw[(size + 1) // 2:]
    return bytes(out)


def read(path):
    with open(path, "rb") as file: data = file.read()
    found, at = attributes(data)
    x0, y0, x1, y1 = struct.unpack("<4i", found["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    compression = found["compression"][0]
    if compression not in (0, 2, 3): raise ValueError("%s: only ZIP and uncompressed files are read" % path)
    rows, layout = 16 if compression == 3 else 1, channels(found["channels"])
    line = width * sum(BYTES[kind] for _, kind in layout)
    names = [name for name, _ in layout]
    # Blender writes the one layer of a picture without a prefix.
    if any(c not in names for c in "RGB"): raise ValueError("%s has the channels %s, not R, G and B" % (path, ", ".join(names)))
    rgb = [array.array("d", bytes(8 * width * height)) for _ in range(3)]
    for offset in struct.unpack_from("<%dQ" % ((height + rows - 1) // rows), data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        count = min(rows, y1 + 1 - y)
        block = data[offset + 8:offset + 8 + size]
        if compression: block = unzipped(block, count * line)
        place = 0
        for row in range(y - y0, y - y0 + count):
            for name, kind in layout:
                if name in "RGB" and len(name) == 1:
                    values = struct.unpack_from("<%d%s" % (width, "e" if kind == 1 else "f"), block, place)
                    rgb["RGB".index(name)][row * width:(row + 1) * width] = array.array("d", values)
                place += width * BYTES[kind]
    for plane in rgb:
        if not all(map(math.isfinite, plane)): raise ValueError("%s has pixels that are not finite" % path)
    return Picture(width, height, rgb)


def write_png(path, width, height, texel):
    """8-bit RGB; texel(x, y) gives three numbers of 0 … 1 as a screen shows them."""
    def line(y): return b"\0" + bytes(min(255, max(0, int(v * 255 + 0.5))) for x in range(width) for v in texel(x, y))
    def chunk(kind, data): return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        out.write(chunk(b"IDAT", zlib.compress(b"".join(map(line, range(height))), 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    p = read(sys.argv[1])
    print("%dx%d, mean %s" % (p.width, p.height, [sum(c) / len(c) for c in p.rgb]))
