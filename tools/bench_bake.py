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
import datetime
import json
import math
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tarfile
import tempfile
import time

import numpy as np
from osgeo import gdal

gdal.UseExceptions()

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "tests/data"
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
BAKE = TARGET / "relief-bake"
DECODER = TARGET / "examples/decode"
MOON_PACKAGE = "pdsimage==1.1.1"
MOON_LABEL, MOON_IMAGE = "LDEM_16.LBL", "LDEM_16.IMG"
MOON_CRS = "+proj=longlat +R=1737400 +no_defs"
MIB = 1 << 20

# Section, what is compared, and the largest ratio (or figure) that is aimed at.
AIMS = {"wall": 0.7, "lossless": 0.6, "bounded": 0.5, "decode": 0.5, "open_ms": 5.0, "memory_gib": 1.2,
        "time_per_node": 1.2}
# Integer DEMs on a regular grid: (file, relief's options). A local map keeps the source's pixels.
LOSSLESS = [("earth_etopo1_6min.tif", ["--vertical", "as-given"]), ("moon_dem_halfmetre_dn.tif", []),
            ("srtm_n40e040_3s.tif", ["--body", "plane", "--vertical", "as-given"]),
            ("sierra_albers_30m.tif", ["--body", "plane", "--vertical", "as-given"]),
            ("antarctica_epsg3031.tif", ["--body", "plane", "--vertical", "as-given"]),
            ("fiji_across_180.tif", ["--body", "plane", "--vertical", "as-given"])]
BOUNDED = [(name, ["--body", "plane", "--vertical", "as-given"])
           for name in ("lidar_1m_utm15n.tif", "bathymetry_utm30n_nan_untagged.tif")]


class Failed(Exception):
    """A command failed; the text says which and why."""


def run(*command):
    """Runs a command, returns its wall and CPU seconds, peak bytes and standard output."""
    command = [str(part) for part in command]
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        begin = time.perf_counter()
        process = subprocess.Popen(command, stdout=out, stderr=err, stdin=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        wall_s = time.perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        if process.returncode != 0:
            raise Failed(f"{' '.join(command)}\n{err.read().decode(errors='replace')[-2000:]}")
        return {"wall_s": wall_s, "cpu_s": usage.ru_utime + usage.ru_stime, "peak_bytes": usage.ru_maxrss * 1024,
                "output": out.read().decode(errors="replace")}


def together(*results):
    """One figure for commands that ran one after the other."""
    return {"wall_s": sum(r["wall_s"] for r in results), "cpu_s": sum(r["cpu_s"] for r in results),
            "peak_bytes": max(r["peak_bytes"] for r in results)}


def median(runs, key):
    """The median of one figure over all runs."""
    return statistics.median(r[key] for r in runs)


def bake(source, out, *options):
    """One bake, quiet, replacing the output."""
    return run(BAKE, "bake", source, "-o", out, "--force", "--quiet", *options)


def cog(source, out, *options):
    """One COG with overviews."""
    options = [part for option in options for part in ("-co", option)]
    return run("gdal_translate", "-q", "-of", "COG", source, out, "-co", "BIGTIFF=IF_SAFER",
               "-co", "OVERVIEW_RESAMPLING=AVERAGE", *options)


def fetch_moon(folder):
    """Gets LOLA's label and image by pip, returns the label's path; None when it cannot be had."""
    why = "no pip"
    for pip in ([sys.executable, "-m", "pip"], ["pip3"], ["pip"]):
        try:
            run(*pip, "download", "-q", "--no-deps", "--no-binary", ":all:", "-d", folder, MOON_PACKAGE)
            break
        except (Failed, OSError) as error:
            why = error
    archive = next(iter(folder.glob("pdsimage-*.tar.gz")), None) if folder.is_dir() else None
    if archive is None:
        print(f"bench: no LOLA: {why}", file=sys.stderr)
        return None
    with tarfile.open(archive) as tar:
        for member in tar:
            name = pathlib.PurePosixPath(member.name).name
            if member.isfile() and name in (MOON_LABEL, MOON_IMAGE):
                (folder / name).write_bytes(tar.extractfile(member).read())
    return folder / MOON_LABEL


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
        heights = gdal.Open(str(exported)).GetRasterBand(1).ReadAsArray()
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


def strip(runs):
    """Runs without what they printed."""
    return [{key: value for key, value in r.items() if key != "output"} for r in runs]


def geometric_mean(values):
    """Of positive numbers; None of none."""
    return math.exp(statistics.fmean(math.log(v) for v in values)) if values else None


def decode_cog(path):
    """Seconds in which GDAL opens a COG and reads all of it with all threads."""
    begin = time.perf_counter()
    dataset = gdal.OpenEx(str(path), open_options=["NUM_THREADS=ALL_CPUS"])
    band = dataset.GetRasterBand(1)
    for y in range(0, band.YSize, 512):  # one row of COG blocks at a time, as a reader would
        band.ReadRaster(0, y, band.XSize, min(512, band.YSize - y))
    return time.perf_counter() - begin


def decode_relief(path, threads, first_only=False):
    """The library's own figures, from the example `decode` of relief-formats.

    It prints one JSON object: open_s, first_level_s (the coarsest level), decode_s (every tile of
    level 0; absent with --first-only).
    """
    if not DECODER.exists():
        raise Failed("the example `decode` of relief-formats is not built")
    more = ["--first-only"] if first_only else []
    return json.loads(run(DECODER, path, "--threads", threads, *more)["output"])


def build():
    """Builds the tool and the decoder, if there is one."""
    run("cargo", "build", "--release", "--locked", "--manifest-path", ROOT / "Cargo.toml", "-p", "relief-tools")
    if (ROOT / "formats/examples/decode.rs").exists():
        run("cargo", "build", "--release", "--locked", "--manifest-path", ROOT / "Cargo.toml", "-p", "relief-formats",
            "--example", "decode")


def first_line(*command):
    """The first line that a command prints, or `unknown`."""
    try:
        return run(*command)["output"].splitlines()[0]
    except (Failed, OSError, IndexError):
        return "unknown"


def machine():
    """What was measured on, with which versions, when."""
    cpu = [line.split(":", 1)[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines()
           if line.startswith("model name")]
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {"cpu": cpu[0] if cpu else platform.machine(), "cores": os.cpu_count(), "memory_gib": round(memory / (1 << 30)),
            "system": f"{platform.system()} {platform.release()}", "gdal": gdal.__version__,
            "rustc": first_line("rustc", "--version"), "relief": first_line(BAKE, "--version"),
            "date": datetime.date.today().isoformat()}


def number(value, digits=2):
    """A figure, or a dash where there is none."""
    return "-" if value is None else f"{value:.{digits}f}"


def verdict(value, aim):
    """Whether an aim was met."""
    return "-" if value is None else ("met" if value <= aim else "missed")


def markdown(report):
    """The report as a page."""
    on, found = report["machine"], report["sections"]
    lines = ["# Figures of the bake", "",
             f"Measured on {on['date']}: {on['cpu']}, {on['cores']} cores, {on['memory_gib']} GiB, {on['system']}; "
             f"GDAL {on['gdal']}, {on['rustc']}, {on['relief']}. Planet: {report['planet']}. "
             f"Medians of {report['runs']} runs, relief and peer in turns."]
    if report["note"]:
        lines.append(f"Note: {report['note']}.")
    lines += ["", "| what | relief | peer | ratio | aim | |", "|---|---|---|---|---|---|"]

    def row(what, relief, peer, value, aim, digits=2):
        lines.append(f"| {what} | {relief} | {peer} | {number(value, digits)} | {aim} | {verdict(value, aim)} |")

    wall = found.get("wall", {})
    if "ratio" in wall:
        row(f"wall time, m = {wall['m']}, everything in the file", f"{median(wall['relief'], 'wall_s'):.2f} s",
            f"{median(wall['peer'], 'wall_s'):.2f} s", wall["ratio"], AIMS["wall"])
    for key, what in (("lossless", "whole file, lossless, integer sources"),
                      ("bounded", "whole file, bound 0.5 m, float sources")):
        sizes = found.get(key, {})
        for file in sizes.get("files", []):
            lines.append(f"| {file['source']}, {key} | {file['relief_bytes'] / MIB:.2f} MiB | "
                         f"{file['peer_bytes'] / MIB:.2f} MiB | {file['ratio']:.3f} | | |")
        if sizes.get("files"):
            row(f"{what}, geometric mean", "", "", sizes["ratio"], AIMS[key], 3)
    decode = found.get("decode", {})
    if "ratio" in decode:
        row(f"decoding all of level 0, m = {decode['m']}", f"{statistics.median(decode['relief_s']):.3f} s",
            f"{statistics.median(decode['peer_s']):.3f} s", decode["ratio"], AIMS["decode"])
    opened = found.get("open", {})
    for key, value in opened.items():
        if key.endswith("_ms"):
            row(f"open and first coarse level, {key[:-3].replace('m', 'm = ')}", f"{value:.2f} ms", "", value, AIMS["open_ms"])
    memory = found.get("memory", {})
    if "ratio" in memory:
        row(f"peak memory, m = {memory['m']}, --memory 1GiB", f"{memory['peak_gib']:.2f} GiB", "", memory["peak_gib"],
            AIMS["memory_gib"])
        row(f"time per node, m = {memory['m']} against m = {memory['small_m']}", f"{memory['ns_per_node']:.1f} ns",
            f"{memory['small_ns_per_node']:.1f} ns", memory["ratio"], AIMS["time_per_node"])
    errors = [f"- {name}: {section['error']}" for name, section in found.items() if "error" in section]
    errors += [f"- {s['source']}: {s['why']}" for section in found.values() for s in section.get("skipped", [])]
    if errors:
        lines += ["", "Not measured:", "", *errors]
    return "\n".join(lines) + "\n"


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
    failed = False
    with tempfile.TemporaryDirectory(dir=args.work) as folder:
        try:
            build()
        except Failed as error:
            sys.exit(f"bench: {error}")
        bench = Bench(args, pathlib.Path(folder))
        sections = {}
        for name in SECTIONS:
            if args.only and name not in args.only:
                continue
            print(f"bench: {name}", file=sys.stderr)
            try:
                sections[name] = getattr(bench, name)()
            except Failed as error:
                print(f"bench: {name}: {error}", file=sys.stderr)
                sections[name] = {"error": str(error).splitlines()[0]}
                failed = True
        planet = bench.planet()
        report = {"machine": machine(), "runs": args.runs, "threads": args.threads, "planet": planet[0],
                  "note": "; ".join(filter(None, [planet[3], "a quick run, not for publication" if args.quick else ""])),
                  "aims": AIMS, "sections": sections}
    pathlib.Path(f"{args.out}.json").write_text(json.dumps(report, indent=1) + "\n")
    page = markdown(report)
    pathlib.Path(f"{args.out}.md").write_text(page)
    print(page)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
