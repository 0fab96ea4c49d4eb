#!/usr/bin/env python3
"""Measures relief-bake against GDAL's own tools in one run, and writes what it found.

Sections (all by default, or those named with --only):
  wall      baking a planet to m = 13, everything in the file, against gdalwarp and a COG
  lossless  bytes of the whole file on integer sources, against COG ZSTD-19 PREDICTOR 2
  bounded   bytes at a bound of 0.5 m on float sources, against COG LERC_ZSTD
  decode    decoding all of level 0, against GDAL reading the COG with all threads
  open      opening and decoding the first coarse level, a small file against a large one
  memory    peak memory at m = 15 under --memory 1GiB, and time per node against m = 13

Relief and peer take turns; each figure is the median of --runs, with all of them in the JSON.
The Moon (LOLA, 16 px/deg) comes from the PyPI source package pdsimage by pip; where it cannot be
had, ETOPO1 of tests/data stands in and the results say so.
"""

import argparse
import json
import os
import pathlib
import statistics
import sys
import tempfile

import numpy as np
from osgeo import gdal

from bench_commands import (BAKE, DATA, MOON_CRS, ROOT, Failed, bake, cog, decode_cog, decode_relief, fetch_moon,
                            machine, run, strip, together)
from bench_page import AIMS, geometric_mean, markdown, median
from bench_report import failed, measured, write

# Integer DEMs on a regular grid: (file, relief's options). A local map keeps the source's pixels.
LOSSLESS = [("earth_etopo1_6min.tif", ["--vertical", "as-given"]), ("moon_dem_halfmetre_dn.tif", []),
            ("srtm_n40e040_3s.tif", ["--body", "plane", "--vertical", "as-given"]),
            ("sierra_albers_30m.tif", ["--body", "plane", "--vertical", "as-given"]),
            ("antarctica_epsg3031.tif", ["--body", "plane", "--vertical", "as-given"]),
            ("fiji_across_180.tif", ["--body", "plane", "--vertical", "as-given"])]
BOUNDED = [(name, ["--body", "plane", "--vertical", "as-given"])
           for name in ("lidar_1m_utm15n.tif", "bathymetry_utm30n_nan_untagged.tif")]


class Bench:
    """One run's settings and what it found."""

    def __init__(self, args, folder):
        self.args, self.folder = args, folder
        self.threads = str(args.threads)
        self.large_m, self.small_m = (12, 11) if args.quick else (15, 13)
        self._planet = None

    def planet(self):
        """(name, file, CRS, note): the Moon when it can be had, else the Earth."""
        if self._planet is None:
            self._planet = self._moon() or ("Earth, ETOPO1, 3601 x 1801", DATA / "earth_etopo1_6min.tif", "EPSG:4326",
                                            "LOLA could not be had; ETOPO1 stands in")
        return self._planet

    def _moon(self):
        label = pathlib.Path(self.args.moon) if self.args.moon else fetch_moon(self.folder / "packages")
        if label is None:
            return None
        tif = self.folder / "moon16.tif"
        # The label's georeference is a rounded cylindrical projection; both sides get degrees.
        run("gdal_translate", "-q", "-a_srs", MOON_CRS, "-a_ullr", 0, 90, 360, -90, "-a_offset", 0, "-a_scale", 0.5,
            "-co", "TILED=YES", label, tif)
        return ("Moon, LOLA 16 px/deg, 5760 x 2880", tif, MOON_CRS, "")

    def planet_options(self):
        """What relief-bake must be told about the planet."""
        return [] if self.planet()[2] == MOON_CRS else ["--vertical", "as-given"]

    def bake_planet(self, m, out, *options):
        """The planet to exponent m, bilinear as the peer."""
        return bake(self.planet()[1], out, "--m", m, "--resample", "bilinear", "--threads", self.threads,
                    *self.planet_options(), *options)

    def warp_planet(self, m, out):
        """The peer: the same grid of cells by gdalwarp, then a COG with average overviews."""
        _, source, crs, _ = self.planet()
        warped = self.folder / "warped.tif"
        # In the source's own 0..360: asked for -180..180, gdalwarp leaves half of ETOPO1 empty.
        first = run("gdalwarp", "-q", "-overwrite", "-r", "bilinear", "-t_srs", crs, "-te", 0, -90, 360, 90,
                    "-ts", 2 << m, 1 << m, "-multi", "-wo", f"NUM_THREADS={self.threads}", "-wm", 512,
                    "-co", "TILED=YES", "-co", "BIGTIFF=IF_SAFER", source, warped)
        second = cog(warped, out, "COMPRESS=ZSTD", "LEVEL=3", "PREDICTOR=2", f"NUM_THREADS={self.threads}")
        warped.unlink()
        return together(first, second)

    def wall(self):
        """Wall time of a planet."""
        relief, peer = [], []
        relief_file, peer_file = self.folder / "planet.relief", self.folder / "planet.tif"
        for _ in range(self.args.runs):
            peer.append(self.warp_planet(self.small_m, peer_file))
            relief.append(self.bake_planet(self.small_m, relief_file))
        return {"m": self.small_m, "source": self.planet()[0], "relief": strip(relief), "peer": strip(peer),
                "relief_bytes": relief_file.stat().st_size, "peer_bytes": peer_file.stat().st_size,
                "ratio": median(relief, "wall_s") / median(peer, "wall_s")}

    def nodes_as_tif(self, relief, step_m):
        """Level 0 of a relief file as an integer GeoTIFF of heights / step_m: the same samples."""
        exported = self.folder / "nodes.tif"
        run(BAKE, "export", relief, "-o", exported, "--force")
        opened = gdal.Open(str(exported))  # a band dies with its dataset
        heights = opened.GetRasterBand(1).ReadAsArray()
        q = heights.astype(np.float64) / step_m
        if not np.array_equal(q, np.rint(q)) or np.abs(q).max() > 32767:
            raise Failed(f"{relief}: exported heights are not 16-bit multiples of {step_m} m")
        out = self.folder / "nodes16.tif"
        dataset = gdal.GetDriverByName("GTiff").Create(str(out), q.shape[1], q.shape[0], 1, gdal.GDT_Int16)
        dataset.GetRasterBand(1).WriteArray(q.astype(np.int16))
        dataset.FlushCache()
        return out

    def sizes(self, sources, relief_options, peer_options, lossless):
        """Bytes of relief files against COGs of the same samples."""
        rows, skipped = [], []
        relief, peer = self.folder / "size.relief", self.folder / "size.tif"
        for name, options in sources:
            try:
                bake(DATA / name, relief, *options, *relief_options)
                # A globe's nodes are not the source's samples; a local map's are.
                same = DATA / name
                if lossless and "plane" not in options:
                    step_m = json.loads(run(BAKE, "inspect", relief, "--json")["output"])["step_m"]
                    same = self.nodes_as_tif(relief, step_m)
                cog(same, peer, *peer_options)
            except Failed as error:
                print(f"bench: {name}: {error}", file=sys.stderr)
                skipped.append({"source": name, "why": str(error).splitlines()[-1]})
                continue
            rows.append({"source": name, "relief_bytes": relief.stat().st_size, "peer_bytes": peer.stat().st_size,
                         "ratio": relief.stat().st_size / peer.stat().st_size})
        ratios = [row["ratio"] for row in rows]
        return {"files": rows, "skipped": skipped, "ratio": geometric_mean(ratios)}

    def lossless(self):
        """Whole file, integer sources."""
        return self.sizes(LOSSLESS, [], ["COMPRESS=ZSTD", "LEVEL=19", "PREDICTOR=2"], lossless=True)

    def bounded(self):
        """Whole file, float sources, a bound of 0.5 m."""
        return self.sizes(BOUNDED, ["--max-error", "0.5"], ["COMPRESS=LERC_ZSTD", "MAX_Z_ERROR=0.5"], lossless=False)

    def planet_pair(self):
        """The planet's relief file and COG of the wall section, made when not there."""
        relief, peer = self.folder / "planet.relief", self.folder / "planet.tif"
        if not relief.exists():
            self.bake_planet(self.small_m, relief)
        if not peer.exists():
            self.warp_planet(self.small_m, peer)
        return relief, peer

    def decode(self):
        """Decoding level 0 whole, files in the page cache."""
        relief, peer = self.planet_pair()
        ours, theirs = [], []
        for _ in range(self.args.runs + 1):
            theirs.append(decode_cog(peer))
            ours.append(decode_relief(relief, self.args.threads))
        ours, theirs = ours[1:], theirs[1:]  # the first warms the page cache
        return {"m": self.small_m, "relief_s": [r["decode_s"] for r in ours], "peer_s": theirs,
                "ratio": median(ours, "decode_s") / statistics.median(theirs)}

    def open(self):
        """Opening and the first coarse level, whatever the file's size."""
        result = {}
        for m in (8, self.large_m):
            relief = self.folder / f"open{m}.relief"
            if not relief.exists():
                self.bake_planet(m, relief)
            runs = [decode_relief(relief, 1, first_only=True) for _ in range(max(5, self.args.runs))]
            result[f"m{m}_ms"] = 1e3 * statistics.median(r["open_s"] + r["first_level_s"] for r in runs)
            result[f"m{m}_bytes"] = relief.stat().st_size
        result["ms"] = max(result["m8_ms"], result[f"m{self.large_m}_ms"])
        return result

    def memory(self):
        """Peak memory and time per node of a large bake."""
        small = self.bake_planet(self.small_m, self.folder / "small.relief", "--memory", "1GiB")
        large = self.bake_planet(self.large_m, self.folder / f"open{self.large_m}.relief", "--memory", "1GiB")
        nodes = {m: 2 << (2 * m) for m in (self.small_m, self.large_m)}
        per_node = {"small": small["wall_s"] / nodes[self.small_m], "large": large["wall_s"] / nodes[self.large_m]}
        return {"m": self.large_m, "peak_gib": large["peak_bytes"] / (1 << 30), "wall_s": large["wall_s"],
                "ns_per_node": 1e9 * per_node["large"], "small_m": self.small_m,
                "small_ns_per_node": 1e9 * per_node["small"], "ratio": per_node["large"] / per_node["small"]}


def build():
    """Builds the tool and the decoder, if there is one."""
    run("cargo", "build", "--release", "--locked", "--manifest-path", ROOT / "Cargo.toml", "-p", "relief-tools")
    if (ROOT / "formats/examples/decode.rs").exists():
        run("cargo", "build", "--release", "--locked", "--manifest-path", ROOT / "Cargo.toml", "-p", "relief-formats",
            "--example", "decode")


SECTIONS = ("wall", "lossless", "bounded", "decode", "memory", "open")


def main():
    """Runs the sections asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", choices=SECTIONS, help="measure this section (may be repeated)")
    parser.add_argument("--quick", action="store_true", help="small planets: m = 11 for 13, m = 12 for 15; no figures to publish")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--moon", metavar="LABEL", help="LDEM_16.LBL, when it is there already")
    parser.add_argument("--work", metavar="DIR", help="where the files are made (default: a temporary folder)")
    parser.add_argument("--out", default=str(ROOT / "BENCHMARKS"), metavar="STEM", help="writes STEM.json and STEM.md")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=args.work) as folder:
        try:
            build()
        except Failed as error:
            sys.exit(f"bench: {error}")
        bench = Bench(args, pathlib.Path(folder))
        sections = measured({name: getattr(bench, name) for name in SECTIONS if not args.only or name in args.only})
        planet = bench.planet()
        report = {"machine": machine(), "runs": args.runs, "threads": args.threads, "planet": planet[0],
                  "note": "; ".join(filter(None, [planet[3], "a quick run, not for publication" if args.quick else ""])),
                  "aims": AIMS, "sections": sections}
    page = markdown(report)
    write(report, page, args.out)
    print(page)
    sys.exit(1 if any(map(failed, sections.values())) else 0)


if __name__ == "__main__":
    main()
