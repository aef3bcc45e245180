#!/usr/bin/python3
"""Whether --budget-ms keeps its budgets: runs the sample scenes with bundled styles and budgets, each picture in a
process of its own, and counts how many were within their budget. Prints the tables of docs/budget.md; gates nothing.

  bench/budget.py --scumble build/scumble
"""

import argparse
import itertools
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

import runs

SOURCE = pathlib.Path(__file__).resolve().parent.parent
COUNTED = ("build", "rays", "upsample", "match", "vote", "compose", "upscale")
TOLD = re.compile(r"budget [\d.]+ ms: at most (\d+) ms, 19 times of 20, with (.+?)(, which repeats it)?$",
                  re.MULTILINE)


def paint(arguments, job, more, folder):
    """The outcome of one run, and its part of the budget, in milliseconds. Without --json, which would keep more than a
    picture needs."""
    verb, scene, style = job
    scene_file, style_folder = SOURCE / "scenes" / (scene + ".glb"), SOURCE / "exemplars" / style
    source = [scene_file, "--size", arguments.size]
    if verb == "transfer":
        guides = os.path.join(folder, "%s-%s.exr" % (scene, style))
        if not os.path.exists(guides):
            runs.run([arguments.scumble, "guidegen", *source, "--style", style_folder, "--quiet", "-o", guides])
        source = [guides]
    command = [arguments.scumble, verb, *source, "--style", style_folder, "-o", os.path.join(folder, "picture.png"),
               *more]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=True)
    report = done.stdout + done.stderr
    return report, sum(float(took) for stage, took in re.findall(r"(\w+) ([\d.]+)[,\n]", report) if stage in COUNTED)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scumble", default=SOURCE / "build" / "scumble")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--verbs", default="stylize,transfer")
    parser.add_argument("--scenes", default="suzanne,stilllife,toys,snail,ball",
                        help="of ball the light takes samples")
    parser.add_argument("--styles", default="oil,charcoal,sumi-e,chiaroscuro")
    parser.add_argument("--shares", default="0.6,0.8,1.2,2",
                        help="budgets, as shares of what the style itself took in a first run")
    parser.add_argument("--repeats", type=int, default=5, help="runs of each, that take turns")
    parser.add_argument("--csv", help="every run, as a file")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="scumble-budget-") as folder:
        rows = measure(arguments, folder)
    tell(arguments, rows)


def measure(arguments, folder):
    os.environ["XDG_CACHE_HOME"] = os.path.join(folder, "cache")
    jobs = []
    for job in itertools.product(*(each.split(",") for each in (arguments.verbs, arguments.scenes, arguments.styles))):
        first = statistics.median(paint(arguments, job, [], folder)[1] for _ in range(3))
        for share in arguments.shares.split(","):
            budget = "%.1f" % (first * float(share))
            jobs.append((job, float(share), budget))
            runs.say("%s %s ms" % (" ".join(job), budget))
            paint(arguments, job, ["--budget-ms", budget], folder)  # calibrates; not counted
    rows = []
    for repeat in range(arguments.repeats):
        for job, share, budget in jobs:
            report, took = paint(arguments, job, ["--budget-ms", budget], folder)
            predicted, picked, _ = TOLD.search(report).groups()
            rows.append((*job, share, float(budget), picked, float(predicted), "nothing fits" not in report,
                         "measuring up to" in report, took))
        runs.say("turn %d" % (repeat + 1))
    return rows


def tell(arguments, rows):
    if arguments.csv:
        with open(arguments.csv, "w", encoding="utf-8") as file:
            file.write("verb,scene,style,share,budget_ms,picked,predicted_ms,fits,measured,took_ms\n")
            file.writelines(",".join(map(str, row)) + "\n" for row in rows)

    def line(name, some):
        fitting = [row for row in some if row[7]]
        shares = sorted(row[9] / row[4] for row in fitting)  # of the budget
        within, over = [share for share in shares if share <= 1.0], [share for share in shares if share > 1.0]
        print("| %s | %d | %d | %s | %s | %s | %s |" % (
            name, len(some), len(fitting), "%.0f%%" % (100.0 * len(within) / len(fitting)) if fitting else "–",
            "%.2f" % statistics.median(shares) if fitting else "–",
            "%.2f ×" % statistics.median(over) if over else "–", "%.2f ×" % over[-1] if over else "–"))

    print("| | runs | something fits | of these within the budget | time of budget, median | over-run, median | "
          "largest |")
    print("|---|---|---|---|---|---|---|")
    for place in range(4):  # verb, scene, style, share of the style's own time
        for value in dict.fromkeys(row[place] for row in rows):
            label = "%g ×" % value if place == 3 else value
            line(label, [row for row in rows if row[place] == value])
    line("all", rows)
    print("\n%s, %d threads, load %.1f at the end; %s, %d runs of each." % (
        runs.processor(), os.cpu_count(), os.getloadavg()[0], arguments.size, arguments.repeats))


if __name__ == "__main__":
    sys.exit(main())
