#!/usr/bin/env python3
"""The work that five kinds of styles cause, by the program's own counters: the table of docs/required.md.

    /usr/bin/python3 bench/required.py --program build/scumble [--write-docs | --check]

Bytes allocated are counted by build/tests/liballocation_counter.so, which replaces the C library's own functions.

Without an option the table goes to standard output. --write-docs puts it into the page. --check fails, exit code 1,
where a row holds other layers, a figure of the page that is 0 is no longer, one that counts, or what is allocated, has
moved by more than 0.1 %, or the file's size by 2 %.
"""

import argparse
import json
import shutil
import struct
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True

from runs import run

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/required.md"
BEGIN, END = "<!-- table: begin, written by bench/required.py -->\n", "<!-- table: end -->"
SIZE = (480, 270)
PATH_SAMPLES = 8
PLANE_BYTES = 4 * SIZE[0] * SIZE[1]  # of one float a pixel
# Embree's trees are wider on later instruction sets, and take 0.3 % more or less; an instruction set that every machine
# has gives equal ones.
ISA = "sse2"
# Remaining differences between machines: light paths may turn elsewhere, in some of a million. Allocations agree to
# 0.01 MB from run to run; the tolerance is at most half of a plane, so that one buffer of a float a pixel shows. Files
# differ by the version of the compressing library.
MOST_MOVED, MOST_WRITTEN, MOST_ALLOCATED = 0.001, 0.02, 0.5e-6 * PLANE_BYTES

# Title, scene, arguments.
ROWS = [
    ("normals only", "sun", ["stylize", "--style", "oil"]),
    ("illuminated, a sun", "sun", ["stylize", "--style", "chiaroscuro"]),
    ("illuminated, an area light", "area", ["stylize", "--style", "chiaroscuro"]),
    ("colorized", "sun", ["stylize", "--style", "tinted-oil"]),
    ("full light paths", "sun", ["guidegen", "--samples", PATH_SAMPLES, "--layers",
                                  "lpe.full,lpe.LDE,lpe.LSE,lpe.LDDE,lpe.LD12E"]),
]
COLUMNS = ["primary rays", "shadow rays", "bounced rays", "light samples", "materials", "texture look-ups",
           "textures decoded", "layers", "planes", "planes, MB", "allocated, MB", "written, MB"]


def with_one_light(source, target, is_area):
    """A copy of a .glb with its first light alone, or an area light in its place."""
    data = source.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf, rest = json.loads(data[20:20 + length]), data[20 + length:]
    lamps = [node for node in gltf["nodes"] if "KHR_lights_punctual" in node.get("extensions", {})]
    for lamp in lamps[1:]:
        del lamp["extensions"]
    if is_area:
        lamps[0]["extras"] = {"scumble": {"lamp": {"type": "AREA", "energy": 400.0, "color": [1.0, 1.0, 1.0],
                                                   "shape": "SQUARE", "size": 1.0, "size_y": 1.0}}}
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    target.write_bytes(head + text + rest)


def layers_of(title, told):
    """Names of the layers that the guides held, from the run's plan; its other lines are steps. A plan is only an
    announcement: so the layers' channels must be the planes that were counted, and a file of guides must list them."""
    names = [item["layer"] for item in told["plan"] if item["reason"].startswith(("always written", "asked for"))]
    channels = sum(3 if name in ("normal", "albedo") or name.startswith("lpe.") else 1 for name in names)
    planes = told["work"]["plane_bytes"] / PLANE_BYTES
    if channels != planes or told.get("layers", ", ".join(names)) != ", ".join(names):
        sys.exit("%s: planned are %s, of %d channels; there are %g planes, and the file has %s"
                 % (title, ", ".join(names), channels, planes, told.get("layers", "no guides")))
    return ", ".join(names)


def measure(program, counter):
    if not counter.is_file():
        sys.exit("%s is not there: build it, cmake --preset release -DSCUMBLE_TESTS=ON && "
                 "cmake --build build --target allocation_counter" % counter)
    rows = []
    with tempfile.TemporaryDirectory(prefix="scumble-required-") as scratch:
        scenes = {name: Path(scratch) / (name + ".glb") for name in ("sun", "area")}
        for name, path in scenes.items():
            with_one_light(ROOT / "scenes/stilllife.glb", path, name == "area")
        preloaded = Path(shutil.copy(counter, scratch))  # paths with spaces or colons do not work in the loader
        for title, scene, (verb, *arguments) in ROWS:
            output = Path(scratch) / ("out.png" if verb == "stylize" else "out.exr")
            allocated = Path(scratch) / ("allocated-" + title)
            # One thread, because each further one has its own memory. An empty cache of its own, so that everything is
            # made anew.
            told = json.loads(run([program, verb, scenes[scene], *arguments, "--size", "%dx%d" % SIZE, "--json",
                                   "--quiet",
                                   "--threads", 1, "--isa", ISA, "--explain", "-o", output], LD_PRELOAD=str(preloaded),
                                  SCUMBLE_ALLOCATED_TO=str(allocated), XDG_CACHE_HOME=scratch + "/cache-" + title)[2])
            if not allocated.exists():
                sys.exit("%s was not loaded into %s: it must be built for the same machine, and %s allow programs, "
                         "without a space or colon in its path" % (counter, program, scratch))
            rays, work = told["rays"], told["work"]
            rows.append((title, [rays["primary"], rays["shadow"], rays["bounce"], work["light_samples"],
                                 work["materials"],
                                 work["texture_lookups"], work["textures_decoded"],
                                 layers_of(title, told), work["plane_bytes"] // PLANE_BYTES, work["plane_bytes"] * 1e-6,
                                 int(allocated.read_text()) * 1e-6, work["bytes_written"] * 1e-6]))
    return rows


def text_of(value):
    if isinstance(value, str):
        return value
    return "%.2f" % value if isinstance(value, float) else "{:,}".format(value)


def table(rows):
    lines = ["| | " + " | ".join(COLUMNS) + " |", "|---" * (len(COLUMNS) + 1) + "|"]
    return "\n".join(lines + ["| %s | %s |" % (title, " | ".join(map(text_of, values)))
                              for title, values in rows]) + "\n"


def parts_of_page():
    text = PAGE.read_text(encoding="utf-8")
    if BEGIN not in text or END not in text:
        sys.exit("%s: the lines «%s» and «%s» are not there: put them back around the table"
                 % (PAGE, BEGIN.strip(), END))
    head, rest = text.split(BEGIN, 1)
    return head, *rest.split(END, 1)


def is_near(name, cell, value):
    """Whether a measured value is that of the page's cell."""
    if isinstance(value, str):
        return value == cell
    expected = float(cell.replace(",", ""))
    allowed = (MOST_WRITTEN if name == "written, MB" else MOST_MOVED) * expected
    if name == "allocated, MB":
        allowed = min(allowed, MOST_ALLOCATED)
    return abs(value - expected) <= allowed + (0.005 if isinstance(value, float) else 0)


def check(rows, other_libraries):
    stands = [[cell.strip() for cell in line.strip("|").split("|")]
              for line in parts_of_page()[1].strip().split("\n")[2:]]
    wrong = [] if [row[0] for row in stands] == [title for title, _ in rows] else ["the page has other rows"]
    for row, (title, values) in zip(stands, rows):
        if len(row) != len(values) + 1:
            wrong.append("%s: %d columns, expected %d" % (title, len(row), len(values) + 1))
        for name, cell, value in zip(COLUMNS, row[1:], values):
            if not (other_libraries and name == "allocated, MB") and not is_near(name, cell, value):
                wrong.append("%s: %s, the page has %s, measured %s" % (title, name, cell, text_of(value)))
    if wrong:
        sys.exit("\n".join(wrong) + "\nfind what is paid for in vain, or write the page anew with --write-docs")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "build/scumble", help="the program to measure")
    parser.add_argument("--counter", type=Path, default=ROOT / "build/tests/liballocation_counter.so",
                        help="the library that counts what is allocated")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--write-docs", action="store_true", help="put the table into docs/required.md")
    what.add_argument("--check", action="store_true", help="compare with docs/required.md")
    parser.add_argument("--other-libraries", action="store_true",
                        help="with --check: not what is allocated, because the page has it with Debian 12's libraries")
    options = parser.parse_args()
    rows = measure(options.program.resolve(), options.counter.resolve())
    if options.check:
        check(rows, options.other_libraries)
    elif options.write_docs:
        head, _, tail = parts_of_page()
        PAGE.write_text(head + BEGIN + table(rows) + END + tail, encoding="utf-8")
    else:
        print(table(rows), end="")


if __name__ == "__main__":
    main()
