"""The second reader agrees with the golden files, sample for sample, and refuses damaged ones."""

import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import relief_stream
from blake3_numpy import blake3
from relief_reader import Relief, digest, samples, sort_key
from relief_stream import Damaged

HERE = pathlib.Path(__file__).resolve().parent
GOLDEN = sorted((HERE.parent / "golden").glob("*/*.relief"))
SPEC = HERE.parent.parent / "formats" / "SPEC.md"


def by_name(name):
    return next(path for path in GOLDEN if path.stem == name)


class Hash(unittest.TestCase):
    def test_published_values(self):
        self.assertEqual(blake3(b"").hex(), "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262")
        self.assertEqual(blake3(b"abc").hex(), "6437b3ac38465133ffb63b75273a8db548c558465d79db03fd359c6cd5bd9d85")

    def test_a_changed_bit_in_any_chunk_changes_it(self):
        data = bytes(range(251)) * 30
        for at in (0, 63, 64, 1023, 1024, 4096, len(data) - 1):
            other = bytearray(data)
            other[at] ^= 1
            self.assertNotEqual(blake3(data), blake3(other))


class Golden(unittest.TestCase):
    def test_every_sample_agrees(self):
        self.assertGreaterEqual(len(GOLDEN), 4)
        for path in GOLDEN:
            with self.subTest(path.stem):
                expected = path.with_suffix(".txt").read_text().splitlines()
                self.assertEqual(list(samples(Relief(path))), expected)

    def test_they_hold_the_hard_cases(self):
        sparse = Relief(by_name("globe_m10_sparse"))
        self.assertIsNone(sparse.find(1, 1, 0))
        self.assertIsNone(sparse.find(0, 2, 0))
        self.assertTrue(sparse.read("filled", 0, 2, 0).any())
        self.assertEqual(abs(Relief(by_name("plane_m8")).read("nodes", 0, 0, 0)).max(), relief_stream.LIMIT)

    def test_nodes_of_the_border_agree(self):
        relief = Relief(by_name("globe_m9_sparse"))
        for level in (0, 1):
            columns, rows = relief.tiles(level)
            for y in range(rows):
                for x in range(columns):
                    here, east = [relief.read("nodes", level, k % columns, y) for k in (x, x + 1)]
                    np.testing.assert_array_equal(here[:, -1], east[:, 0])
                    if y + 1 < rows:
                        np.testing.assert_array_equal(here[-1], relief.read("nodes", level, x, y + 1)[0])

    def test_heights_at_degrees(self):
        relief = Relief(by_name("globe_m8"))
        self.assertEqual(relief.height_m(12.3, -90), relief.south_q / 16)
        self.assertEqual(relief.height_m(180, 90), relief.north_q / 16)
        west = relief.read("nodes", 0, 0, 0)
        self.assertEqual(relief.height_m(180, 0), west[128, 0] / 16)
        step = 180 / 256
        self.assertEqual(relief.height_m(-180 + 2.5 * step, 0), (west[128, 2] + west[128, 3]) / 32)
        with self.assertRaises(ValueError):
            relief.height_m(0, 90.1)


class Specification(unittest.TestCase):
    """The worked examples and tables of the text are what this reader does."""

    @classmethod
    def setUpClass(cls):
        cls.blocks = re.findall(r"```\n(.*?)```", SPEC.read_text(), re.DOTALL)

    def test_the_header(self):
        block = next(b for b in self.blocks if b.startswith("89 52 4c 46"))
        header = bytes.fromhex(block)
        self.assertEqual(len(header), 256)
        self.assertEqual(blake3(header[:224]), header[224:])
        self.assertEqual(struct.unpack_from("<BBBb", header, 32), (0, 8, 0, -4))

    def test_the_residual_stream(self):
        stream = relief_stream.Residuals(bytes.fromhex(next(b for b in self.blocks if b.startswith("0b 00 80"))))
        activity = np.array([0, 0, 1, 9, 0, 1])
        self.assertEqual(stream.take(activity).tolist(), [0, -1, 3, 40, 0, -2])
        self.assertEqual(stream.take(activity).tolist(), [0] * 6)
        stream.finish()

    def test_the_tables(self):
        rows = [row.split(":")[1].split() for row in self.blocks[-1].strip().splitlines()]
        self.assertEqual([row.split() for row in relief_stream._ROWS.strip().splitlines()], rows)


class Damage(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.good = by_name("plane_m8").read_bytes()

    def read(self, data):
        path = pathlib.Path(self.folder.name) / "damaged.relief"
        path.write_bytes(data)
        return list(samples(Relief(path)))

    def test_the_undamaged_file_is_read(self):
        self.assertTrue(self.read(self.good))

    def test_flipped_bits_are_errors(self):
        starts = [struct.unpack_from("<Q", self.good, 256 + 64 * k + 8)[0] for k in range(4)]
        places = [0, 9, 34, 60, 100, 230, 256, 300, 511, len(self.good) - 60, len(self.good) - 1]
        places += [start + at for start in starts for at in (0, 5, 47, 90)]
        for at in places + list(range(starts[3], len(self.good), 9973)):
            with self.subTest(at):
                data = bytearray(self.good)
                data[at] ^= 16
                with self.assertRaises(Damaged):
                    self.read(data)

    def test_a_damaged_key_does_not_make_a_tile_absent(self):
        data = bytearray(by_name("globe_m9_sparse").read_bytes())
        index = struct.unpack_from("<Q", data, 256 + 64 * 2 + 8)[0]
        data[index + 2 * 128] ^= 1
        path = pathlib.Path(self.folder.name) / "key.relief"
        path.write_bytes(data)
        relief = Relief(path)
        with self.assertRaises(Damaged):
            for key in relief.all_tiles():
                relief.find(*key)

    def test_cuts_are_errors(self):
        for length in (0, 7, 255, 256, 600, len(self.good) - 64, len(self.good) - 1):
            with self.subTest(length), self.assertRaises(Damaged):
                self.read(self.good[:length])

    def test_a_plane_that_decodes_to_other_samples_is_an_error(self):
        relief = Relief(by_name("plane_m8"))
        key = ("filled", 0, 0, 0)
        self.assertNotEqual(digest(relief.read(*key)), digest(~relief.read(*key)))


class Program(unittest.TestCase):
    def run_reader(self, *arguments):
        command = [sys.executable, str(HERE / "relief_reader.py"), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def test_dump_height_and_exit_codes(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(self.run_reader(by_name("plane_m8"), "--dump", folder).returncode, 0)
            nodes = np.load(pathlib.Path(folder) / "nodes_0_0_0.npy")
        self.assertEqual(nodes.shape, (257, 257))
        height = self.run_reader(by_name("plane_m8"), "--height", "-1234.5", "5000000.1")
        self.assertEqual(float(height.stdout), nodes[0, 0] * 8)
        self.assertEqual(self.run_reader(HERE / "relief_reader.py").returncode, 1)
        self.assertEqual(self.run_reader().returncode, 2)

    def test_order_of_tiles(self):
        self.assertLess(sort_key(3, 5, 5), sort_key(2, 0, 0))
        self.assertEqual(sort_key(31, 3, 1), 0b0111)


if __name__ == "__main__":
    unittest.main()
