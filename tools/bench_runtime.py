#!/usr/bin/env python3
"""Measures the runtime, beside its peers in the same run, and writes what it found.

Sections (all by default, or those named with --only):
  shadows    all nodes of a 2048 x 2048 plane under four suns, on the CPU: the sweep and single
             rays, fetches a ray with fewer and with no bounds; Embree (PyPI embreex) beside them
  triangles  bisection against Delatin (PyPI pydelatin) at the same bound
  frame      a Full HD frame from 400 km at m = 13: passes, triangles, fetches, on each backend
  first      from opening a file to its first frame, m = 8 against m = 15

Wants relief-bake, the examples of relief-formats, relief-shaders and relief-runtime, and gdal and
numpy for Python; `just bench-runtime` builds them. The Moon (LOLA, 16 px/deg) and the peers come
by pip; what cannot be had is left out, and the results say so.
"""

import argparse
import json
import os
import pathlib
import sys
import tempfile

import numpy as np
from osgeo import gdal

from bench_commands import BAKE, DATA, MOON_CRS, ROOT, TARGET, Failed, bake, fetch_moon, machine, run
from bench_report import failed, measured, write
from bench_runtime_page import markdown

EXAMPLES = TARGET / "examples"
TOOLS = ROOT / "tools"
SIDE = 2048
SUNS_DEG = (2, 5, 10, 20)
AZIMUTH_DEG = 135
BOUNDS_M = (2, 5, 10, 20)
PEERS = ("embreex", "pydelatin")


class Bench:
    """One run's settings and what it found."""

    def __init__(self, args, folder):
        self.args, self.folder = args, folder
        self.peers = folder / "peers"
        self._moon = None

    def with_peers(self, *command):
        """Runs a Python script that imports a peer, returns what it printed and its peak memory."""
        if not self.peers.is_dir():
            run(*self.args.pip.split(), "install", "-q", "--no-deps", "--target", self.peers, *PEERS)
        os.environ["PYTHONPATH"] = str(self.peers)
        found = run(sys.executable, *command)
        return json.loads(found["output"]), found["peak_bytes"]

    def plane(self, name, size, window=None):
        """A plane of the Sierra Nevada, `size` nodes a side, and its heights."""
        tif, file = self.folder / f"{name}.tif", self.folder / f"{name}.relief"
        source = DATA / "sierra_albers_30m.tif"
        if window:
            run("gdal_translate", "-q", "-srcwin", *window, source, tif)
        else:
            run("gdalwarp", "-q", "-overwrite", "-r", "cubic", "-ot", "Float32", "-ts", size, size, source, tif)
        bake(tif, file, "--body", "plane", "--vertical", "as-given")
        return file

    def moon(self, m):
        """The Moon at a map exponent; the Earth where LOLA cannot be had."""
        if self._moon is None:
            label = pathlib.Path(self.args.moon) if self.args.moon else fetch_moon(self.folder / "packages")
            if label is None:
                self._moon = (DATA / "earth_etopo1_6min.tif", ["--vertical", "as-given"])
            else:
                tif = self.folder / "moon16.tif"
                run("gdal_translate", "-q", "-a_srs", MOON_CRS, "-a_ullr", 0, 90, 360, -90, "-a_offset", 0,
                    "-a_scale", 0.5, "-co", "TILED=YES", label, tif)
                self._moon = (tif, [])
        source, options = self._moon
        file = self.folder / f"planet{m}.relief"
        if not file.exists():
            bake(source, file, "--m", m, *options)
        return file

    def shadows(self):
        """Shadow masks of a plane."""
        file = self.plane("shadows", SIDE)
        shown = run(EXAMPLES / "shadow_bench", file)
        found = json.loads(shown["output"])
        mask = run(TARGET / "reliefd", "mask", file, "--backend", "cpu", "--sun", f"{AZIMUTH_DEG},{SUNS_DEG[0]}",
                   "-o", self.folder / "mask.png")
        found["mask_peak_bytes"] = mask["peak_bytes"]
        nodes = self.folder / "nodes.tif"
        run(BAKE, "export", file, "-o", nodes, "--force")
        opened = gdal.Open(str(nodes))
        heights = np.ascontiguousarray(opened.ReadAsArray()[::-1].astype(np.float32))
        _, dx, _, _, _, dy = opened.GetGeoTransform()
        np.save(self.folder / "nodes.npy", heights)
        try:
            peer, peak = self.with_peers(TOOLS / "bench_embree.py", self.folder / "nodes.npy", "--spacing", dx, -dy,
                                         "--azimuth", AZIMUTH_DEG, "--suns", *SUNS_DEG)
            found["embree"] = {**peer, "peak_bytes": peak}
        except Failed as error:
            found["peer_missing"] = str(error).splitlines()[-1]
        found["dem_bytes"] = heights.nbytes
        return found

    def triangles(self):
        """Triangles at equal bounds."""
        found = []
        for name, window in (("Sierra Nevada, 30 m", (100, 100, 512, 512)),):
            file = self.plane("triangles", 512, window)
            rows, _ = self.with_peers(TOOLS / "bench_delatin.py", file, "--bake", BAKE, "--bisection",
                                      EXAMPLES / "bisection", "--bounds", *BOUNDS_M)
            found.append({"name": name, **rows})
        return found

    def frame(self):
        """Passes of a frame."""
        file = self.moon(13)
        return {backend: json.loads(run(EXAMPLES / "first_frame", file, backend)["output"].splitlines()[-1])
                for backend in ("cpu", "gpu")}

    def first(self):
        """Opening and the first frame."""
        return {str(m): [json.loads(run(EXAMPLES / "first_frame", self.moon(m), backend)["output"].splitlines()[-1])
                         for backend in ("cpu", "gpu")] for m in (8, 15)}


def main():
    """Runs the sections, writes the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=("shadows", "triangles", "frame", "first"))
    parser.add_argument("--moon", help="LDEM_16.LBL of LOLA, instead of fetching it by pip")
    parser.add_argument("--pip", default=f"{sys.executable} -m pip", help="the pip that fetches the peers")
    parser.add_argument("--out", default=str(ROOT / "BENCHMARKS-RUNTIME"), help="writes OUT.json and OUT.md")
    args = parser.parse_args()
    os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    report = {"machine": machine()}
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(args, pathlib.Path(folder))
        sections = args.only or ("shadows", "triangles", "frame", "first")
        report["sections"] = measured({name: getattr(bench, name) for name in sections})
    write(report, markdown(report), args.out)
    return 2 if any(map(failed, report["sections"].values())) else 0


if __name__ == "__main__":
    sys.exit(main())
