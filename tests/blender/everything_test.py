#!/usr/bin/python3
"""One .blend with everything in it, made by each Blender, is drawn by each that can open it, and each sees in it what
its own Cycles sees.

    everything_test.py PROGRAM [BLENDER…]      the Blender in PATH where none is named; older ones first
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Direct light is compared with few samples: what bounces, and the few glossy surfaces, are other tests' matter.
LIGHT = {("lpe", "NaN, inf or < 0"): 0.0, ("lpe.LDE", "mean difference"): 0.5, ("lpe.full", "mean difference"): 1.0}
DATA = {"A", "normal", "depth", "object", "position", "albedo"}


def run(command, **options):
    return subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          **options)


def expect(holds, *what):
    if not holds:
        sys.exit("everything_test.py: " + "\n".join(str(part) for part in what))


def version_of(blender):
    said = run([blender, "--version"]).stdout
    return next(line.split()[1] for line in said.splitlines() if line.startswith("Blender "))


def make(blender, folder):
    done = run([blender, "-b", "-noaudio", "--factory-startup", "-P", HERE / "make_everything.py", "--", "--output",
                folder])
    expect(done.returncode == 0, blender, done.stdout, done.stderr)
    return folder / "everything.blend"


def draw(program, blender, scene, frame, picture):
    return run([program, "stylize", scene, "--blender", blender, "--frame", frame, "--size", "320x180", "--style",
                "watercolour", "-q", "-o", picture])


def check(program, blender, scene):
    """Guides and direct light against the Cycles of that Blender, where everything has moved."""
    done = run([program, "crosscheck", scene, "--blender", blender, "--frame", "12", "--size", "320x180", "--samples",
                "16", "-q", "--json"])
    report = json.loads(done.stdout)
    report = report[0] if isinstance(report, list) else report
    expect(report["compared"] > 30000 and not report["skipped"], blender, scene, done.stdout)
    seen = set()
    for figure in report["figures"]:
        layer, name = figure["layer"], figure["name"]
        seen.add(layer)
        if layer in DATA:
            expect(figure["kept"], blender, scene, figure)
        elif (layer, name) in LIGHT:
            expect(figure["value"] <= LIGHT[layer, name], blender, scene, figure)
    expect(seen >= DATA | {"lpe.LDE", "lpe.full"}, seen)
    # Only what the Principled node has beyond glTF's model is lost, and half of an alpha.
    for line in report["unsupported"]:
        expect(line.startswith("material 'With ") and ("Principled" in line or "its alpha" in line), blender, scene,
               line)
    expect(len(report["unsupported"]) >= 7, report["unsupported"])


def main():
    program = Path(sys.argv[1]).resolve()
    blenders = sys.argv[2:] or ["blender"]
    versions = {blender: tuple(int(number) for number in version_of(blender).split(".")) for blender in blenders}
    with tempfile.TemporaryDirectory() as work:
        for number, maker in enumerate(blenders):
            folder = Path(work) / str(number)
            folder.mkdir()
            scene = make(maker, folder)
            for blender in blenders:
                pictures = [folder / f"{frame}.png" for frame in (1, 12)]
                if versions[blender][:2] < versions[maker][:2]:
                    done = draw(program, blender, scene, 1, pictures[0])
                    named = all(".".join(map(str, v)) in done.stderr for v in (versions[maker][:2], versions[blender]))
                    expect(named, "expected both versions in", done.stderr)
                    continue
                for frame, picture in zip((1, 12), pictures):
                    done = draw(program, blender, scene, frame, picture)
                    expect(done.returncode == 0 and os.path.getsize(picture) > 10000, blender, scene, done.stderr)
                expect(run([program, "compare", *pictures, "--fail", "0.05"]).returncode == 1, "nothing moves", scene)
                check(program, blender, scene)
                print(f"made by {versions[maker]}, drawn by {versions[blender]}: agrees")


if __name__ == "__main__":
    main()
