"""The glTF checker passes a good file and finds each kind of damage."""

import copy
import json
import struct
import unittest

import numpy as np

from check_glb import Checker

POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4")
NORMALS = np.array([[0, 0, 1]] * 4, "<f4")
INDICES = np.array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], "<u2")
DOCUMENT = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
        {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 2, "componentType": 5123, "count": 12, "type": "SCALAR"},
    ],
    "bufferViews": [
        {"buffer": 0, "byteOffset": 0, "byteLength": 48},
        {"buffer": 0, "byteOffset": 48, "byteLength": 48},
        {"buffer": 0, "byteOffset": 96, "byteLength": 24},
    ],
    "buffers": [{"byteLength": 120}],
}


def glb(document=None, positions=POSITIONS, normals=NORMALS, indices=INDICES):
    """A tetrahedron as glTF binary."""
    text = json.dumps(document or DOCUMENT).encode()
    text += b" " * (-len(text) % 4)
    binary = positions.tobytes() + normals.tobytes() + indices.tobytes()
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


class CheckGlb(unittest.TestCase):
    """Good and damaged files."""

    def codes(self, data):
        """The codes found."""
        return {finding["code"] for finding in Checker(data).run().findings}

    def changed(self, *path, to):
        """The document with one property changed."""
        document = copy.deepcopy(DOCUMENT)
        place = document
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = to
        return glb(document)

    def test_a_good_file(self):
        checker = Checker(glb()).run()
        self.assertEqual((checker.findings, checker.vertices, checker.triangles), ([], 4, 4))
        self.assertEqual(checker.extents, ([0, 0, 0], [1, 1, 1]))

    def test_the_container(self):
        good = glb()
        self.assertEqual(self.codes(good[:10]), {"truncated"})
        self.assertEqual(self.codes(b"gltf" + good[4:]), {"magic"})
        self.assertEqual(self.codes(good[:-4]), {"length"})
        self.assertEqual(self.codes(good[:20] + b"!" + good[21:]), {"json"})

    def test_the_properties(self):
        self.assertEqual(self.codes(self.changed("asset", "version", to="1.0")), {"asset"})
        self.assertEqual(self.codes(self.changed("bufferViews", 2, "byteLength", to=40)), {"view"})
        self.assertEqual(self.codes(self.changed("accessors", 2, "count", to=24)), {"accessor"})
        self.assertEqual(self.codes(self.changed("accessors", 2, "count", to=11)), {"index"})
        self.assertEqual(self.codes(self.changed("accessors", 1, "count", to=3)), {"count"})
        self.assertEqual(self.codes(self.changed("accessors", 0, "max", to=[1, 2, 1])), {"extent"})
        self.assertIn("alignment", self.codes(self.changed("bufferViews", 1, "byteOffset", to=46)))
        self.assertEqual(self.codes(self.changed("nodes", 0, "mesh", to=1)), {"node"})
        self.assertEqual(self.codes(self.changed("scenes", 0, "nodes", to=[])), {"scene"})
        self.assertEqual(self.codes(self.changed("meshes", to=[])), {"empty", "node"})

    def test_the_values(self):
        indices = INDICES.copy()
        indices[0] = 4
        self.assertEqual(self.codes(glb(indices=indices)), {"index"})
        indices[0] = 2
        self.assertEqual(self.codes(glb(indices=indices)), {"degenerate"})
        self.assertEqual(self.codes(glb(normals=NORMALS * 2)), {"normal"})
        positions = POSITIONS.copy()
        positions[3, 0] = np.nan
        self.assertIn("value", self.codes(glb(positions=positions)))


if __name__ == "__main__":
    unittest.main()
