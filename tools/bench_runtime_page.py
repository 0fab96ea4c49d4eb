"""Writes what `bench_runtime` found as a page: each figure beside its aim and its peer."""

from bench_report import measured_on, page_sections, verdict

MIB = 1 << 20
AIM_MRAY_S = 20
AIM_FETCHES = 10
AIM_RATIO = 1.5
AIM_TRIANGLES = 174_000
AIM_FIRST_MS = 50


def shadows(found):
    """Masks of a plane, all kernels in one table."""
    embree = {sun["elevation_deg"]: sun for sun in found.get("embree", {}).get("suns", [])}
    lines = [f"## Shadows of a {found['columns']} x {found['rows']} plane", "",
             f"Every node is a ray; CPU, {found['threads']} threads. `sweep` shades all nodes of a plane at once and is what "
             "`reliefd mask` uses for planes; `exact` casts single rays; the rest is `exact` with fewer bounds, counted "
             "only. The paper's kernel is wrong where its bounds do not bound; all others agree.", "",
             "| sun | kernel | Mray/s | heights a ray | pairs of extremes a ray | fetches a ray |", "|---|---|---|---|---|---|"]
    for sun in found["suns"]:
        for kernel in sun["kernels"]:
            speed = "-" if kernel["mray_s"] is None else f"{kernel['mray_s']:.1f}"
            lines.append(f"| {sun['elevation_deg']:g}° | {kernel['kernel']} | {speed} | {kernel['heights']:.2f} | "
                         f"{kernel['extremes']:.2f} | {kernel['heights'] + kernel['extremes']:.2f} |")
        if sun["elevation_deg"] in embree:
            lines.append(f"| {sun['elevation_deg']:g}° | Embree, any hit | {embree[sun['elevation_deg']]['mray_s']:.1f} | | | |")
    sweeps = [kernel for sun in found["suns"] for kernel in sun["kernels"] if kernel["kernel"] == "sweep"]
    slowest = min(kernel["mray_s"] for kernel in sweeps)
    fetches = sum(kernel["heights"] + kernel["extremes"] for kernel in sweeps) / len(sweeps)
    lines += ["", "| figure | found | aim | |", "|---|---|---|---|",
              f"| exact mask, slowest sun | {slowest:.1f} Mray/s | {AIM_MRAY_S} | {verdict(slowest >= AIM_MRAY_S)} |",
              f"| fetches a ray, mean over the suns | {fetches:.2f} | {AIM_FETCHES} | {verdict(fetches <= AIM_FETCHES)} |"]
    if embree:
        peer = min(sun["mray_s"] for sun in embree.values())
        lines.append(f"| the same against Embree | {slowest / peer:.1f} times as fast | | |")
    dem = found["dem_bytes"]
    peaks = f"peak memory of `reliefd mask` {found['mask_peak_bytes'] / MIB:.0f} MiB"
    if embree:
        peaks += f", of Embree in Python {found['embree']['peak_bytes'] / MIB:.0f} MiB (tree built in {found['embree']['build_s']:.1f} s)"
    return lines + ["", f"The DEM as f32 is {dem / MIB:.0f} MiB; {peaks}."]


def triangles(found):
    """Bisection against Delatin."""
    lines = ["## Triangles at the same bound", "",
             "Bisection keeps S_0, bilinear between the nodes, within the bound; Delatin keeps the nodes.", "",
             "| heights | bound, m | bisection | Delatin | ratio | aim | |", "|---|---|---|---|---|---|---|"]
    for dem in found:
        for row in dem["rows"]:
            lines.append(f"| {dem['name']} | {row['bound_m']:g} | {row['relief']} | {row['delatin']} | {row['ratio']:.2f} | "
                         f"{AIM_RATIO} | {verdict(row['ratio'] <= AIM_RATIO)} |")
    return lines


def passes(run):
    """Milliseconds of each pass."""
    return ", ".join(f"{name} {ms:.2f}" for name, ms in run["pass_ms"].items())


def frame(found):
    """A Full HD frame."""
    lines = ["## A frame of 1920 x 1080 from 400 km, m = 13, threshold 1 px", "",
             "An absolute time counts only from a GPU; lavapipe is a CPU that acts as one.", "",
             "| adapter | triangles | aim (the paper's count) | | tiles | ms a pass |", "|---|---|---|---|---|---|"]
    for run in found.values():
        lines.append(f"| {run['adapter']} | {run['triangles']} | {AIM_TRIANGLES} | {verdict(run['triangles'] <= AIM_TRIANGLES)} | "
                     f"{run['tiles']} | {passes(run)} |")
    return lines


def first(found):
    """From a file to its first frame."""
    lines = ["## From opening a file to its first frame", "",
             f"Aim: {AIM_FIRST_MS} ms plus the adapter's start on a GPU, the same for m = 8 and m = 15. The first frame of "
             "1920 x 1080 shows what is resident; the complete frame has everything.", "",
             "| m | adapter | open | adapter start | resident set, pipelines | first frame | complete frame |",
             "|---|---|---|---|---|---|---|"]
    for m, runs in found.items():
        for run in runs:
            ms = run["ms"]
            cells = [f"{ms[key]:.1f} ms" if key in ms else "-" for key in ("open", "adapter", "backend", "first_frame", "complete_frame")]
            lines.append(f"| {m} | {run['adapter']} | " + " | ".join(cells) + " |")
    return lines


def markdown(report):
    """The report as a page."""
    lines = ["# Figures of the runtime", "",
             f"{measured_on(report['machine'])} Relief and peers in the same run."]
    writers = {"shadows": shadows, "triangles": triangles, "frame": frame, "first": first}
    return "\n".join(lines + page_sections(report["sections"], writers)) + "\n"
