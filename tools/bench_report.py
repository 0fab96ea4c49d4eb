"""What every benchmark does with its sections: runs them, writes the figures and the page."""

import json
import subprocess
import sys

from bench_commands import Failed


def measured(sections):
    """What each section found, by name; one that fails says why and stops no other."""
    found = {}
    for name, measure in sections.items():
        print(f"bench: {name}", file=sys.stderr)
        try:
            found[name] = measure()
        except (Failed, OSError, subprocess.SubprocessError) as error:
            print(f"bench: {name}: {error}", file=sys.stderr)
            found[name] = {"error": str(error).splitlines()[-1]}
    return found


def failed(found):
    """Whether a section could not be measured."""
    return isinstance(found, dict) and "error" in found


def measured_on(machine, *programs):
    """Where and with what was measured, for the head of a page."""
    return (f"Measured on {machine['date']}: {machine['cpu']}, {machine['cores']} cores, {machine['memory_gib']} GiB, "
            f"{machine['system']}; {', '.join([*programs, machine['rustc'], machine['relief']])}.")


def page_sections(sections, writers):
    """The sections of a page, by their writers."""
    lines = []
    for name, found in sections.items():
        lines += ["", f"## {name}: not measured", "", found["error"]] if failed(found) else ["", *writers[name](found)]
    return lines


def verdict(met):
    """Whether an aim was met."""
    return "met" if met else "missed"


def write(report, page, out):
    """Writes OUT.json and OUT.md."""
    for path, text in ((f"{out}.json", json.dumps(report, indent=1) + "\n"), (f"{out}.md", page)):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    print(f"bench: {out}.md", file=sys.stderr)
