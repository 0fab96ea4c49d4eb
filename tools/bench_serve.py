#!/usr/bin/env python3
"""Measures the daemon with many viewers and writes what it found.

Sections (all by default, or those named with --only):
  viewers  1, 4, 16 and 64 viewers at 320 x 180 and 1 and 4 at 1280 x 720, each on its own path, on each
           backend: frames a second, latency, fairness
  memory   the same path for all, so that all want the same tiles: what a viewer more costs
  churn    with --churn-minutes: viewers come, go and are killed; memory, descriptors and threads at the
           end against those at the start, by a rule that can fail

Wants reliefd, relief-bake and the example `load` of relief-client; `just bench-serve` builds them.
Viewers are threads of one process of their own that decodes nothing.
"""

import argparse
import functools
import json
import os
import pathlib
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import time

from bench_commands import DATA, ROOT, TARGET, Failed, bake, machine, run
from bench_report import failed, measured, write
from bench_serve_page import markdown

LOAD = TARGET / "examples/load"
VIEWERS = (1, 4, 16, 64)
SMALL, LARGE = (320, 180), (1280, 720)
LARGE_VIEWERS = (1, 4)
# Growth that allocators may cause; a leak of 10 KiB a viewer is found in 10 minutes of churn.
MAY_GROW_BYTES = 32 << 20
MAY_GROW_THREADS = 4


class Daemon:
    """A daemon of one file, until it is stopped."""

    def __init__(self, file, backend):
        command = [str(TARGET / "reliefd"), "serve", str(file), "--listen", "auto", "--backend", backend, "--headless"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        line = self.process.stdout.readline().strip()
        if not line.startswith("http://"):
            self.process.kill()
            raise Failed(f"{' '.join(command)}: prints no address but {line!r}")
        self.address = line.removeprefix("http://").rstrip("/")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def held(self):
        """Memory, descriptors and threads of the process."""
        proc = pathlib.Path(f"/proc/{self.process.pid}")
        status = dict(line.split(":", 1) for line in (proc / "status").read_text().splitlines())
        return {"resident_bytes": int(status["VmRSS"].split()[0]) * 1024, "descriptors": len(list((proc / "fd").iterdir())),
                "threads": int(status["Threads"])}

    def load(self, viewers, size, seconds, warm_s, *more):
        """Runs viewers; what they got, and the most memory meanwhile."""
        command = [LOAD, self.address, "--viewers", viewers, "--width", size[0], "--height", size[1], "--seconds", seconds,
                   "--warm-s", warm_s, *more]
        process = subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE, text=True)
        most = 0
        while process.poll() is None:
            most = max(most, self.held()["resident_bytes"])
            time.sleep(0.05)
        out = process.stdout.read()
        if process.returncode != 0:
            raise Failed(f"load with {viewers} viewers ended with {process.returncode}")
        return json.loads(out), most


def percentile(sorted_values, share):
    """The nearest rank."""
    return sorted_values[min(len(sorted_values) - 1, int(share * len(sorted_values)))] if sorted_values else None


def figures(found):
    """Frames a second, latency and fairness of one run."""
    viewers, seconds = found["viewers"], found["seconds"]
    latency = sorted(ms for viewer in viewers for ms in viewer["latency_ms"])
    each = [viewer["pictures"] / seconds for viewer in viewers]
    return {"viewers": len(viewers), "frames_s": sum(each), "frames_s_median": statistics.median(each),
            "fairness": min(each) / max(each) if max(each) else None,
            "latency_ms": {f"p{int(share * 100)}": percentile(latency, share) for share in (0.5, 0.95, 0.99)},
            "tiles": max(viewer["tiles"] for viewer in viewers), "bytes_s": sum(v["bytes"] for v in viewers) / seconds}


def viewers_section(args, file):
    """Frames and latencies."""
    found = []
    for backend in args.backends:
        for size, counts in ((SMALL, args.viewers), (LARGE, [n for n in LARGE_VIEWERS if n <= max(args.viewers)])):
            for count in counts:
                with Daemon(file, backend) as daemon:
                    print(f"bench: {backend}, {size[0]} x {size[1]}, {count} viewers", file=sys.stderr)
                    # On two cores a large picture takes a second, and four viewers take turns.
                    seconds = args.seconds * (1 if size == SMALL else 2.5)
                    run_, most = daemon.load(count, size, seconds, args.warm_s)
                    found.append({"backend": backend, "size": size, **figures(run_), "resident_bytes": most})
    return found


def memory_section(args, file):
    """What the first viewer costs, and one more."""
    found = []
    for backend in args.backends:
        with Daemon(file, backend) as daemon:
            idle, rows = daemon.held()["resident_bytes"], []
            for count in (1, *[n for n in args.viewers if n > 1]):
                run_, most = daemon.load(count, SMALL, args.seconds, args.warm_s, "--same-path")
                rows.append({"viewers": count, "resident_bytes": most, "tiles": figures(run_)["tiles"]})
            first = rows[0]["resident_bytes"]
            for row in rows[1:]:
                row["added_share"] = (row["resident_bytes"] - first) / (row["viewers"] - 1) / first
            found.append({"backend": backend, "idle_bytes": idle, "rows": rows})
    return found


def growth(before, after):
    """What grew more than it may, in words."""
    may = {"resident_bytes": MAY_GROW_BYTES, "descriptors": 0, "threads": MAY_GROW_THREADS}
    return [f"{name} {before[name]} -> {after[name]}" for name, most in may.items() if after[name] > before[name] + most]


def churn_section(args, file):
    """Viewers come, go and are killed, while one stays."""
    chance = random.Random(7)
    with Daemon(file, args.backends[0]) as daemon:
        def wave(seconds):
            """Some viewers for a while; every third process is killed in flight. How many viewers."""
            count = chance.choice((1, 2, 4, 8, 16))
            command = [str(LOAD), daemon.address, "--viewers", str(count), "--seconds", str(seconds), "--warm-s", "0"]
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            if chance.randrange(3) == 0:
                time.sleep(seconds * chance.random())
                process.kill()
            process.wait()
            return count

        # All paths once, so that their tiles are there, and as many threads as there will be.
        daemon.load(16, SMALL, 10, 0)
        time.sleep(5)
        before, attached, end = daemon.held(), 0, time.monotonic() + 60 * args.churn_minutes
        history = []
        while time.monotonic() < end:
            attached += wave(chance.choice((0.1, 0.5, 2.0)))
            history.append(daemon.held()["resident_bytes"])
        time.sleep(5)
        after = daemon.held()
        return {"minutes": args.churn_minutes, "attached": attached, "before": before, "after": after,
                "most_bytes": max(history, default=0), "grew": growth(before, after)}


def main():
    """Runs the sections, writes the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", nargs="?", help="a .relief file; the tests' Earth, baked, if left out")
    parser.add_argument("--only", nargs="+", choices=("viewers", "memory", "churn"))
    parser.add_argument("--backends", nargs="+", default=["cpu", "gpu"], choices=("cpu", "gpu"))
    parser.add_argument("--viewers", nargs="+", type=int, default=list(VIEWERS))
    parser.add_argument("--seconds", type=float, default=8, help="measured in each run")
    parser.add_argument("--warm-s", type=float, default=5, help="before it, in which tiles come in")
    parser.add_argument("--churn-minutes", type=float, default=0)
    parser.add_argument("--out", default=str(ROOT / "BENCHMARKS-SERVE"), help="writes OUT.json and OUT.md")
    args = parser.parse_args()
    os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    sections = args.only or ["viewers", "memory"] + (["churn"] if args.churn_minutes else [])
    measure = {"viewers": viewers_section, "memory": memory_section, "churn": churn_section}
    report = {"machine": machine(), "settings": {"seconds": args.seconds, "warm_s": args.warm_s}}
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(args.file) if args.file else pathlib.Path(folder) / "earth.relief"
        if not args.file:
            bake(DATA / "earth_etopo1_6min.tif", file, "--vertical", "as-given")
        report["file"] = {"name": file.name, "bytes": file.stat().st_size}
        report["adapter"] = adapter(file) if "gpu" in args.backends else None
        report["sections"] = found = measured({name: functools.partial(measure[name], args, file) for name in sections})
    write(report, markdown(report), args.out)
    return 2 if any(map(failed, found.values())) else 1 if found.get("churn", {}).get("grew") else 0


def adapter(file):
    """What `--backend gpu` draws on."""
    try:
        shown = run(TARGET / "reliefd", "render", file, "--backend", "gpu", "--camera", "0,0,1e6", "--size", "8x8", "--out",
                    pathlib.Path(tempfile.gettempdir()) / "bench_serve.png", "--stats")
        return json.loads(shown["output"]).get("backend", "unknown")
    except (Failed, OSError, ValueError):
        return "unknown"


if __name__ == "__main__":
    sys.exit(main())
