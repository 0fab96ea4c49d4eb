#!/usr/bin/env python3
"""Triangles of longest-edge bisection against Delatin (PyPI pydelatin) on the same heights.

Bisection keeps S_0 within the bound, Delatin its nodes. Bisection's count follows from the
deviations that a plane file stores. Delatin
is given the file's own nodes. The input is a plane file with all of its tiles. Prints one JSON
object; needs gdal, numpy and pydelatin, relief-bake and relief-formats' example `bisection` built.
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


def exported(bake, file, folder):
    """Level 0's nodes, south row first."""
    out = pathlib.Path(folder) / "nodes.tif"
    subprocess.run([bake, "export", file, "-o", out, "--force"], check=True, capture_output=True)
    return gdal.Open(str(out)).ReadAsArray()[::-1].astype(np.float32)


def main():
    """Both at each bound."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", help="a plane's .relief file")
    parser.add_argument("--bake", default="target/release/relief-bake", help="the program relief-bake")
    parser.add_argument("--bisection", default="target/release/examples/bisection", help="that example of relief-formats")
    parser.add_argument("--bounds", type=float, nargs="+", default=[2, 5, 10, 20], help="metres")
    args = parser.parse_args()
    counted = subprocess.run([args.bisection, args.file, *map(str, args.bounds)], check=True, capture_output=True, text=True)
    counts = json.loads(counted.stdout)["triangles"]
    with tempfile.TemporaryDirectory() as folder:
        nodes = np.pad(exported(args.bake, args.file, folder), ((0, 1), (0, 1)), "edge")
    rows = []
    for bound_m, count in zip(args.bounds, counts):
        begin = time.perf_counter()
        peer = len(Delatin(nodes, max_error=bound_m).triangles)
        rows.append({"bound_m": bound_m, "relief": count, "delatin": peer, "ratio": count / peer,
                     "delatin_s": time.perf_counter() - begin})
    print(json.dumps({"nodes": nodes.shape, "rows": rows}))


if __name__ == "__main__":
    main()
