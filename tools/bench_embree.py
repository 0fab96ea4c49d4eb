#!/usr/bin/env python3
"""Casts the shadows of a planar DEM with Embree (PyPI embreex), the peer of `reliefd mask`.

The DEM is a .npy of float32 heights, rows from the south; two triangles a cell, one ray a node,
from a little above the node towards the sun, "any hit". The tree is built once; the rays of one
sun are shared out to --processes forked from it. Prints one JSON object.
"""

import argparse
import json
import os
import resource
import time

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh


def mesh(heights, dx, dy):
    """Vertices and the two triangles of each cell."""
    rows, columns = heights.shape
    y, x = np.mgrid[0:rows, 0:columns].astype(np.float32)
    vertices = np.stack([x * np.float32(dx), y * np.float32(dy), heights], axis=-1).reshape(-1, 3)
    a = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).astype(np.int32).ravel()
    triangles = np.concatenate([np.stack([a, a + 1, a + columns + 1], 1), np.stack([a, a + columns + 1, a + columns], 1)])
    return vertices, triangles


def cast(scene, origins, sun, processes):
    """Seconds, and which rays met something."""
    lit = np.memmap("/dev/shm/relief-bench-%d" % os.getpid(), np.uint8, "w+", shape=len(origins))
    bounds = np.linspace(0, len(origins), processes + 1).astype(int)
    begin = time.perf_counter()
    children = []
    for low, high in zip(bounds, bounds[1:]):
        child = os.fork()
        if child == 0:
            for start in range(low, high, 1 << 18):
                part = slice(start, min(high, start + (1 << 18)))
                directions = np.broadcast_to(sun, (part.stop - part.start, 3)).copy()
                lit[part] = scene.run(origins[part], directions, query="OCCLUDED") < 0
            os._exit(0)
        children.append(child)
    for child in children:
        if os.waitpid(child, 0)[1] != 0:
            raise SystemExit("bench_embree: a process of rays failed")
    seconds = time.perf_counter() - begin
    result = np.array(lit)
    os.unlink(lit.filename)
    return seconds, result


def main():
    """Builds once, casts each sun."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dem", help=".npy of heights in metres, south row first")
    parser.add_argument("--spacing", type=float, nargs=2, required=True, metavar=("DX", "DY"), help="metres")
    parser.add_argument("--suns", type=float, nargs="+", default=[2, 5, 10, 20], help="elevations, degrees")
    parser.add_argument("--azimuth", type=float, default=135, help="degrees clockwise from north")
    parser.add_argument("--offset", type=float, default=0.05, help="start above the node, metres")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    parser.add_argument("--masks", help="folder for one .npy a sun: 1 lit, 0 shadow")
    args = parser.parse_args()
    heights = np.load(args.dem)
    begin = time.perf_counter()
    vertices, triangles = mesh(heights, *args.spacing)
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, vertices, triangles)
    origins = vertices + np.array([0, 0, args.offset], np.float32)
    # The tree is built when the first ray asks for it.
    scene.run(origins[:1], np.array([[0, 0, 1]], np.float32), query="OCCLUDED")
    found = {"build_s": time.perf_counter() - begin, "rays": len(origins), "suns": []}
    for elevation in args.suns:
        a, e = np.radians([args.azimuth, elevation])
        sun = np.array([np.cos(e) * np.sin(a), np.cos(e) * np.cos(a), np.sin(e)], np.float32)
        seconds, lit = cast(scene, origins, sun, args.processes)
        found["suns"].append({"elevation_deg": elevation, "seconds": seconds, "mray_s": len(origins) / seconds / 1e6,
                              "lit": float(lit.mean())})
        if args.masks:
            np.save(f"{args.masks}/embree_{elevation:g}.npy", lit.reshape(heights.shape))
    found["peak_bytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(json.dumps(found))


if __name__ == "__main__":
    main()
