#!/usr/bin/env python3
"""Does the ranking by figures agree with the eye? Six pairs of pictures for docs/tradeoff.md.

    /usr/bin/python3 bench/tradeoff_pairs.py --choose       # after `make tradeoff`: picks the pairs, sides by lot
    /usr/bin/python3 bench/tradeoff_pairs.py                # draws out/tradeoff/pairs/*.png, without names
    /usr/bin/python3 bench/tradeoff_pairs.py --write-docs   # sheet and table, with the eye's choices

Of each of three samples two pairs are taken: the neighbours on the front that lie farthest apart in `both`; and, of all
pairs that `both` and `energy` rank the other way round, the one that they disagree about most: the smaller of the two
relative differences is the largest. Which picture is A is decided by a hash, so that the viewer cannot know it. Look,
write "A" or "B" at "eye" and a reason into tradeoff_pairs.json, and only then ask for the table.
"""

import argparse
import hashlib
import itertools
import json
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True

from marked_pages import replaced

ROOT = Path(__file__).resolve().parent.parent
PAIRS = ROOT / "bench/tradeoff_pairs.json"
# The part that is shown, and the paint it is compared with, at the size at which it was used.
SAMPLES = {
    "suzanne-oil": ("560x360+200+80", ["oil/lit.png"]),
    "stilllife-plein-air": ("560x360+250+160", ["plein-air/lit.png", "plein-air/shade.png"]),
    "toys-graphite": ("560x360+180+60", ["graphite/lit.png"]),
}
FIGURES = ("both", "energy")


def ways_of(reports, name):
    report = json.loads((reports / name / "tradeoff.json").read_text(encoding="utf-8"))
    ways = {way["way"]: way for way in report["ways"] if way["both"] and way["picture"] and way["axis"] != "seed"}
    return ways, report["front"]


def mean(way, figure):
    return way[figure]["mean"]


def apart(a, b, figure):
    """How far b lies above a, of their mean."""
    return 2.0 * (mean(b, figure) - mean(a, figure)) / (mean(a, figure) + mean(b, figure))


def neighbours(ways, front):
    return max(zip(front, front[1:]), key=lambda pair: mean(ways[pair[0]], "both") - mean(ways[pair[1]], "both"))


def disputed(ways):
    def dispute(pair):
        both, energy = (apart(ways[pair[0]], ways[pair[1]], figure) for figure in FIGURES)
        return min(abs(both), abs(energy)) if both * energy < 0.0 else -1.0
    return max(itertools.combinations(ways, 2), key=dispute)


def choose(reports):
    pairs = []
    for name in SAMPLES:
        ways, front = ways_of(reports, name)
        for rule, pair in (("neighbours on the front", neighbours(ways, front)),
                           ("`both` and `energy` disagree", disputed(ways))):
            if hashlib.sha256((name + rule + "".join(pair)).encode()).digest()[0] % 2:
                pair = pair[::-1]
            pairs.append({"sample": name, "rule": rule, "A": pair[0], "B": pair[1], "eye": "", "why": ""})
    PAIRS.write_text(json.dumps(pairs, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def draw(arguments):
    subprocess.run(["oiiotool", "--nosoftwareattrib"] + [str(argument) for argument in arguments], check=True)


def panel(file, piece, output):
    """A part of a picture; transparent pixels become light grey."""
    size = piece.split("+")[0]
    channels = subprocess.run(["oiiotool", str(file), "--echo", "{TOP.nchannels}"], capture_output=True, text=True,
                              check=True)
    grey = ["--premult", "--create", size, "4", "--addc", "0.93,0.93,0.93,1",
            "--over"] if int(channels.stdout) == 4 else []
    draw([file, "--cut", piece] + grey + ["--ch", "R,G,B", "-o", output])
    return output


def draw_pair(reports, number, pair, folder):
    """Exemplar, A and B side by side."""
    ways, _ = ways_of(reports, pair["sample"])
    piece, exemplars = SAMPLES[pair["sample"]]
    parts, width = [], 360 // len(exemplars)
    for i, exemplar in enumerate(exemplars):
        half = folder / "half.png"
        draw([ROOT / "exemplars" / exemplar, "--resize", "512x512", "--ch", "R,G,B", "-o", half])
        parts.append(panel(half, "%dx360+%d+60" % (width, 76 + i * width), folder / ("paint%d.png" % i)))
    for side in "AB":
        picture = reports / pair["sample"] / "pictures" / ways[pair[side]]["picture"]
        parts.append(panel(picture, piece, folder / ("side%s.png" % side)))
    row = folder / ("pair%d.png" % number)
    draw(["--create", "1504x396", "3", "--addc", "0.97,0.97,0.97", "-o", row])
    at = 4
    for i, part in enumerate(parts):
        draw([part, row, "--paste", "+%d+28" % at, "-o", row])
        if i >= len(exemplars):
            draw([row, "--text:x=%d:y=21:size=18:font=DejaVuSans:color=0.1,0.1,0.1" % (at + 4),
                  "%d %s" % (number, "AB"[i - len(exemplars)]), "-o", row])
        at += (width if i < len(exemplars) else 560) + (0 if i + 1 < len(exemplars) else 8)
    return row


def ranked(ways, pair, figure):
    return "A" if mean(ways[pair["A"]], figure) < mean(ways[pair["B"]], figure) else "B"


def table(reports, pairs):
    lines = ["| pair | | A | B | `both` of A, B | `energy` of A, B | nearer by `both` | by `energy` | by eye | why |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    agreed = dict.fromkeys(FIGURES, 0)
    for number, pair in enumerate(pairs, 1):
        ways, _ = ways_of(reports, pair["sample"])
        if pair["eye"] not in ("A", "B"):
            sys.exit("%s: pair %d has no verdict: look at it, and write A or B at \"eye\"" % (PAIRS, number))
        cells = ["%d" % number, "%s, %s" % (pair["sample"], pair["rule"]), pair["A"], pair["B"]]
        cells += ["%.3f, %.3f" % tuple(mean(ways[pair[side]], figure) for side in "AB") for figure in FIGURES]
        for figure in FIGURES:
            cells.append(ranked(ways, pair, figure))
            agreed[figure] += ranked(ways, pair, figure) == pair["eye"]
        lines.append("| %s |" % " | ".join(cells + ["**%s**" % pair["eye"], pair["why"]]))
    counts = "`both` agrees with the eye in %d of %d pairs, `energy` in %d." % (agreed["both"], len(pairs),
                                                                                agreed["energy"])
    return "\n".join(lines + ["", counts, ""])


def sheet(rows):
    """All pairs as a JPEG of at most 700 kB."""
    file = ROOT / "docs/gallery/tradeoff-pairs.jpg"
    for quality in (84, 78, 72, 66, 60, 54):
        draw(rows + ["--mosaic", "1x%d" % len(rows), "--compression", "jpeg:%d" % quality, "-o", file])
        if file.stat().st_size <= 700000:
            return
    sys.exit("%s is larger than 700 kB: show smaller pieces" % file)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--choose", action="store_true", help="pick the pairs anew and forget the verdicts")
    parser.add_argument("--reports", type=Path, default=ROOT / "out/tradeoff",
                        help="folder that make tradeoff wrote to")
    parser.add_argument("--write-docs", action="store_true", help="put sheet and table into docs/tradeoff.md")
    options = parser.parse_args()
    if options.choose:
        choose(options.reports)
    folder = options.reports / "pairs"
    folder.mkdir(parents=True, exist_ok=True)
    pairs = json.loads(PAIRS.read_text(encoding="utf-8"))
    rows = [draw_pair(options.reports, number, pair, folder) for number, pair in enumerate(pairs, 1)]
    if options.write_docs:
        page = ROOT / "docs/tradeoff.md"
        page.write_text(replaced(page, page.read_text(encoding="utf-8"), "pairs", "bench/tradeoff_pairs.py",
                                 table(options.reports, pairs)),
                        encoding="utf-8")
        sheet(rows)


main()
