"""Writes pictures with nothing but Python: uncompressed float EXR (the format's specification, "OpenEXR File Layout") and
8-bit PNG (RFC 2083). A picture is a list of rows of (r, g, b)."""
import struct
import zlib


def write_exr(path, picture):
    height, width = len(picture), len(picture[0])

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    channels = b"".join(c + b"\0" + struct.pack("<iBBBBii", 2, 0, 0, 0, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", 20000630, 2)
    header += attribute("channels", "chlist", channels) + attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    line = 12 * width
    first = len(header) + 8 * height
    table = b"".join(struct.pack("<Q", first + y * (8 + line)) for y in range(height))
    body = b"".join(struct.pack("<ii", y, line) + b"".join(struct.pack(f"<{width}f", *(p[c] for p in row))
                                                            for c in (2, 1, 0)) for y, row in enumerate(picture))
    with open(path, "wb") as file:
        file.write(header + table + body)


def write_png(path, picture):
    """`picture`: whole numbers 0 … 255."""
    height, width = len(picture), len(picture[0])

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(v for p in row for v in p) for row in picture)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
