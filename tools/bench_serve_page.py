"""Writes what `bench_serve` found as a page."""

from bench_report import measured_on, page_sections, verdict

MIB = 1 << 20
AIM_ADDED = 0.05


def viewers(found):
    """Frames a second, latency, fairness."""
    lines = ["## Viewers, each on its own path", "",
             "A view goes out when the first picture of the last has come; JPEG, threshold 1 px, exact shadows. Latency is from "
             "sending a view to the last payload of its first picture. Fairness is the slowest viewer's frames over the "
             "fastest's. The daemon and all viewers share the machine's cores.", "",
             "| backend | size | viewers | frames/s in all | frames/s a viewer | p50 | p95 | p99 | fairness | RAM |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for row in found:
        ms = [f"{row['latency_ms'][key]:.0f} ms" if row["latency_ms"][key] is not None else "-" for key in ("p50", "p95", "p99")]
        fairness = "-" if row["fairness"] is None or row["viewers"] == 1 else f"{row['fairness']:.2f}"
        lines.append(f"| {row['backend']} | {row['size'][0]} x {row['size'][1]} | {row['viewers']} | {row['frames_s']:.1f} | "
                     f"{row['frames_s_median']:.2f} | {' | '.join(ms)} | {fairness} | {row['resident_bytes'] / MIB:.0f} MiB |")
    return lines


def memory(found):
    """What a viewer more costs."""
    lines = ["## Memory of a viewer more", "",
             "All fly the same path, so that all want the same tiles. The tiles are in one atlas, on a GPU or in RAM, whoever "
             f"looks at them; aim: a viewer more takes less than {AIM_ADDED:.0%} of what the daemon takes with the first. With a GPU "
             "in software its memory is RAM, and counted.", "",
             "| backend | viewers | RAM | tiles in the atlas | a viewer more | aim |", "|---|---|---|---|---|---|"]
    for of in found:
        lines.append(f"| {of['backend']} | 0 | {of['idle_bytes'] / MIB:.1f} MiB | | | |")
        for row in of["rows"]:
            share = row.get("added_share")
            cells = "| |" if share is None else f"{share:.2%} | {verdict(share < AIM_ADDED)} |"
            lines.append(f"| {of['backend']} | {row['viewers']} | {row['resident_bytes'] / MIB:.1f} MiB | {row['tiles']} | {cells}")
    return lines


def churn(found):
    """Viewers come, go and are killed."""
    rows = [("RAM", "resident_bytes", lambda v: f"{v / MIB:.1f} MiB"), ("descriptors", "descriptors", str), ("threads", "threads", str)]
    lines = [f"## {found['minutes']:g} minutes of churn", "",
             f"{found['attached']} viewers attached, flew, detached or were killed. Verdict: "
             + (f"grew: {'; '.join(found['grew'])}." if found["grew"] else "nothing grew."), "",
             "| | before | after |", "|---|---|---|"]
    return lines + [f"| {name} | {text(found['before'][key])} | {text(found['after'][key])} |" for name, key, text in rows]


PEERS = ["## Peers", "",
         "No peer serves terrain to several viewers from one resident set in a form that could be measured here in the same run. "
         "UNIGINE's manual says that memory consumption increases significantly when several viewports are used."]


def markdown(report):
    """The report as a page."""
    of = report["file"]
    lines = ["# Figures of the daemon", "",
             f"{measured_on(report['machine'])} {of['name']}, {of['bytes'] / MIB:.1f} MiB; {report['settings']['seconds']:g} s a run after "
             f"{report['settings']['warm_s']:g} s of warming up."]
    if report.get("adapter"):
        lines += ["", f"`gpu` is {report['adapter']}. An absolute time counts only from a GPU; lavapipe is a CPU that acts as one."]
    writers = {"viewers": viewers, "memory": memory, "churn": churn}
    return "\n".join(lines + page_sections(report["sections"], writers) + ["", *PEERS]) + "\n"
