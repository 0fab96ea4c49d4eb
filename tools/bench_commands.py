"""The commands that `bench_bake` measures: relief-bake, GDAL's tools, the Moon by pip."""

import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys
import tarfile
import tempfile
import threading
import time

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


class Failed(Exception):
    """A command failed; the text says which and why."""


class PeakMemory(threading.Thread):
    """The kernel's high-water mark of one process, read until it ends.

    A child's ru_maxrss would do, did it not begin with the size of the Python that started it.
    """

    def __init__(self, pid):
        super().__init__(daemon=True)
        self.status, self.bytes, self.ended = pathlib.Path(f"/proc/{pid}/status"), 0, threading.Event()

    def run(self):
        """Every 10 ms: the mark only rises, so what is missed is the growth of the last 10 ms."""
        while not self.ended.is_set():
            try:
                text = self.status.read_text()
            except OSError:
                return  # it has ended
            for line in text.splitlines():
                if line.startswith("VmHWM:"):
                    self.bytes = int(line.split()[1]) * 1024
            self.ended.wait(0.01)


def run(*command):
    """Runs a command, returns its wall and CPU seconds, peak bytes and standard output."""
    command = [str(part) for part in command]
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        begin = time.perf_counter()
        process = subprocess.Popen(command, stdout=out, stderr=err, stdin=subprocess.DEVNULL)
        peak = PeakMemory(process.pid)
        peak.start()
        _, status, usage = os.wait4(process.pid, 0)
        wall_s = time.perf_counter() - begin
        peak.ended.set()
        peak.join()
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        if process.returncode != 0:
            raise Failed(f"{' '.join(command)}\n{err.read().decode(errors='replace')[-2000:]}")
        return {"wall_s": wall_s, "cpu_s": usage.ru_utime + usage.ru_stime, "peak_bytes": peak.bytes,
                "output": out.read().decode(errors="replace")}


def together(*results):
    """One figure for commands that ran one after the other."""
    return {"wall_s": sum(r["wall_s"] for r in results), "cpu_s": sum(r["cpu_s"] for r in results),
            "peak_bytes": max(r["peak_bytes"] for r in results)}


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


def strip(runs):
    """Runs without what they printed."""
    return [{key: value for key, value in r.items() if key != "output"} for r in runs]


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
