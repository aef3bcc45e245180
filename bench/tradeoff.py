#!/usr/bin/env python3
"""Speed against accuracy on the sample scenes: `make tradeoff`.

    /usr/bin/python3 bench/tradeoff.py [--only suzanne-oil,toys-graphite] [--show] [--write-docs] [-- OPTION …]

Runs `scumble tradeoff` on each sample, one after the other, into out/tradeoff/NAME/; open report.html there. Arguments
after -- go to the command, such as --quick or --repeat 9.
"""

import argparse
import json
import shutil
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True

from marked_pages import replaced
from runs import say

ROOT = Path(__file__).resolve().parent.parent
# A scene and a style, what is special about it, the size, and options of its own.
SAMPLES = {
    "suzanne-oil": ("suzanne", "oil", "strokes of paint, normals alone", "960x540", []),
    "stilllife-plein-air": ("stilllife", "plein-air", "three exemplars that the light chooses from", "960x540", []),
    "toys-graphite": ("toys", "graphite", "hatching, normals alone", "960x540", []),
    "snail-scene-oil": ("snail", "scene-oil", "a painted scene whose light is matched, four guides", "960x540", []),
    # Small, as 1024 samples take their time.
    "snail-bounced-light": ("snail", "scene-oil", "the same with bounced light, which needs chance, for highlights",
                            "320x180",
                            ["--set", "transfer.guide_weights.lpe.LDDE=1", "--set", "transfer.guide_weights.lpe.LSE=0",
                             "--only", "samples,exact"]),
}
NONE = "–"
SAME = "the same picture as "  # as in the command's note


def measure(options, name):
    scene, style, _, size, own_options = SAMPLES[name]
    # An axis that only the whole grid has is measured with --quick, too.
    verb_options = [one for one in options.verb_options if one != "--quick" or "--only" not in own_options]
    # The scene's relative path: the report's command works on any machine.
    command = [options.build / "scumble", "tradeoff", "scenes/%s.glb" % scene, "--style", style,
               "--size", options.size or size, "-o", options.output / name] + own_options + verb_options
    # The command's own table and progress go to the place of ours.
    if subprocess.run([str(part) for part in command], cwd=ROOT).returncode != 0:
        sys.exit("%s: scumble tradeoff failed, see above" % name)


def figure(value):
    """Three significant digits, as in the command's own table."""
    if value is None or isinstance(value, str):
        return value or NONE
    return "%.0f" % value if abs(value) >= 100 else "%.3g" % value


def estimate(value):
    if value is None:
        return NONE
    error = value["standard_error"]
    return "%.3f" % value["mean"] + (" ± %.3f" % error if error else "")


def time(value):
    if value is None:
        return NONE
    return "%s (%s–%s)" % tuple(figure(value[key]) for key in ("median", "lower_quartile", "upper_quartile"))


def remarks(variant):
    """The part of the note for a table: " (= the style)", " (once)"."""
    said = []
    for part in variant["note"].split("; "):
        if part.startswith(SAME):
            said.append("= " + part[len(SAME):])
        if "ran once" in part:
            said.append("once")
    return " (%s)" % ", ".join(said) if said else ""


def row(variant):
    name = variant["variant"] + remarks(variant)
    if variant["chosen"] and variant["variant"] != "the style":
        name += ", **the style as it is**"
    megabytes = None if variant["memory_bytes"] is None else variant["memory_bytes"] * 1e-6
    coherence = None if variant["coherence"] is None else 100.0 * variant["coherence"]
    cells = ["★" if variant["front"] else "", name, time(variant["total_ms"]), figure(megabytes),
             figure(variant["texture"]), estimate(variant["both"]), figure(variant["guide_degrees"]), figure(coherence),
             figure(variant["seam_excess"]), figure(variant["repetition"])]
    return "| %s |" % " | ".join(cells)


def table(variants):
    head = ["", "variant", "time, ms (quartiles)", "memory, MB", "texture", "both", "off by, °", "coherence, %",
            "seam excess", "repetition"]
    return ["| %s |" % " | ".join(head), "|---" * len(head) + "|"] + [row(variant) for variant in variants]


def section(name, report):
    """The front, the style as it is, the qualities, and a few others; all of them are in the report."""
    scene, style, what = SAMPLES[name][:3]
    front = [next(variant for variant in report["variants"] if variant["variant"] == each) for each in report["front"]]
    others = [variant for variant in report["variants"] if not variant["front"]
              and (variant["chosen"] or variant["exact"]
                   or variant["axis"] in ("quality", "method", "resolution", "blend_radius"))]
    left_out = ["Left out: %s." % "; ".join(report["left_out"]), ""] if report["left_out"] else []
    lines = ["### %s" % name, "", "*%s.* %d variants%s at %d×%d; %s; medians of %d runs. Halves of the exemplar "
             "differ by %s, other seeds by %s." % (
                 what.capitalize(), len(report["variants"]), " (`--quick`)" if "--quick" in report["command"] else "",
                 report["width"], report["height"], report["machine"], report["repeats"],
                 figure(report["texture_floor"]), figure(report["texture_chance"])), ""]
    lines += left_out
    lines += ["![time against texture of %s in %s](gallery/tradeoff-%s.svg)" % (scene, style, name), ""]
    return "\n".join(lines + table(front + others) + [""])


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="folder that CMake built in")
    parser.add_argument("--output", type=Path, default=ROOT / "out/tradeoff", help="folder for the reports")
    parser.add_argument("--size", help="of the pictures; left out: as large as the page has them")
    parser.add_argument("--only", help="samples with commas between; left out: " + ", ".join(SAMPLES))
    parser.add_argument("--show", action="store_true", help="measure nothing: use the reports that are there")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder of the page")
    parser.add_argument("--write-docs", action="store_true", help="put charts and tables into the page")
    parser.add_argument("verb_options", nargs="*", metavar="OPTION", help="after --: options of scumble tradeoff")
    options = parser.parse_args()
    options.only = options.only.split(",") if options.only else list(SAMPLES)
    for name in options.only:
        if name not in SAMPLES:
            parser.error("--only %s: there are %s" % (name, ", ".join(SAMPLES)))
    options.output, options.build = options.output.resolve(), options.build.resolve()
    return options


def main():
    options = parse()
    page = options.docs / "tradeoff.md"
    for name in options.only:
        if not options.show:
            say("measuring: " + name)
            measure(options, name)
        file = options.output / name / "tradeoff.json"
        if not file.exists():
            sys.exit("%s is not there: run without --show first" % file)
        if options.write_docs:
            report = json.loads(file.read_text(encoding="utf-8"))
            text = replaced(page, page.read_text(encoding="utf-8"), name, "make tradeoff", section(name, report))
            page.write_text(text, encoding="utf-8")
            shutil.copyfile(options.output / name / "chart.svg", options.docs / ("gallery/tradeoff-%s.svg" % name))
        print(options.output / name / "report.html")


main()
