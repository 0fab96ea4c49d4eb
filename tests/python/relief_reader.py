#!/usr/bin/env python3
"""A second reader of .relief files, small and slow, written from formats/SPEC.md alone.

usage: relief_reader.py FILE                  what the file is
       relief_reader.py FILE --samples        a line for each plane, mesh and height: see `samples`
       relief_reader.py FILE --dump OUTDIR    every plane of every tile as .npy
       relief_reader.py FILE --height LON LAT (X Y on a plane)

exit: 0 good, 1 the file is not good, 2 wrong arguments
"""

import argparse
import json
import mmap
import os
import struct
import sys
from fractions import Fraction

import numpy as np

import relief_planes as planes
from blake3_numpy import blake3
from relief_deviations import deviation
from relief_stream import HALF, LIMIT, Damaged, need, unpack

SIGNATURE = b"\x89RLF\r\n\x1a\n"
PLANES = ["nodes", "mip", "hext", "deviation", "filled"]


class Relief:
    """An open file: header, sections and metadata are checked here, tiles when they are read."""

    def __init__(self, path):
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            self.data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) if size else b""
        self._header(self.data[:256])
        need(len(self.data) == self.file_bytes, "the file is not as long as its header says")
        tail = SIGNATURE[::-1] + struct.pack("<Q", self.file_bytes) + self.data[224:256] + bytes(16)
        need(self.data[-64:] == tail, "the tail does not match")
        self._sections()
        self._metadata()
        self.cache = {}

    def _header(self, h):
        need(len(h) == 256 and h[:8] == SIGNATURE, "not a .relief file")
        major, minor, header_bytes, required, optional = struct.unpack_from("<HHIQQ", h, 8)
        need(major == 1, f"major version {major}")
        need(blake3(h[:224]) == h[224:], "the header's hash does not match")
        need(required == 0, "a required feature is not known")
        body, self.m, self.root, self.exponent = struct.unpack_from("<BBBb", h, 32)
        a, b, self.south_q, self.north_q, self.min_q, self.max_q = struct.unpack_from("<ddiiii", h, 40)
        self.tile_count, self.file_bytes, table, self.section_count = struct.unpack_from("<QQQI", h, 72)
        self.content_id = h[104:136]
        origin = struct.unpack_from("<4d", h, 136)
        need(body in (0, 1), "a body that is not known")
        self.plane = body == 1
        self.numbers = dict(zip(("x0", "y0", "dx", "dy"), origin)) if self.plane else {"a_m": a, "b_m": b}
        positive = origin[2:] if self.plane else (a, b)
        need(np.isfinite(list(self.numbers.values())).all() and min(positive) > 0, "the body's numbers")
        other = h[40:56] if self.plane else h[136:168]
        later = [h[100:104], h[200:224], struct.pack("<Q", optional)]
        need(not any(other) and not any(h[36:40]), "a reserved field is not 0")
        need(minor > 0 or not any(map(any, later)), "a field of a later version is not 0")
        need(8 <= self.m <= 20 and self.root == self.m - 8 and -16 <= self.exponent <= 10, "m or the step")
        need(header_bytes == 256 and table == 256 and self.section_count <= 256, "the header's sizes")
        samples = (self.south_q, self.north_q, self.min_q, self.max_q)
        need(max(map(abs, samples)) <= LIMIT and self.min_q <= self.max_q, "the header's heights")
        self.height = 1 << self.m
        self.width = self.height if self.plane else 2 * self.height

    def _sections(self):
        end = 256 + 64 * self.section_count
        need(end + 64 <= len(self.data), "no room for the section table")
        need(blake3(self.data[256:end]) == self.data[168:200], "the section table's hash does not match")
        self.sections = {}
        for at in range(256, 256 + 64 * self.section_count, 64):
            kind, flags, offset, length = struct.unpack_from("<4sIQQ", self.data, at)
            need(offset % 64 == 0 and end <= offset and offset + length <= len(self.data) - 64, "a section's place")
            need(kind in (b"META", b"MESH", b"INDX", b"TILE") or not flags & 1, f"section {kind} is not known")
            end = offset + length
            self.sections.setdefault(kind, (offset, length, self.data[at + 32:at + 64]))
        need({b"META", b"MESH", b"INDX", b"TILE"} <= set(self.sections), "a section is missing")
        need(self.sections[b"INDX"][1] == 128 * self.tile_count, "the index's length")

    def section(self, kind):
        """A section's bytes, checked."""
        offset, length, digest = self.sections[kind]
        data = self.data[offset:offset + length]
        need(blake3(data) == digest, f"the hash of section {kind} does not match")
        return data

    def _metadata(self):
        need(self.sections[b"META"][1] <= 16 << 20, "the metadata are too large")
        try:
            self.metadata = json.loads(self.section(b"META"))
            body = self.metadata["body"]
            numbers = {key: float(body[key]) for key in self.numbers}
            kind = body["kind"]
        except (ValueError, KeyError, TypeError) as error:
            raise Damaged(f"metadata: {error!r}") from error
        need(kind == ("plane" if self.plane else "ellipsoid") and numbers == self.numbers, "the metadata's body")

    def tiles(self, level):
        """Columns and rows of tiles of a level."""
        return self.width >> level >> 8, self.height >> level >> 8

    def find(self, level, x, y):
        """(offset, lengths, digests) of a tile, or None when it is absent."""
        start, length, _ = self.sections[b"INDX"]
        wanted = sort_key(level, x, y)
        low, high = 0, length // 128
        while low < high:
            middle = (low + high) // 2
            entry = self.data[start + 128 * middle:start + 128 * middle + 128]
            need(blake3(entry[:44] + bytes(4) + entry[48:])[:4] == entry[44:48], "an index entry's checksum")
            key, offset, *lengths = struct.unpack_from("<QQ5I", entry)
            if key == wanted:
                need(offset + sum(lengths) <= self.sections[b"TILE"][1], "a tile lies outside its section")
                digests = [entry[k:k + 16] for k in range(48, 128, 16)]
                return offset + self.sections[b"TILE"][0], lengths, digests
            low, high = (middle + 1, high) if key < wanted else (low, middle)
        need(level < self.root, "a tile of the root level is missing")
        return None

    def read(self, plane, level, x, y):
        """A plane of a tile; None for the deviations of an absent one."""
        if plane == "mip" and level == 0:
            plane = "nodes"
        key = (plane, level, x, y)
        if key not in self.cache:
            self.cache[key] = self._decode(*key)
        return self.cache[key]

    def _quarter(self, plane, level, x, y):
        parent = self.read(plane, level + 1, x // 2, y // 2)
        column, row = HALF * (x % 2), HALF * (y % 2)
        return parent[row:row + HALF + 1, column:column + HALF + 1]

    def _decode(self, plane, level, x, y):
        entry = self.find(level, x, y)
        if entry is None:
            return self._absent(plane, level, x, y)
        offset, lengths, digests = entry
        n = PLANES.index(plane)
        offset += sum(lengths[:n])
        data = self.data[offset:offset + lengths[n]]
        below = level < self.root
        if plane == "nodes" and not below:
            samples = planes.nodes_of_root(data)
        elif plane == "nodes":
            mean = self._quarter("mip", level, x, y) if level == 0 else None
            samples = planes.nodes(data, self._quarter("nodes", level, x, y), mean)
        elif plane == "mip":
            mean = self._quarter("mip", level, x, y) if below else None
            samples = planes.mip(data, self.read("nodes", level, x, y), mean)
        elif plane == "filled":
            samples = planes.filled(data)
        elif plane == "deviation":
            samples = deviation(data, self.read("nodes", level, x, y), not below)
        else:
            samples = getattr(planes, plane)(data, self.read("nodes", level, x, y))
        need(digest(samples) == digests[n], f"{plane} of level {level} tile ({x}, {y}): another digest")
        return samples

    def _absent(self, plane, level, x, y):
        if plane in ("nodes", "mip"):
            return planes.interpolate(self._quarter(plane, level, x, y))
        if plane == "hext":
            return planes.block_extremes(self.read("nodes", level, x, y))
        return planes.filled_absent(self._quarter(plane, level, x, y)) if plane == "filled" else None

    def height_q(self, u, v):
        """S_0 in steps at u columns and v rows from node (0, 0); exact for fractions."""
        i, j = min(int(u // 1), self.width - 1), min(int(v // 1), self.height - 1)
        f, g = u - i, v - j
        tile = self.read("nodes", 0, i >> 8, j >> 8)
        c, r = i & 255, j & 255
        q = [[int(tile[r + b, c + a]) for a in range(2)] for b in range(2)]
        return (1 - g) * ((1 - f) * q[0][0] + f * q[0][1]) + g * ((1 - f) * q[1][0] + f * q[1][1])

    def height_m(self, lon, lat):
        """Metres at degrees, or at coordinates of a plane."""
        if self.plane:
            b = self.numbers
            u, v = (lon - b["x0"]) / b["dx"], (lat - b["y0"]) / b["dy"]
            if not 0 <= u <= self.width:
                raise ValueError("X lies outside the plane")
        else:
            u, v = self.width * (lon + 180) / 360 % self.width, self.height * (lat + 90) / 180
        if not 0 <= v <= self.height:
            raise ValueError("the latitude or Y lies outside the map")
        return self.height_q(u, v) * 2.0 ** self.exponent

    def mesh(self):
        """The patch mesh: (layout, s_axis, t_axis, triangles), section 9."""
        data = unpack(self.section(b"MESH"), 1 << 20)
        need(len(data) >= 24, "mesh: no header")
        layout, m, columns, rows, count, reserved = struct.unpack_from("<6I", data)
        need(layout < 2 and m == self.m and reserved == 0, "mesh: a field is out of range")
        need(1 <= columns <= 65535 and 1 <= rows <= 65535, "mesh: columns or rows")
        vertices = (columns + 1) * (rows + 1)
        start = 24 + 4 * (columns + rows + 2)
        need(count % 3 == 0 and count >= vertices and len(data) >= start + count, "mesh: index_count")
        axes = np.frombuffer(data[24:start], "<u4")
        indices, stream = [], iter(data[start:])
        for k in range(count):
            u = shift = 0
            while True:
                byte = next(stream, None)
                need(byte is not None and shift < 35 and (byte or not shift), "mesh: a coded index")
                u |= (byte & 127) << shift
                shift += 7
                if byte < 128:
                    break
            last = indices[k - 6] if k >= 6 else 0
            index = last + (u // 2 if u % 2 == 0 else -(u + 1) // 2)
            need(0 <= index < vertices, "mesh: an index names no vertex")
            indices.append(index)
        need(next(stream, None) is None, "mesh: bytes left over")
        return layout, axes[:columns + 1], axes[columns + 1:], np.array(indices, "<u4").reshape(-1, 3)

    def all_tiles(self):
        """Keys of all tiles, present or absent, in the order of the index."""
        keys = [(level, x, y) for level in range(self.root, -1, -1)
                for y in range(self.tiles(level)[1]) for x in range(self.tiles(level)[0])]
        return sorted(keys, key=lambda key: sort_key(*key))

    def check_whole(self):
        """The hash of every section, the zeros between them and the content id."""
        end = 256 + 64 * self.section_count
        for kind, (offset, length, _) in sorted(self.sections.items(), key=lambda item: item[1][0]):
            self.section(kind)
            need(not any(self.data[end:offset]), "bytes between sections are not 0")
            end = offset + length
        need(not any(self.data[end:-64]), "bytes before the tail are not 0")
        index = self.section(b"INDX")
        entries = [index[k:k + 8] + index[k + 48:k + 128] for k in range(0, len(index), 128)]
        content = b"relief content 1" + self.data[32:72] + self.data[136:168] + b"".join(entries)
        need(blake3(content) == self.content_id, "the content id is not that of the tiles")


def sort_key(level, x, y):
    """A tile's place in the index (section 2)."""
    morton = sum((x >> k & 1) << 2 * k | (y >> k & 1) << (2 * k + 1) for k in range(13))
    return (31 - level) << 56 | morton


def digest(samples):
    """The digest of decoded samples (section 4.3)."""
    if samples.dtype == bool:
        data = np.packbits(samples.ravel(), bitorder="little").tobytes()
    elif samples.dtype == np.uint8:
        data = samples.tobytes()
    else:
        data = samples.astype("<i4").tobytes()
    return blake3(data)[:16]


def sample_points(relief):
    """Fixed-point (S, T) at which heights are compared: corners of the map, then scattered."""
    far = 1 << 31
    limit = far + 1 if relief.plane else 1 << 32
    points = [(0, 0), (limit - 1, far), (limit // 2, far // 2), (1, far - 1)]
    return points + [(k * 2654435761 % limit, k * 1640531527 % (far + 1)) for k in range(1, 61)]


def samples(relief):
    """The lines that any two readers must agree on."""
    relief.check_whole()
    yield f"content_id {relief.content_id.hex()}"
    layout, s_axis, t_axis, triangles = relief.mesh()
    words = np.concatenate([[layout], s_axis, t_axis, triangles.ravel()]).astype("<u4")
    yield f"mesh {blake3(words.tobytes())[:16].hex()}"
    for level, x, y in relief.all_tiles():
        for plane in PLANES:
            plane_samples = relief.read(plane, level, x, y)
            if plane_samples is not None:
                yield f"{plane} {level} {x} {y} {digest(plane_samples).hex()}"
    for s, t in sample_points(relief):
        unit = 1 << (31 - relief.m)
        q = relief.height_q(Fraction(s, unit), Fraction(t, unit)) * unit * unit
        yield f"height {s} {t} {q}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--samples", action="store_true")
    parser.add_argument("--dump", metavar="OUTDIR")
    parser.add_argument("--height", nargs=2, type=float, metavar=("LON", "LAT"))
    arguments = parser.parse_args()
    try:
        relief = Relief(arguments.file)
        if arguments.samples:
            for line in samples(relief):
                print(line)
        elif arguments.dump:
            os.makedirs(arguments.dump, exist_ok=True)
            for level, x, y in relief.all_tiles():
                for plane in PLANES:
                    plane_samples = relief.read(plane, level, x, y)
                    if plane_samples is not None:
                        np.save(os.path.join(arguments.dump, f"{plane}_{level}_{x}_{y}.npy"), plane_samples)
        elif arguments.height:
            print(relief.height_m(*arguments.height))
        else:
            print(json.dumps({"m": relief.m, "step_m": 2.0 ** relief.exponent, "tiles": relief.tile_count,
                              "content_id": relief.content_id.hex(), "metadata": relief.metadata}, indent=2))
    except (Damaged, OSError, ValueError) as error:
        print(f"{arguments.file}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
