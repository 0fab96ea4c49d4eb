#!/usr/bin/env python3
"""Checks the structure of a glTF 2.0 binary file: container, buffers, accessors, meshes.

usage: check_glb.py FILE.glb        exit 0 good, 1 found something, 2 could not run
Prints one JSON object: vertices and triangles, extents, and the findings, each a code and a text.
"""

import json
import struct
import sys

import numpy as np

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
JSON_CHUNK, BIN_CHUNK = 0x4E4F534A, 0x004E4942
TRIANGLES = 4


class Broken(Exception):
    """The file cannot be read any further."""


class Checker:
    """One file's findings."""

    def __init__(self, data):
        self.data, self.findings = data, []
        self.document, self.binary = {}, b""
        self.vertices, self.triangles, self.extents = 0, 0, None

    def find(self, holds, code, text):
        """Notes a finding unless `holds`."""
        if not holds:
            self.findings.append({"code": code, "text": text})
        return holds

    def need(self, holds, code, text):
        """A finding that ends the check."""
        if not self.find(holds, code, text):
            raise Broken

    def run(self):
        """Everything, as far as the file allows."""
        try:
            self.container()
            self.views()
            for mesh in self.document.get("meshes", []):
                for primitive in mesh.get("primitives", []):
                    self.primitive(primitive)
            self.scene()
        except Broken:
            pass
        return self

    def container(self):
        """Header and chunks."""
        self.need(len(self.data) >= 20, "truncated", f"{len(self.data)} bytes, a glb has at least 20")
        magic, version, length = struct.unpack_from("<4sII", self.data)
        self.need(magic == b"glTF" and version == 2, "magic", f"magic {magic!r}, version {version}")
        self.need(length == len(self.data), "length", f"header says {length} bytes, the file has {len(self.data)}")
        at, chunks = 12, []
        while at < length:
            self.need(at + 8 <= length, "chunk", f"chunk header cut at byte {at}")
            size, kind = struct.unpack_from("<II", self.data, at)
            self.need(size % 4 == 0 and at + 8 + size <= length, "chunk", f"chunk at {at} of {size} bytes")
            chunks.append((kind, self.data[at + 8 : at + 8 + size]))
            at += 8 + size
        self.need(chunks[0][0] == JSON_CHUNK, "chunk", "the first chunk is not JSON")
        try:
            self.document = json.loads(chunks[0][1].decode("utf-8"))
        except ValueError as error:
            self.need(False, "json", str(error))
        self.find(self.document.get("asset", {}).get("version") == "2.0", "asset", "asset.version is not 2.0")
        if len(chunks) > 1 and chunks[1][0] == BIN_CHUNK:
            self.binary = chunks[1][1]
        for used in self.document.get("extensionsRequired", []):
            self.find(used in self.document.get("extensionsUsed", []), "extension", f"{used} required but not used")

    def views(self):
        """Buffers and their views."""
        buffers = self.document.get("buffers", [])
        self.need(len(buffers) == 1 and "uri" not in buffers[0], "buffer", "exactly one buffer, in the file, is expected")
        size = buffers[0]["byteLength"]
        self.need(0 <= len(self.binary) - size < 4, "buffer", f"buffer of {size} bytes, chunk of {len(self.binary)}")
        for k, view in enumerate(self.document.get("bufferViews", [])):
            begin, length = view.get("byteOffset", 0), view["byteLength"]
            inside = view.get("buffer") == 0 and begin >= 0 and 0 < length <= size - begin
            self.need(inside, "view", f"bufferView {k}: {length} bytes at {begin} of {size}")

    def accessor(self, index):
        """An accessor's values, (count, width)."""
        accessors = self.document.get("accessors", [])
        self.need(isinstance(index, int) and 0 <= index < len(accessors), "accessor", f"no accessor {index}")
        accessor = accessors[index]
        dtype, width = np.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        view = self.document["bufferViews"][accessor["bufferView"]]
        offset, count = accessor.get("byteOffset", 0), accessor["count"]
        stride = view.get("byteStride", dtype.itemsize * width)
        begin = view.get("byteOffset", 0) + offset
        self.find(begin % dtype.itemsize == 0 and stride % dtype.itemsize == 0, "alignment", f"accessor {index} is misaligned")
        end = offset + stride * (count - 1) + dtype.itemsize * width
        self.need(count > 0 and end <= view["byteLength"], "accessor", f"accessor {index} ends at {end} of its view's {view['byteLength']}")
        values = np.ndarray((count, width), dtype, self.binary, begin, (stride, dtype.itemsize))
        self.find(bool(np.isfinite(values).all()), "value", f"accessor {index} holds a value that is not finite")
        for key, found in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
            if key in accessor:
                same = np.array_equal(np.array(accessor[key], dtype), found)
                self.find(same, "extent", f"accessor {index}: {key} says {accessor[key]}, the values {found.tolist()}")
        return values

    def primitive(self, primitive):
        """One set of triangles."""
        self.find(primitive.get("mode", TRIANGLES) == TRIANGLES, "mode", "not a triangle list")
        attributes = primitive.get("attributes", {})
        self.need("POSITION" in attributes, "position", "a primitive without POSITION")
        accessor = self.document["accessors"][attributes["POSITION"]]
        self.find("min" in accessor and "max" in accessor, "extent", "POSITION needs min and max")
        self.find(accessor["componentType"] == 5126 and accessor["type"] == "VEC3", "position", "POSITION is not float VEC3")
        position = self.accessor(attributes["POSITION"])
        for name, index in attributes.items():
            values = self.accessor(index)
            self.find(len(values) == len(position), "count", f"{name} has {len(values)} values for {len(position)} vertices")
            if name == "NORMAL":
                length = np.linalg.norm(values.astype(np.float64), axis=1)
                self.find(bool((np.abs(length - 1) < 1e-4).all()), "normal", "a NORMAL is not of unit length")
        if "indices" in primitive:
            indices = self.accessor(primitive["indices"])[:, 0]
            self.need(int(indices.max()) < len(position), "index", f"index {indices.max()} of {len(position)} vertices")
        else:
            indices = np.arange(len(position))
        self.need(len(indices) % 3 == 0, "index", f"{len(indices)} indices, not a multiple of 3")
        corners = indices.reshape(-1, 3).astype(np.int64)
        twice = (corners == np.roll(corners, 1, axis=1)).any(axis=1)
        self.find(not twice.any(), "degenerate", f"{twice.sum()} triangles name a vertex twice")
        self.vertices += len(position)
        self.triangles += len(corners)
        low, high = position.min(axis=0).tolist(), position.max(axis=0).tolist()
        if self.extents:
            low, high = np.minimum(low, self.extents[0]).tolist(), np.maximum(high, self.extents[1]).tolist()
        self.extents = (low, high)

    def scene(self):
        """A scene that shows a mesh."""
        self.find(self.triangles > 0, "empty", "no triangles")
        nodes, meshes = self.document.get("nodes", []), self.document.get("meshes", [])
        for k, node in enumerate(nodes):
            self.find("mesh" not in node or 0 <= node["mesh"] < len(meshes), "node", f"node {k}: no mesh {node.get('mesh')}")
        scenes = self.document.get("scenes", [])
        shown = [n for scene in scenes for n in scene.get("nodes", [])]
        self.find(bool(shown) and all(0 <= n < len(nodes) for n in shown), "scene", "no scene shows a node that exists")

    def report(self):
        """What is printed."""
        return {"vertices": self.vertices, "triangles": self.triangles, "extents": self.extents,
                "findings": self.findings}


def main():
    """Checks the file that the command line names."""
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__.strip())
        sys.exit(0 if sys.argv[1:] in (["-h"], ["--help"]) else 2)
    try:
        with open(sys.argv[1], "rb") as file:
            checker = Checker(file.read())
    except OSError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
    try:
        checker.run()
    except (KeyError, TypeError, IndexError) as error:
        checker.find(False, "json", f"a property is missing or of the wrong kind: {error!r}")
    print(json.dumps(checker.report()))
    sys.exit(1 if checker.findings else 0)


if __name__ == "__main__":
    main()
