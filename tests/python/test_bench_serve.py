"""The rules by which `bench_serve` judges, on figures that are known."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

from bench_serve import MAY_GROW_BYTES, MAY_GROW_THREADS, figures, growth  # noqa: E402
from bench_serve_page import markdown  # noqa: E402

HELD = {"resident_bytes": 100 << 20, "descriptors": 12, "threads": 9}


class Rules(unittest.TestCase):
    """Figures and verdicts."""

    def test_growth_is_found(self):
        self.assertEqual(growth(HELD, HELD), [])
        more = {"resident_bytes": MAY_GROW_BYTES, "descriptors": 0, "threads": MAY_GROW_THREADS}
        self.assertEqual(growth(HELD, {name: HELD[name] + more[name] for name in HELD}), [])
        for name in HELD:
            grown = growth(HELD, {**HELD, name: HELD[name] + more[name] + 1})
            self.assertEqual(len(grown), 1)
            self.assertIn(name, grown[0])

    def test_figures_are_of_all_viewers(self):
        viewers = [{"pictures": 10, "bytes": 100, "tiles": 3, "latency_ms": list(range(1, 51))},
                   {"pictures": 20, "bytes": 300, "tiles": 4, "latency_ms": list(range(51, 101))}]
        found = figures({"seconds": 2, "viewers": viewers})
        self.assertEqual((found["frames_s"], found["fairness"], found["tiles"], found["bytes_s"]), (15, 0.5, 4, 200))
        self.assertEqual(found["latency_ms"], {"p50": 51, "p95": 96, "p99": 100})
        nobody = figures({"seconds": 2, "viewers": [{"pictures": 0, "bytes": 0, "tiles": 0, "latency_ms": []}]})
        self.assertEqual((nobody["frames_s"], nobody["fairness"], nobody["latency_ms"]["p99"]), (0, None, None))

    def test_the_page_says_what_failed(self):
        machine = {"date": "d", "cpu": "c", "cores": 2, "memory_gib": 4, "system": "s", "rustc": "r", "relief": "b"}
        report = {"machine": machine, "file": {"name": "f", "bytes": 1}, "settings": {"seconds": 1, "warm_s": 1},
                  "sections": {"viewers": {"error": "why"},
                               "memory": [{"backend": "cpu", "idle_bytes": 1, "rows": [
                                   {"viewers": 1, "resident_bytes": 1, "tiles": 2},
                                   {"viewers": 4, "resident_bytes": 9, "tiles": 2, "added_share": 0.5}]}],
                               "churn": {"minutes": 1, "attached": 5, "before": HELD, "after": HELD, "grew": ["threads 1 -> 9"]}}}
        page = markdown(report)
        for part in ("not measured", "why", "50.00% | missed", "grew: threads 1 -> 9"):
            self.assertIn(part, page)


if __name__ == "__main__":
    unittest.main()
