"""Writes what `bench_bake` found as a page: each figure beside its aim."""

import math
import statistics

from bench_report import measured_on, verdict

MIB = 1 << 20

# Section, what is compared, and the largest ratio (or figure) that is aimed at.
AIMS = {"wall": 0.7, "lossless": 0.6, "bounded": 0.5, "decode": 0.5, "open_ms": 5.0, "memory_gib": 1.2,
        "time_per_node": 1.2}


def median(runs, key):
    """The median of one figure over all runs."""
    return statistics.median(r[key] for r in runs)


def geometric_mean(values):
    """Of positive numbers; None of none."""
    return math.exp(statistics.fmean(math.log(v) for v in values)) if values else None


def number(value, digits=2):
    """A figure, or a dash where there is none."""
    return "-" if value is None else f"{value:.{digits}f}"


def markdown(report):
    """The report as a page."""
    on, found = report["machine"], report["sections"]
    lines = ["# Figures of the bake", "",
             f"{measured_on(on, 'GDAL ' + on['gdal'])} Planet: {report['planet']}. "
             f"Medians of {report['runs']} runs, relief and peer in turns."]
    if report["note"]:
        lines.append(f"Note: {report['note']}.")
    lines += ["", "| what | relief | peer | ratio | aim | |", "|---|---|---|---|---|---|"]

    def row(what, relief, peer, value, aim, digits=2):
        lines.append(f"| {what} | {relief} | {peer} | {number(value, digits)} | {aim} | {'-' if value is None else verdict(value <= aim)} |")

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
