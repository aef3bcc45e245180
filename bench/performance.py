#!/usr/bin/env python3
"""Speed against its targets, as one table: `make bench`.

    /usr/bin/python3 bench/performance.py --build build [--only yardstick,process] [--seconds 12] [--write-docs]

Runs the bench programs and the command line, one after the other, and writes results.json, results.md and
performance.svg into the output folder. Gates nothing: a missed target is only reported.
"""

import argparse
import datetime
import json
import os
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True

from marked_pages import replaced
from performance_chart import chart
from performance_runs import measure_guides, measure_process, measure_sequence
from runs import processor, run, say

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
TRANSFER_PARTS = ["yardstick", "rates", "radius", "extensions", "light-paths", "sizes", "memory"]
TITLES = {"1": "The engine against the yardstick", "2": "Nanoseconds a pixel, frames a second", "3": "Large radius",
          "4": "What extensions cost", "5": "Large pictures", "6": "Guides", "7": "A whole process", "8": "A sequence",
          "9": "Finishing effects"}


def measured_by(program, options, more=()):
    """What a program of ours prints, which takes our options."""
    command = [options.build / "bench" / program, *more]
    command += ["--smoke"] if options.smoke else ["--seconds", options.seconds, "--rounds", options.rounds]
    return json.loads(run(command)[2])


def measure_transfer(options, part):
    hd = ["--hd"] if options.hd and not options.smoke else []
    return measured_by("performance", options, ["--only", part] + hd)


def measure_finish(options):
    return measured_by("finish_bench", options, ["--json"])


OTHER_PARTS = {"guides": measure_guides, "process": measure_process, "sequence": measure_sequence,
               "finish": measure_finish}
EVERYTHING = TRANSFER_PARTS + list(OTHER_PARTS)
OTHER_THAN_FINISH = [part for part in EVERYTHING if part != "finish"]


def verdict(figure):
    if "target" not in figure:
        return ""
    value, target = figure["median"], figure["target"]
    # A difference within the rounding of the last shown digit is no miss.
    reached = value >= target * 0.9995 if figure["at_least"] else value <= target * 1.0005
    return "reached" if reached else "missed"


def number(value):
    return "%.0f" % value if value >= 1000 else "%.3g" % value


def measured_text(figure):
    text = "%s %s" % (number(figure["median"]), figure["unit"])
    if number(figure["low"]) != number(figure["high"]):
        text += " (%s–%s)" % (number(figure["low"]), number(figure["high"]))
    return text


def target_text(figure):
    if "target" not in figure:
        return ""
    return ("≥ " if figure["at_least"] else "≤ ") + number(figure["target"])


def rows_of(report):
    """Lines of the table: item, quantity, frame, measured, target, verdict."""
    figures = [figure for part in report["parts"].values() for figure in part["figures"]]
    figures.sort(key=lambda figure: figure["item"])  # a stable sort keeps the order within an item
    return [(f["item"], f["what"], f["frame"], measured_text(f), target_text(f), verdict(f)) for f in figures], figures


def notes_of(report):
    notes = [note for part in report["parts"].values() for note in part.get("notes", [])]
    for part in report["parts"].values():
        for figure in part["figures"]:
            if figure.get("note"):
                notes.append("%s: %s" % (figure["what"], figure["note"]))
    return list(dict.fromkeys(notes))


def machine_text(report):
    where = report["machine"]
    return "%s, %d threads, load before the run %.1f; %s; medians with their quartiles." % (
        where["processor"], where["threads"], where["load"], report["date"])


def counts_text(figures):
    verdicts = [verdict(figure) for figure in figures]
    return "%d of %d targets reached." % (verdicts.count("reached"),
                                          verdicts.count("reached") + verdicts.count("missed"))


def plain_table(report):
    rows, figures = rows_of(report)
    if not rows:
        return "nothing was measured\n"
    widths = [max(len(row[column]) for row in rows) for column in range(6)]
    lines = []
    for item in sorted({row[0] for row in rows}):
        lines += ["", "%s. %s" % (item, TITLES[item])]
        for row in rows:
            if row[0] == item:
                cells = [row[column].ljust(widths[column]) for column in range(1, 6)]
                lines.append(("  " + "  ".join(cells)).rstrip())
    lines += [""] + notes_of(report) + ["", counts_text(figures), machine_text(report)]
    return "\n".join(lines[1:]) + "\n"


def markdown(report):
    rows, figures = rows_of(report)
    lines = ["| | what | frame | measured | target | |", "|---|---|---|---|---|---|"]
    for item, what, frame, measured, target, reached in rows:
        lines.append("| %s | %s | %s | %s | %s | %s |" % (
            item, what, frame, measured, target, "**missed**" if reached == "missed" else reached))
    notes = ["- %s" % note for note in notes_of(report)]
    lines += [""] + notes + ([""] if notes else []) + [counts_text(figures) + " " + machine_text(report)]
    return "\n".join(lines) + "\n"


def transfer_stages(report):
    """Where the engine's nanoseconds a pixel go, by frame."""
    figures = [f for f in report["parts"].get("yardstick", {"figures": []})["figures"] if "match" in f.get("more", {})]
    if not figures:
        return []
    names = list(figures[0]["more"])
    lines = ["The engine on one thread, nanoseconds a covered pixel by the clock on the wall:", ""]
    lines += ["| frame | %s |" % " | ".join(names), "|---" * (len(names) + 1) + "|"]
    return lines + ["| %s | %s |" % (f["frame"], " | ".join("%.1f" % f["more"][name] for name in names))
                    for f in figures] + [""]


def process_stages(report):
    """Where the time of a whole process goes, as it reports it itself."""
    stages = report["parts"].get("process", {}).get("stages", {})
    if not stages:
        return []
    whole = sum(stages.values())
    lines = ["One run of `scumble stylize` on the Suzanne scene, as above:", "", "| stage | ms | share |",
             "|---|---|---|"]
    return lines + ["| %s | %.1f | %.0f%% |" % (name, ms, 100.0 * ms / whole) for name, ms in stages.items()] + [""]


def stages_text(report):
    return "\n".join(transfer_stages(report) + process_stages(report))


def of_parts(report, parts):
    return {**report, "parts": {part: found for part, found in report["parts"].items() if part in parts}}


def write_docs(report):
    """The table of finishing effects, if they were measured; all else, if the rest was."""
    page = ROOT / "docs/performance.md"
    text = page.read_text(encoding="utf-8")
    others = of_parts(report, OTHER_THAN_FINISH)
    if others["parts"]:
        text = replaced(page, text, "figures", "make bench", markdown(others))
        text = replaced(page, text, "stages", "make bench", stages_text(others))
        (ROOT / "docs/gallery/performance.svg").write_text(chart(report), encoding="utf-8")
    if "finish" in report["parts"]:
        text = replaced(page, text, "finishing effects", "make bench", markdown(of_parts(report, ["finish"])))
    page.write_text(text, encoding="utf-8")


def measure(options, report):
    with tempfile.TemporaryDirectory(prefix="scumble-bench-") as scratch:
        options.scratch = Path(scratch)
        for part in options.only:
            say("measuring: " + part)
            found = OTHER_PARTS[part](options) if part in OTHER_PARTS else measure_transfer(options, part)
            report["parts"][part] = found
            (options.output / "results.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="folder that CMake built in")
    parser.add_argument("--output", type=Path, default=ROOT / "out/bench", help="folder for the results")
    parser.add_argument("--only", help="parts with commas between; left out: all of " + ", ".join(EVERYTHING))
    parser.add_argument("--update", action="store_true", help="keep the other parts of the results that are there")
    parser.add_argument("--show", action="store_true",
                        help="measure nothing: the table and chart of the results that are there")
    parser.add_argument("--seconds", type=float, default=4.0, help="about how long each group of rounds may take")
    parser.add_argument("--rounds", type=int, default=15, help="the most rounds of a group")
    parser.add_argument("--repeats", type=int, default=5, help="runs of whole processes")
    parser.add_argument("--hd", action="store_true",
                        help="the yardstick at 1920x1080 alone, which takes a third of the time")
    parser.add_argument("--smoke", action="store_true", help="everything once, small: whether it runs, not how fast")
    parser.add_argument("--write-docs", action="store_true", help="put table and chart into docs/performance.md")
    options = parser.parse_args()
    options.only = options.only.split(",") if options.only else EVERYTHING
    for part in options.only:
        if part not in EVERYTHING:
            parser.error("--only %s: there are %s" % (part, ", ".join(EVERYTHING)))
    if options.write_docs and options.smoke:
        parser.error("--write-docs: --smoke measures nothing that is worth a page")
    left_out = [part for part in OTHER_THAN_FINISH if part not in options.only]
    if options.write_docs and left_out and options.only != ["finish"] and not (options.update or options.show):
        parser.error("--write-docs: the page would lose %s: measure them too, or add --update to keep those of the "
                     "results that are there" % ", ".join(left_out))
    options.output, options.build = options.output.resolve(), options.build.resolve()
    return options


def main():
    options = parse()
    options.output.mkdir(parents=True, exist_ok=True)
    file = options.output / "results.json"
    report = {"date": datetime.date.today().isoformat(), "parts": {},
              "machine": {"processor": processor(), "threads": os.cpu_count(), "load": os.getloadavg()[0]}}
    if options.show or options.update:
        if not file.exists():
            sys.exit("%s is not there: run without --show and --update first" % file)
        kept = json.loads(file.read_text(encoding="utf-8"))
        report = kept if options.show else {**report, "parts": kept["parts"]}
    if not options.show:
        measure(options, report)
    (options.output / "results.md").write_text(markdown(report) + "\n" + stages_text(report), encoding="utf-8")
    (options.output / "performance.svg").write_text(chart(report), encoding="utf-8")
    if options.write_docs:
        write_docs(report)
    print(plain_table(report), end="")


main()
