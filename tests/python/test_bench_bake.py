"""The benchmark's page says met, missed and not measured as the figures do."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

import bench_commands  # noqa: E402  the path above leads to them
import bench_page  # noqa: E402


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
            row = self.row(bench_page.markdown(report(wall=wall)), "wall time")
            self.assertTrue(row.endswith(f"| 0.7 | {word} |"), row)

    def test_a_section_that_failed_is_named(self):
        page = bench_page.markdown(report(decode={"error": "no decoder"},
                                          lossless={"files": [], "skipped": [{"source": "a.tif", "why": "b"}], "ratio": None}))
        self.assertIn("- decode: no decoder", page)
        self.assertIn("- a.tif: b", page)
        self.assertNotIn("met", page.split("Not measured")[0].split("|---")[1])

    def test_medians_and_means(self):
        self.assertAlmostEqual(bench_page.geometric_mean([0.25, 1.0]), 0.5)
        self.assertIsNone(bench_page.geometric_mean([]))
        self.assertEqual(bench_page.median([{"s": 9.0}, {"s": 1.0}, {"s": 2.0}], "s"), 2.0)

    def test_a_command_that_fails_says_why(self):
        with self.assertRaisesRegex(bench_commands.Failed, "no such thing"):
            bench_commands.run(sys.executable, "-c", "import sys; sys.exit('no such thing')")

    def test_peak_memory_is_the_command_s_own(self):
        ballast = bytearray(300_000_000)
        measured = bench_commands.run(sys.executable, "-c", "b = bytearray(50_000_000); import time; time.sleep(0.2); print(b[0])")
        self.assertEqual(measured["output"].strip(), "0")
        self.assertGreater(measured["peak_bytes"], 50_000_000)
        self.assertLess(measured["peak_bytes"], len(ballast))


if __name__ == "__main__":
    unittest.main()
