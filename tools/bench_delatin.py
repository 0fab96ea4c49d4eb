#!/usr/bin/env python3
"""Triangles of longest-edge bisection against Delatin (PyPI pydelatin) on the same heights.

Both keep every node within the same bound. Bisection's count follows from the deviations a plane
file stores: an active node turns two triangles into four, one into two on the map's edge. Delatin
is given the file's own nodes. The input is a plane file with all of its tiles. Prints one JSON
object; needs gdal, numpy and pydelatin, and relief-bake built.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np
from osgeo import gdal
from pydelatin import Delatin

gdal.UseExceptions()


def exported(bake, file, folder, plane, level):
    """A plane of a level, south row first."""
    out = pathlib.Path(folder) / "plane.tif"
    subprocess.run([bake, "export", file, "-o", out, "--plane", plane, "--level", str(level), "--force"],
                   check=True, capture_output=True)
    return gdal.Open(str(out)).ReadAsArray()[::-1].astype(np.float64)


def bisection_counts(bake, file, levels, bounds_m, folder):
    """Triangles at each bound, from the 128 x 128 cells above the coarsest stored level down."""
    counts = [2 * 128 * 128] * len(bounds_m)
    for level in range(levels):
        deviation = exported(bake, file, folder, "deviation", level)
        index = [np.arange(n) for n in deviation.shape]
        new = (index[0][:, None] | index[1]) & 1 == 1
        # A pixel a node without the far edge, whose nodes repeat the last but bound no triangle beyond.
        edge = (index[0][:, None] == 0) | (index[1] == 0)
        for i, bound_m in enumerate(bounds_m):
            active = new & (deviation > bound_m)
            counts[i] += 2 * int(active.sum()) - int((active & edge).sum())
    return counts


def main():
    """Both at each bound."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", help="a plane's .relief file")
    parser.add_argument("--bake", default="target/release/relief-bake", help="the program relief-bake")
    parser.add_argument("--bounds", type=float, nargs="+", default=[2, 5, 10, 20], help="metres")
    args = parser.parse_args()
    shown = subprocess.run([args.bake, "inspect", args.file, "--json"], check=True, capture_output=True, text=True)
    levels = json.loads(shown.stdout)["levels"]
    with tempfile.TemporaryDirectory() as folder:
        counts = bisection_counts(args.bake, args.file, levels, args.bounds, folder)
        nodes = np.pad(exported(args.bake, args.file, folder, "nodes", 0), ((0, 1), (0, 1)), "edge").astype(np.float32)
    rows = []
    for bound_m, count in zip(args.bounds, counts):
        begin = time.perf_counter()
        peer = len(Delatin(nodes, max_error=bound_m).triangles)
        rows.append({"bound_m": bound_m, "relief": count, "delatin": peer, "ratio": count / peer,
                     "delatin_s": time.perf_counter() - begin})
    print(json.dumps({"nodes": nodes.shape, "rows": rows}))


if __name__ == "__main__":
    main()
