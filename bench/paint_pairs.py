#!/usr/bin/env python3
"""Pairs of pictures to be judged by eye alone, for choosing a measure of paint (docs/paint-texture.md).

    /usr/bin/python3 bench/paint_pairs.py                    # agreement of the readings, and of figures, on all sets
    /usr/bin/python3 bench/paint_pairs.py --choose later     # the pairs of a set anew: forgets its votes
    /usr/bin/python3 bench/paint_pairs.py --draw later       # pictures, sheets without names, into out/paint-pairs/
    /usr/bin/python3 bench/paint_pairs.py --measure later    # figures of what is drawn (build/bench/paint_figures)
    /usr/bin/python3 bench/paint_pairs.py --read later FILE  # a reading: {"121": ["A", "why"], …}
    /usr/bin/python3 bench/paint_pairs.py --table            # the table of docs/paint-texture.md, of today's styles
    /usr/bin/python3 bench/paint_pairs.py --styles           # its table of votes for and against new keys
    /usr/bin/python3 bench/paint_pairs.py --failures         # the picture of that page: where the measure is wrong

Sets of pairs of ways to draw a painting on a scene, good ones and deliberately bad ones: 120 *open* pairs by which the
measure was chosen, 80 *locked* ones that were kept away until it was, and *later* ones that were drawn and read long
after. Every third pair holds the style as it is. Which pairs, which side is A and what part is shown is decided by
hashes. A sheet shows the exemplar beside A and B, at the size at which it is used. Whoever reads the sheets must not
have seen anything else. One reading is a vote for each pair with a reason. Figures are those of what the sheet shows:
of a part, if it shows a part. Styles have changed since the first two sets were drawn.
"""

import argparse
import hashlib
import json
import re
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True

import numpy as np
import OpenImageIO as oiio

from marked_pages import replaced

ROOT = Path(__file__).resolve().parent.parent
PAIRS = ROOT / "bench/paint_pairs.json"
FIGURES = ROOT / "bench/paint_figures.json"
OUT = ROOT / "out/paint-pairs"
OPEN = [("oil", "suzanne"), ("watercolour", "snail"), ("graphite", "toys"), ("gouache", "stilllife"),
        ("pastel", "toys"), ("ink", "suzanne"), ("plein-air", "stilllife"), ("charcoal", "snail"),
        ("woodcut", "suzanne"), ("coloured-pencil", "snail")]
LOCKED = [("chiaroscuro", "toys"), ("sanguine", "suzanne"), ("sumi-e", "snail"), ("pointillism", "stilllife"),
          ("scene-oil", "toys"), ("oil", "stilllife"), ("watercolour", "toys"), ("pastel", "snail"),
          ("plein-air", "suzanne"), ("gouache", "suzanne")]
LATER = [("ink", "toys"), ("charcoal", "stilllife"), ("woodcut", "snail"), ("coloured-pencil", "suzanne"),
         ("graphite", "suzanne"), ("sanguine", "snail"), ("sumi-e", "toys"), ("chiaroscuro", "stilllife"),
         ("pointillism", "suzanne"), ("watercolour", "stilllife"), ("gouache", "toys"), ("oil", "snail")]
SETS = {"open": (OPEN, 12), "locked": (LOCKED, 8), "later": (LATER, 8)}  # pairs of each painting and scene
CROPS = {"snail": [(380, 60), (130, 180), (330, 240)], "stilllife": [(280, 140), (480, 60), (400, 240)],
         "suzanne": [(280, 30), (60, 240), (400, 240)], "toys": [(230, 20), (60, 220), (420, 150)]}
CROP = 300
WAYS = {  # options of `scumble transfer`; a name in capitals: what is done to the exemplar or the picture besides
    "as it is": [],
    "another seed": ["--seed", "7"],
    "Lit Sphere": ["method=litsphere"],
    "threshold 0.4": ["threshold=0.4"],
    "threshold 0.25": ["threshold=0.25"],
    "threshold 0.03": ["threshold=0.03"],
    "blend_radius 0": ["blend_radius=0"],
    "blend_radius 4": ["blend_radius=4"],
    "blend_radius 8": ["blend_radius=8"],
    "hybrid 8": ["hybrid=8"],
    "hybrid 8, threshold 0.25": ["hybrid=8", "threshold=0.25"],
    "levels 4": ["levels=4"],
    "variety 30": ["variety=30"],
    "strokes of half the size": ["scale=0.5"],
    "strokes of twice the size": ["scale=2"],
    "guides of half the size": ["HALF", "--upsample", "2"],
    "picture of half the size": ["HALF", "STRETCH"],
    "flat fill": ["method=litsphere", "FLAT"],
    "blurred": ["BLUR"],
    "noise of the right spectrum": ["method=litsphere", "NOISE"],
    "mosaic": ["threshold=0.6", "blend_radius=0", "hybrid=0"],
    "repeats": ["method=litsphere", "REPEATS"],
}
GREY = 0.93
TABLE = [("oil", "suzanne"), ("graphite", "toys"), ("watercolour", "snail")]
TABLE_WAYS = ["as it is", "another seed", "Lit Sphere", "mosaic", "hybrid 8", "threshold 0.4", "threshold 0.03",
              "blend_radius 8", "blend_radius 0", "strokes of half the size", "strokes of twice the size"]
FAILURES = [193, 285, 263, 237, 219]
KEYS_THEN = {"gouache": ["threshold=0.1", "blend_radius=1"],  # that changed after these pairs were read
             "graphite": ["threshold=0.17", "hybrid=0"]}


def lot(*parts):
    """A whole number that parts decide."""
    return int.from_bytes(hashlib.sha256(" ".join(map(str, parts)).encode()).digest()[:6], "big")


def choose(pairs, of):
    samples, count = SETS[of]
    others = [pair for pair in pairs if pair["set"] != of]
    before = sum(len(SETS[name][0]) * SETS[name][1] for name in list(SETS)[:list(SETS).index(of)])
    pairs = []
    for style, scene in samples:
        chosen = set()
        while len(chosen) < count:
            pairs.append(chosen_pair(style, scene, of, chosen, before + len(pairs)))
    save(sorted(others + pairs, key=lambda pair: list(SETS).index(pair["set"])))


def chosen_pair(style, scene, of, chosen, count):
    """One that is not among the `chosen`, which it joins. `count`: of pairs before it."""
    turn = len(chosen)
    names = sorted(WAYS, key=lambda way: lot(style, scene, turn, way, count))
    two = ["as it is", next(name for name in names if name != "as it is")] if turn % 3 == 0 else names[:2]
    two.sort(key=lambda way: lot("side", style, scene, turn, way))
    salt = 0
    while frozenset(two) in chosen:
        salt += 1
        two = sorted(WAYS, key=lambda way: lot(style, scene, turn, way, salt))[:2]
    chosen.add(frozenset(two))
    crop = CROPS[scene][lot("crop", style, turn) % 3] if turn % 2 else None
    return {"style": style, "scene": scene, "A": two[0], "B": two[1], "crop": crop, "set": of, "votes": []}


def save(pairs):
    rows = ",\n ".join(json.dumps(pair, ensure_ascii=False) for pair in pairs)
    PAIRS.write_text("[%s]\n" % rows, encoding="utf-8")


def read(path):
    pixels = oiio.ImageInput.open(str(path)).read_image(format="float")
    return np.clip(pixels, 0.0, 1.0)


def write(path, pixels):
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "uint16")
    output = oiio.ImageOutput.create(str(path))
    output.open(str(path), spec)
    output.write_image(np.ascontiguousarray(pixels, dtype=np.float32))
    output.close()


def blurred(pixels, sigma):
    """Gaussian over rows and columns; borders are repeated."""
    reach = int(3 * sigma + 1)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    weights /= weights.sum()
    for axis in (0, 1):
        padded = np.pad(pixels, [(reach, reach) if a == axis else (0, 0) for a in range(3)], mode="edge")
        length = pixels.shape[axis]
        pixels = sum(w * np.take(padded, range(k, k + length), axis) for k, w in enumerate(weights))
    return pixels


def without_strokes(exemplar, way):
    """The exemplar's tone alone, or with a detail that is not its own."""
    size = exemplar.shape[0]
    color, rest = exemplar[..., :3], exemplar[..., 3:]
    tone = blurred(color, size / 40)
    detail = color - tone
    if way == "FLAT":
        color = blurred(color, size / 12)
    elif way == "NOISE":  # the detail's spectrum, in phases by chance
        phases = np.angle(np.fft.fft2(np.random.default_rng(1).standard_normal((size, size))))
        color = tone + np.real(np.fft.ifft2(np.abs(np.fft.fft2(detail, axes=(0, 1)))
                                            * np.exp(1j * phases)[..., None], axes=(0, 1)))
    else:  # one piece of the detail over and over
        piece = size // 14
        at = int(0.42 * size)
        tile = detail[at:at + piece, at:at + piece]
        count = size // piece + 1
        color = tone + np.tile(tile, (count, count, 1))[:size, :size]
    return np.concatenate([np.clip(color, 0.0, 1.0), rest], -1)


def style_folder(style, way):
    """The style itself, or a copy with other exemplars."""
    own = ROOT / "exemplars" / style
    if way not in ("FLAT", "NOISE", "REPEATS"):
        return own
    folder = OUT / "styles" / ("%s-%s" % (style, way.lower()))
    if not folder.exists():
        folder.mkdir(parents=True)
        for file in own.iterdir():
            is_painting = file.suffix == ".png" and 'image = "%s"' % file.name in (own / "style.toml").read_text()
            if is_painting:
                write(folder / file.name, without_strokes(read(file), way))
            else:
                (folder / file.name).write_bytes(file.read_bytes())
    return folder


def scumble(*arguments):
    done = subprocess.run([str(ROOT / "build/scumble"), *map(str, arguments), "-q"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("scumble %s\n%s" % (" ".join(map(str, arguments)), done.stderr))


def guides(style, scene, height):
    file = OUT / ("guides-%s-%s-%d.exr" % (style, scene, height))
    if not file.exists():
        scumble("guidegen", ROOT / "scenes" / (scene + ".glb"), "--style", ROOT / "exemplars" / style,
                "--size", "%dx%d" % (height * 16 // 9, height), "-o", file)
    return file


def picture_file(style, scene, way, height, keys=()):
    """Without paper. `keys`: of the style, before those of the way."""
    name = "-".join([style, scene, str(height), way.replace(" ", "_").replace(",", ""), *keys])
    file = OUT / "pictures" / (name + ".png")
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        marks = [part for part in WAYS[way] if part.isupper()]
        options = ["--set", "transfer.paper="]
        for part in [*keys, *WAYS[way]]:
            if "=" in part:
                options += ["--set", "transfer." + part]
            elif not part.isupper():
                options += [part]
        rendered = height // 2 if "HALF" in marks else height
        scumble("transfer", guides(style, scene, rendered), "--style",
                style_folder(style, marks[-1] if marks else ""), *options, "-o", file)
        if "STRETCH" in marks:
            subprocess.run(["oiiotool", str(file), "--resize", "%dx%d" % (height * 16 // 9, height), "-o", str(file)],
                           check=True)
        if "BLUR" in marks:
            subprocess.run(["oiiotool", str(file), "--blur", "5x5", "-o", str(file)], check=True)
    return file


def picture(style, scene, way, height, keys=()):
    """On light grey: (height, width, 3)."""
    pixels = read(picture_file(style, scene, way, height, keys))
    alpha = pixels[..., 3:]
    return pixels[..., :3] * alpha + GREY * (1.0 - alpha)


def exemplar_part(style, height, size):
    """The first painting as it is used at that height, or its part on the left above the middle."""
    at_height = OUT / ("exemplar-%s-%d.png" % (style, height))
    if not at_height.exists():
        toml = (ROOT / "exemplars" / style / "style.toml").read_text(encoding="utf-8")
        scale = next((float(line.split("=")[1]) for line in toml.splitlines() if line.startswith("scale =")), 1.0)
        lit = ROOT / "exemplars" / style / "lit.png"
        side = round(read(lit).shape[0] * scale * height / 1080)
        subprocess.run(["oiiotool", str(lit), "--resize", "%dx%d" % (side, side), "-o", str(at_height)], check=True)
    pixels = read(at_height)
    if pixels.shape[2] == 4:
        pixels = pixels[..., :3] * pixels[..., 3:] + GREY * (1.0 - pixels[..., 3:])
    side = pixels.shape[0]
    x, y = max(0, min(side - size, side // 6)), max(0, min(side - size, side // 8))
    part = pixels[y:y + size, x:x + size, :3]
    panel = np.full((size, size, 3), 0.97)
    panel[:part.shape[0], :part.shape[1]] = part
    return panel


def draw_row(pair, keys=()):
    if pair["crop"]:
        x, y = pair["crop"]
        sides = [picture(pair["style"], pair["scene"], pair[s], 540, keys)[y:y + CROP, x:x + CROP] for s in "AB"]
        panels = [exemplar_part(pair["style"], 540, CROP)] + sides
    else:
        sides = [picture(pair["style"], pair["scene"], pair[s], 360, keys) for s in "AB"]
        panels = [exemplar_part(pair["style"], 360, 360)] + sides
    gap = np.full((panels[0].shape[0], 8, 3), 0.97)
    row = np.concatenate([panels[0], gap, panels[1], gap, panels[2]], 1)
    head = np.full((26, row.shape[1], 3), 0.97)
    return np.concatenate([head, row], 0), panels[0].shape[1] + 8, panels[1].shape[1] + 8


def draw(pairs, of):
    """Two whole pictures or three crops a sheet."""
    (OUT / "sheets").mkdir(parents=True, exist_ok=True)
    for is_crop, rows_a_sheet in ((False, 2), (True, 3)):
        numbers = [i for i, pair in enumerate(pairs) if bool(pair["crop"]) == is_crop and pair["set"] == of]
        for begin in range(0, len(numbers), rows_a_sheet):
            part = numbers[begin:begin + rows_a_sheet]
            rows = [draw_row(pairs[i]) for i in part]
            name = "%s-%02d" % ("crops" if is_crop else "whole", begin // rows_a_sheet + 1)
            file = OUT / "sheets" / (name + ".png")
            write(OUT / "sheet.png", np.concatenate([row for row, _, _ in rows], 0))
            texts, top = [], 0
            for i, (row, a, width) in zip(part, rows):
                for side, x in (("exemplar", 4), ("%d A" % (i + 1), a), ("%d B" % (i + 1), a + width)):
                    texts.append("--text:x=%d:y=%d:size=18:font=DejaVuSans:color=0.1,0.1,0.1" % (x + 4, top + 19))
                    texts.append(side)
                top += row.shape[0]
            subprocess.run(["oiiotool", str(OUT / "sheet.png"), *texts, "-d", "uint8", "-o", str(file)], check=True)
            print(file, ", ".join(str(i + 1) for i in part), flush=True)


def add_reading(pairs, of, path):
    votes = json.loads(Path(path).read_text(encoding="utf-8"))
    for number, pair in enumerate(pairs, 1):
        if pair["set"] != of:
            continue
        vote = votes.get(str(number))
        if not vote or vote[0] not in ("A", "B", "=") or not vote[1].strip():
            sys.exit("%s: pair %d: expected [\"A\", \"B\" or \"=\", a reason], found %s" % (path, number, vote))
        pair["votes"].append(vote)
    save(pairs)


def figures_of(style, scene, height, arguments):
    """What paint_figures prints of pictures, a dictionary each."""
    done = subprocess.run([str(ROOT / "build/bench/paint_figures"), str(ROOT / "exemplars" / style),
                           str(guides(style, scene, height)), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return [json.loads(line) for line in done.stdout.splitlines()]


def measure(pairs, of):
    """The figures of what the sheets of a set show, whole pictures or parts."""
    wanted = {}
    for pair in pairs:
        if pair["set"] != of:
            continue
        for side in "AB":
            wanted.setdefault((pair["style"], pair["scene"], tuple(pair["crop"] or ())), set()).add(pair[side])
    figures = json.loads(FIGURES.read_text(encoding="utf-8"))
    for (style, scene, crop), ways in sorted(wanted.items()):
        height = 540 if crop else 360
        files = {str(picture_file(style, scene, way, height)): way for way in sorted(ways)}
        part = ["--part", *crop, CROP] if crop else []
        for line in figures_of(style, scene, height, [*part, *files]):
            way = files[line.pop("picture")]
            del line["halves"]
            figures[key_of(style, scene, crop) + way] = {k: round(v, 4) for k, v in line.items()}
        print(style, scene, *crop, flush=True)
    rows = ",\n ".join("%s: %s" % (json.dumps(name), json.dumps(of)) for name, of in sorted(figures.items()))
    FIGURES.write_text("{%s}\n" % rows, encoding="utf-8")


def key_of(style, scene, crop):
    return "%s %s %s " % (style, scene, "%d,%d" % tuple(crop) if crop else "whole")


def agreement(pairs, of):
    """By figure: in how many pairs the smaller one is on the side that a majority chose, of those on which all readings
    agree, and of all that a majority decided."""
    figures = json.loads(FIGURES.read_text(encoding="utf-8"))
    part = [pair for pair in pairs if pair["set"] == of and majority(pair)]
    print("%s: %d pairs that a majority decided, %d of them unanimously" % (of, len(part), sum(map(is_agreed, part))))
    for name in ("energy", "both", "missing", "paint", "texture"):
        def agrees(pair):
            a, b = (figures[key_of(pair["style"], pair["scene"], pair["crop"]) + pair[side]][name] for side in "AB")
            return ("A" if a < b else "B") == majority(pair)
        agreed = [pair for pair in part if is_agreed(pair)]
        print("%-8s %3.0f%% of all, %3.0f%% of the unanimous" % (name, 100 * sum(map(agrees, part)) / len(part),
                                                              100 * sum(map(agrees, agreed)) / len(agreed)))
        wrong = [i + 1 for i, pair in enumerate(pairs) if pair in agreed and not agrees(pair)]
        print("         wrong where all agree: " + ", ".join(map(str, wrong)))


def majority(pair):
    """The side that more readings chose; none where they are even."""
    sides = [vote[0] for vote in pair["votes"]]
    a, b = sides.count("A"), sides.count("B")
    return "A" if a > b else "B" if b > a else None


def is_agreed(pair):
    return {vote[0] for vote in pair["votes"]} in ({"A"}, {"B"})


def report(pairs, of):
    part = [pair for pair in pairs if pair["set"] == of]
    readings = len(part[0]["votes"])
    print("%s: %d pairs, %d readings; all readings agree on %d, a majority chose in %d"
          % (of, len(part), readings, sum(map(is_agreed, part)), sum(majority(pair) is not None for pair in part)))
    for i in range(readings):
        for j in range(i):
            both = [p for p in part if "=" not in (p["votes"][i][0], p["votes"][j][0])]
            same = sum(p["votes"][i][0] == p["votes"][j][0] for p in both)
            print("readings %d and %d: the same side in %d of %d" % (j + 1, i + 1, same, len(both)))
    if readings:
        agreement(pairs, of)


def table_column(style, scene):
    """Figures of one column, at 960×540: halves of the exemplar, the ways, and what is done to the style's picture."""
    files = [picture_file(style, scene, way, 540) for way in TABLE_WAYS]
    own = read(files[0])
    for name, pixels in (("blurred by 1 pixel", blurred(own.astype(np.float64), 1)),
                         ("blurred by 3 pixels", blurred(own.astype(np.float64), 3)),
                         ("grey noise, deviation 0.05", with_noise(own, 0.05))):
        files.append(OUT / "pictures" / ("%s-%s-%s.png" % (style, scene, name.replace(" ", "_"))))
        write(files[-1], pixels)
    figures = figures_of(style, scene, 540, files)
    return [figures[0]["halves"]] + [figure["paint"] for figure in figures]


def with_noise(pixels, deviation):
    noise = np.random.default_rng(1).normal(0.0, deviation, pixels.shape[:2])[..., None]
    return np.concatenate([np.clip(pixels[..., :3] + noise, 0.0, 1.0), pixels[..., 3:]], -1)


def write_table():
    columns = [table_column(style, scene) for style, scene in TABLE]
    names = (["halves of the exemplar", "**the style**"]
             + [re.sub(r"^([a-z_]+) ([0-9.]+)$", r"`\1 = \2`", way) for way in TABLE_WAYS[1:]]
             + ["blurred by 1 pixel", "blurred by 3 pixels", "grey noise, deviation 0.05"])
    rows = ["| | " + " | ".join("%s, %s" % column for column in TABLE) + " |", "|---" * (len(TABLE) + 1) + "|"]
    for name, figures in zip(names, zip(*columns)):
        cells = ["**%.3f**" % f if "**" in name else "%.3f" % f for f in figures]
        rows.append("| %s | %s |" % (name, " | ".join(cells)))
    page = ROOT / "docs/paint-texture.md"
    page.write_text(replaced(page, page.read_text(encoding="utf-8"), "ways", "bench/paint_pairs.py --table",
                             "\n".join(rows) + "\n"), encoding="utf-8")


def write_styles():
    """Votes for new keys or another painting of a style against the old, of all that were tried."""
    tried = {}
    for name in ("tuned", "repainted", "retuned"):
        for pair in json.loads((ROOT / ("bench/%s_pairs.json" % name)).read_text(encoding="utf-8"))["pairs"]:
            by_set = "keys" if name == "tuned" else "28 November"
            change = "`%s`" % "`, `".join(pair["new"]) if "new" in pair else by_set
            votes = [reading["vote"] for reading in pair["readings"]]
            tally = tried.setdefault(pair["style"], {}).setdefault(change.replace("=", " = "), [0, 0, 0])
            for i, vote in enumerate(("new", "old", "=")):
                tally[i] += votes.count(vote)
    rows = ["| style | what was new | new : old, even |", "|---|---|---|"]
    for style, changes in sorted(tried.items()):
        for change, (new, old, even) in changes.items():
            taken = "**" if new >= 4 * old else ""
            count = "%s%d : %d%s" % (taken, new, old, taken)
            rows.append("| %s | %s | %s%s |" % (style, change, count, ", %d" % even if even else ""))
    page = ROOT / "docs/paint-texture.md"
    page.write_text(replaced(page, page.read_text(encoding="utf-8"), "styles", "bench/paint_pairs.py --styles",
                             "\n".join(rows) + "\n"), encoding="utf-8")


def draw_failures(pairs):
    """Pairs in which all readers chose the picture with the larger figure: exemplar, their choice, the other."""
    figures = json.loads(FIGURES.read_text(encoding="utf-8"))
    rows, texts, top = [], [], 0
    for number in FAILURES:
        pair = dict(pairs[number - 1])
        chosen = majority(pair)
        pair["A"], pair["B"] = pair[chosen], pair["B" if chosen == "A" else "A"]
        row, a, width = draw_row(pair, KEYS_THEN.get(pair["style"], ()))
        key = key_of(pair["style"], pair["scene"], pair["crop"])
        for words, x in (("%s, %s" % (pair["style"], pair["scene"]), 4),
                         ("chosen: %s, %.3f" % (pair["A"], figures[key + pair["A"]]["texture"]), a),
                         ("not: %s, %.3f" % (pair["B"], figures[key + pair["B"]]["texture"]), a + width)):
            texts += ["--text:x=%d:y=%d:size=18:font=DejaVuSans:color=0.1,0.1,0.1" % (x + 4, top + 19), words]
        rows.append(row)
        top += row.shape[0]
    write(OUT / "sheet.png", np.concatenate(rows, 0))
    subprocess.run(["oiiotool", "--nosoftwareattrib", str(OUT / "sheet.png"), *texts, "--resize", "1240x0",
                    "-d", "uint8", "--compression", "jpeg:66", "-o", str(ROOT / "docs/gallery/paint-failures.jpg")],
                   check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--choose", choices=SETS, help="pick the pairs of a set anew and forget their votes")
    parser.add_argument("--draw", choices=SETS, help="draw pictures and sheets of these pairs")
    parser.add_argument("--measure", choices=SETS, help="measure their pictures")
    parser.add_argument("--read", nargs=2, metavar=("SET", "FILE"), help="add one reading of a set")
    parser.add_argument("--table", action="store_true", help="measure the first table of docs/paint-texture.md")
    parser.add_argument("--styles", action="store_true", help="count the votes for and against new keys of styles")
    parser.add_argument("--failures", action="store_true", help="draw the picture of docs/paint-texture.md")
    parser.add_argument("--force", action="store_true", help="choose, draw or measure a set that has votes")
    options = parser.parse_args()
    pairs = json.loads(PAIRS.read_text(encoding="utf-8"))
    anew = options.choose or options.draw or options.measure
    if anew and not options.force and any(pair["votes"] for pair in pairs if pair["set"] == anew):
        sys.exit("the pairs of this set have been read, and styles may have changed since: --force does it anyway")
    if options.choose:
        choose(pairs, options.choose)
    elif options.draw:
        draw(pairs, options.draw)
    elif options.measure:
        measure(pairs, options.measure)
    elif options.read:
        add_reading(pairs, *options.read)
    elif options.table:
        write_table()
    elif options.styles:
        write_styles()
    elif options.failures:
        draw_failures(pairs)
    else:
        for of in SETS:
            report(pairs, of)


if __name__ == "__main__":
    main()
