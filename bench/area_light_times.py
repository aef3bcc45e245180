#!/usr/bin/env python3
"""How long pictures under area lights take with samples of light that pixels choose and with fixed ones, and how far
they are from 1,024 samples: the table of docs/performance.md.

    /usr/bin/python3 bench/area_light_times.py --program build/scumble [--runs 5] [--write-docs]
    /usr/bin/python3 bench/area_light_times.py --scene ball --keep FOLDER

The scenes are those of bench/area_light_scenes.py. Contestants take turns; everything runs once before it counts. FLIP
is that of `scumble compare --flip`, the mean over the picture. Without --write-docs the table goes to standard output.
"""

import argparse
import json
import statistics
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True

import area_light_scenes
from runs import run, say

PAGE = Path(__file__).resolve().parent.parent / "docs/performance.md"
BEGIN, END = "<!-- area lights: begin, written by bench/area_light_times.py -->\n", "<!-- area lights: end -->"
SCENES = [("StyLit's ball, one lamp", "ball.glb", area_light_scenes.make_ball),
          ("level, six lamps", "level.glb", area_light_scenes.make_level)]
SAMPLES = [("chosen by each pixel", []), ("`--samples 4`", ["--samples", 4]), ("`--samples 64`", ["--samples", 64])]
TRUTH = 1024


def measure(options, folder):
    """Rows of the table: scene, samples, seconds, FLIP."""
    rows = []
    for title, name, make in SCENES:
        if options.scene and name != options.scene + ".glb":
            continue
        make(folder / name)
        stylize = [options.program, "stylize", folder / name, "--style", options.style, "--size", options.size, "-q"]
        truth = folder / (name + ".truth.png")
        if not truth.exists():
            say("%s: %d samples" % (title, TRUTH))
            run([*stylize, "--samples", TRUTH, "-o", truth])
        times = {label: [] for label, _ in SAMPLES}
        flips = {}
        for turn in range(options.runs + 1):
            say("%s: run %d of %d" % (title, turn, options.runs))
            for label, arguments in SAMPLES:
                picture = folder / "picture.png"
                seconds, _, _ = run([*stylize, *arguments, "-o", picture])
                if turn > 0:
                    times[label].append(seconds)
                    continue
                compared = run([options.program, "compare", truth, picture, "--flip", "--json"])[2]
                flips[label] = json.loads(compared)["flip"]
        for label, _ in SAMPLES:
            of = times[label]
            rows.append((title, label, "%.2f s (%.2f–%.2f)" % (statistics.median(of), min(of), max(of)),
                         "%.4f" % flips[label]))
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=Path("build/scumble"))
    parser.add_argument("--style", default="chiaroscuro")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--scene", choices=["ball", "level"], help="measure one scene alone")
    parser.add_argument("--keep", type=Path,
                        help="a folder for scenes and pictures of 1,024 samples, used again if there")
    parser.add_argument("--write-docs", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if options.keep:
            options.keep.mkdir(parents=True, exist_ok=True)
        rows = measure(options, options.keep or Path(folder))
    table = "".join("| %s |\n" % " | ".join(row) for row in
                    [("scene", "samples of light", "whole process", "FLIP against {:,} samples".format(TRUTH)),
                     ("---", "---", "---", "---"), *rows]).replace("| --- | --- | --- | --- |", "|---|---|---|---|")
    if not options.write_docs:
        print(table, end="")
        return
    page = PAGE.read_text(encoding="utf-8")
    head, tail = page.split(BEGIN)[0], page.split(END)[1]
    PAGE.write_text(head + BEGIN + table + END + tail, encoding="utf-8")


if __name__ == "__main__":
    main()
