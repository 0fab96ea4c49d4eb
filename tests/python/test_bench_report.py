"""A section that fails is told of, and stops no other."""

import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

from bench_commands import Failed  # noqa: E402  the path above leads to it
from bench_report import failed, measured, page_sections, write  # noqa: E402


def fails():
    """A section without its peer."""
    raise Failed("the command\nno peer")


class Report(unittest.TestCase):
    """What is kept of the sections, and written."""

    def setUp(self):
        quiet = contextlib.redirect_stderr(io.StringIO())
        quiet.__enter__()
        self.addCleanup(quiet.__exit__, None, None, None)

    def test_a_failed_section_is_named(self):
        found = measured({"a": fails, "b": lambda: {"x": 1}})
        self.assertEqual(found, {"a": {"error": "no peer"}, "b": {"x": 1}})
        self.assertEqual([failed(section) for section in found.values()], [True, False])
        self.assertFalse(failed([{"error": "of a row"}]))
        page = page_sections(found, {"b": lambda of: [f"x is {of['x']}"]})
        self.assertEqual(page, ["", "## a: not measured", "", "no peer", "", "x is 1"])

    def test_figures_and_page_lie_side_by_side(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "F-1.0"
            write({"a": 1}, "# F\n", out)
            self.assertEqual(json.loads(pathlib.Path(f"{out}.json").read_text()), {"a": 1})
            self.assertEqual(pathlib.Path(f"{out}.md").read_text(), "# F\n")


if __name__ == "__main__":
    unittest.main()
