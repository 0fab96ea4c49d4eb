"""The benchmark's page says met, missed and not measured as the figures do."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

import bench_bake  # noqa: E402  the path above leads to it


def report(**sections):
    """A report with these sections."""
    machine = {key: "x" for key in ("date", "cpu", "cores", "memory_gib", "system", "gdal", "rustc", "relief")}
    return {"machine": machine, "planet": "Moon", "runs": 3, "note": "", "sections": sections}


class Page(unittest.TestCase):
    """The rows of the table."""

    @staticmethod
    def row(page, start):
        """The one row that starts so."""
        (found,) = [line for line in page.splitlines() if line.startswith(f"| {start}")]
        return found

    def test_an_aim_is_met_or_missed(self):
        for relief_s, word in ((6.9, "met"), (7.1, "missed")):
            wall = {"m": 13, "relief": [{"wall_s": relief_s}], "peer": [{"wall_s": 10.0}], "ratio": relief_s / 10}
            row = self.row(bench_bake.markdown(report(wall=wall)), "wall time")
            self.assertTrue(row.endswith(f"| 0.7 | {word} |"), row)

    def test_a_section_that_failed_is_named(self):
        page = bench_bake.markdown(report(decode={"error": "no decoder"},
                                          lossless={"files": [], "skipped": [{"source": "a.tif", "why": "b"}], "ratio": None}))
        self.assertIn("- decode: no decoder", page)
        self.assertIn("- a.tif: b", page)
        self.assertNotIn("met", page.split("Not measured")[0].split("|---")[1])

    def test_medians_and_means(self):
        self.assertAlmostEqual(bench_bake.geometric_mean([0.25, 1.0]), 0.5)
        self.assertIsNone(bench_bake.geometric_mean([]))
        self.assertEqual(bench_bake.median([{"s": 9.0}, {"s": 1.0}, {"s": 2.0}], "s"), 2.0)

    def test_a_command_that_fails_says_why(self):
        with self.assertRaisesRegex(bench_bake.Failed, "no such thing"):
            bench_bake.run(sys.executable, "-c", "import sys; sys.exit('no such thing')")
        measured = bench_bake.run(sys.executable, "-c", "print(bytearray(50_000_000)[0])")
        self.assertEqual(measured["output"].strip(), "0")
        self.assertGreater(measured["peak_bytes"], 50_000_000)


if __name__ == "__main__":
    unittest.main()
