#!/usr/bin/env python3
"""Our speed beside Cycles', in one run on the same scene: `make bench-cycles`.

    /usr/bin/python3 bench/cycles_bench.py --scumble build/scumble [--repeats 5] [--fresh]

Both programs run alternately, so that other load of the machine slows both. Error is measured on a smaller picture
against each program's own converged one, which is kept in the output folder until --fresh: a pixel's error does not
depend on how many other pixels there are. Times are those of the large picture. Gates nothing.

Writes results.md, results.json and error.svg into the output folder.
"""

import argparse
import datetime
import json
import math
import os
import re
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from runs import Times, processor, run, say

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
BOUNCES = 8  # as in cycles_side.py
DATA_LAYERS = "position,albedo"  # on top of those that are always written
# Cycles' error at this many samples is the target of both.
TARGET_SAMPLES = 16
GOALS = {"data": 20.0, "process": 3.0, "LDE": 5.0, "full": 1.0}


class Scumble:
    name = "scumble"

    def __init__(self, program):
        self.program = program

    def render(self, mode, scene, output, size, samples=1, seed=0):
        """Seconds of the renderer itself, as it reports them (hierarchy and rays), of the whole process, and of
        processor time."""
        layers = DATA_LAYERS if mode == "data" else "lpe." + mode
        command = [self.program, "guidegen", scene, "--size", size, "--layers", layers, "--json", "--quiet", "-o",
                   output]
        if mode != "data":
            command += ["--samples", samples, "--max-bounces", BOUNCES]
        process, processor_time, text = run(command)
        ms = json.loads(text)["ms"]
        return (ms["build"] + ms["rays"]) / 1000.0, process, processor_time

    def luminance(self, mode, path):
        planes = read_channels(path)
        light = sum(w * planes["lpe.%s.%s" % (mode, c)] for w, c in zip((0.2126, 0.7152, 0.0722), "RGB"))
        return light, planes["A"] > 0.5


class Cycles:
    name = "Cycles"

    def __init__(self, program):
        self.program = [program, "-b", "-noaudio", "--factory-startup", "-P", HERE / "cycles_side.py", "--"]

    def render(self, mode, scene, output, size, samples=1, seed=0):
        """Seconds of the render as Blender prints them, without writing the file, of the whole process, and of
        processor time."""
        process, processor_time, text = run(self.program + [mode, scene, output, size, samples, seed])
        found = re.search(r"^ ?Time: (\d+):([\d.]+) \(Saving: (\d+):([\d.]+)\)", text, re.M)
        if not found or not Path(output).exists():
            sys.exit("Blender rendered nothing:\n" + text)
        minutes, seconds, saving_minutes, saving = (float(group) for group in found.groups())
        return 60 * (minutes - saving_minutes) + seconds - saving, process, processor_time

    def luminance(self, mode, path):
        planes = read_channels(path)
        light = 0.0
        for weight, c in zip((0.2126, 0.7152, 0.0722), "RGB"):
            if mode == "full":
                light = light + weight * planes["Combined." + c]
            else:
                light = light + weight * planes["DiffDir." + c] * planes["DiffCol." + c]
        return light, planes["Combined.A"] > 0.5


def read_channels(path):
    file = oiio.ImageInput.open(str(path))
    if not file:
        sys.exit("%s: %s" % (path, oiio.geterror()))
    names = file.spec().channelnames
    pixels = file.read_image("float")
    file.close()
    planes = {}
    for index, name in enumerate(names):
        planes[name.removeprefix("ViewLayer.")] = pixels[:, :, index].astype(np.float64)
    return planes


def relative_error(picture, truth, covered):
    """NRMSE: the root of the mean squared difference over the truth's mean."""
    return float(np.sqrt(np.mean((picture - truth)[covered] ** 2)) / np.mean(truth[covered]))


def measure_data(options, renderers, scene):
    """Data layers, once a pixel: the renderers' own times, and those of the whole processes."""
    kinds = ("own", "process", "processor")
    taken = {r.name: {kind: [] for kind in kinds} for r in renderers}
    for repeat in range(options.repeats):
        say("data layers, %d of %d" % (repeat + 1, options.repeats))
        for renderer in renderers:
            output = options.output / ("data.%s.exr" % renderer.name)
            for kind, seconds in zip(kinds, renderer.render("data", scene, output, options.size)):
                taken[renderer.name][kind].append(seconds)
    return {name: {kind: Times(values) for kind, values in by_kind.items()} for name, by_kind in taken.items()}


def measure_errors(options, renderer, mode, scene):
    """Error by number of samples, and the slope of its logarithm."""
    stem = "%s.%s" % (mode, renderer.name)
    converged = options.output / ("%s.converged.%s.%d.exr" % (stem, options.error_size, options.converged))
    if options.fresh or not converged.exists():
        say("%s: %s, %d samples" % (stem, options.error_size, options.converged))
        unfinished = converged.with_suffix(".part.exr")
        renderer.render(mode, scene, unfinished, options.error_size, options.converged, 1)
        unfinished.rename(converged)
    truth, covered = renderer.luminance(mode, converged)
    errors = {}
    for samples in options.samples:
        output = options.output / (stem + ".error.exr")
        renderer.render(mode, scene, output, options.error_size, samples)
        errors[samples] = relative_error(renderer.luminance(mode, output)[0], truth, covered)
    return errors


def measure_light(options, renderers, mode, scenes):
    """Times by number of samples, alternately, and the errors that go with them."""
    errors = {r.name: measure_errors(options, r, mode, scenes[r.name]) for r in renderers}
    taken = {r.name: {samples: [] for samples in options.samples} for r in renderers}
    processor_times = {r.name: {samples: [] for samples in options.samples} for r in renderers}
    for repeat in range(options.repeats):
        say("%s, %d of %d" % (mode, repeat + 1, options.repeats))
        for samples in options.samples:
            for renderer in renderers:
                output = options.output / ("%s.%s.exr" % (mode, renderer.name))
                own, _, used = renderer.render(mode, scenes[renderer.name], output, options.size, samples)
                taken[renderer.name][samples].append(own)
                processor_times[renderer.name][samples].append(used)
    return {name: {"errors": errors[name], "times": {n: Times(t) for n, t in taken[name].items()},
                   "processor": {n: Times(t) for n, t in processor_times[name].items()}} for name in taken}


def time_at(error, measured):
    """Seconds, and samples, at which a renderer reaches an error: log error is fitted over log samples, time over
    samples by a straight line. One sample is the minimum: a renderer that beats the target with one gets the time of
    one."""
    samples = np.array(sorted(measured["errors"]), float)
    slope, start = np.polyfit(np.log(samples), np.log([measured["errors"][n] for n in samples]), 1)
    needed = max(1.0, math.exp((math.log(error) - start) / slope))
    per_sample, fixed = np.polyfit(samples, [measured["times"][n].median for n in samples], 1)
    processor_time = np.polyfit(samples, [measured["processor"][n].median for n in samples], 1)[0]
    return {"seconds": max(fixed, 0.0) + per_sample * needed, "samples": needed, "slope": float(slope),
            "processor": processor_time * needed}


def at_equal_error(measured):
    cycles = measured["Cycles"]
    error = cycles["errors"][TARGET_SAMPLES]
    result = {"error": error, **{name: time_at(error, m) for name, m in measured.items()}}
    result["ratio"] = result["Cycles"]["seconds"] / result["scumble"]["seconds"]
    result["processor_ratio"] = result["Cycles"]["processor"] / result["scumble"]["processor"]
    return result


# ---- output --------------------------------------------------------------------------------------------------------


def verdict(kind, ratio):
    return "reached" if ratio >= GOALS[kind] else "missed"


def markdown(report, data, light, equal):
    ours, cycles = data["scumble"], data["Cycles"]
    rows = ["| what | scumble | Cycles | ratio | goal | |", "|---|---|---|---|---|---|"]
    for kind, part, what in (("data", "own", "data layers, renderer alone"),
                             ("process", "process", "data layers, whole process")):
        ratio = report["ratios"][kind]
        rows.append("| %s | %s | %s | %.1f | ≥ %g | %s |" % (what, ours[part].text(), cycles[part].text(), ratio,
                                                             GOALS[kind],
                                                             verdict(kind, ratio)))
    for kind in ("LDE", "full"):
        e = equal[kind]
        rows.append("| `%s` at an error of %.2g | %.3g s, %.2g samples | %.3g s, %.2g samples | %.1f | ≥ %g | %s |" % (
            kind, e["error"], e["scumble"]["seconds"], e["scumble"]["samples"], e["Cycles"]["seconds"],
            e["Cycles"]["samples"], e["ratio"], GOALS[kind], verdict(kind, e["ratio"])))
    rows += ["", "| layer | samples | scumble: time | error | Cycles: time | error |", "|---|---|---|---|---|---|"]
    for kind in ("LDE", "full"):
        for n in sorted(light[kind]["Cycles"]["errors"]):
            a, b = light[kind]["scumble"], light[kind]["Cycles"]
            rows.append("| `%s` | %d | %s | %.4f | %s | %.4f |" % (kind, n, a["times"][n].text(), a["errors"][n],
                                                                    b["times"][n].text(), b["errors"][n]))
    where = report["machine"]
    rows += ["", "Processor time of the paths alone, which other programs on the machine stretch less: `LDE` %.1f, "
                 "`full` %.1f times "
             "Cycles' speed." % tuple(equal[kind]["processor_ratio"] for kind in ("LDE", "full")),
             "",
             "%s, %d threads, load before the run %.1f; %s; %s at %s, %d bounces, medians of %d runs with their "
             "quartiles."
             % (where["processor"], where["threads"], where["load"], report["date"], report["scene"], report["size"],
                BOUNCES, report["repeats"])]
    return "\n".join(rows) + "\n"


def chart(light):
    """Error against time, both axes logarithmic."""
    width, height, left, top, plot_w, plot_h = 860, 420, 60, 30, 340, 320
    colors = {"scumble": "#1b6ca8", "Cycles": "#c1440e"}
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" font-family="sans-serif" font-size="12">'
             % (width, height), '<rect width="100%" height="100%" fill="white"/>']
    for column, kind in enumerate(("LDE", "full")):
        x0 = left + column * (plot_w + 70)
        points = {name: [(m["times"][n].median, m["errors"][n]) for n in sorted(m["errors"])]
                  for name, m in light[kind].items()}
        times = [t for line in points.values() for t, _ in line]
        errors = [e for line in points.values() for _, e in line]
        x_from, x_to = math.floor(math.log10(min(times))), math.ceil(math.log10(max(times)))
        y_from, y_to = math.floor(math.log10(min(errors))), math.ceil(math.log10(max(errors)))
        x = lambda t: x0 + plot_w * (math.log10(t) - x_from) / (x_to - x_from)
        y = lambda e: top + plot_h * (1 - (math.log10(e) - y_from) / (y_to - y_from))
        parts.append('<text x="%g" y="20" font-size="14">%s</text>' % (x0, kind))
        for decade in range(x_from, x_to + 1):
            at = x(10.0 ** decade)
            parts.append('<path d="M%g %gV%g" stroke="#ccc"/><text x="%g" y="%g" text-anchor="middle">%g s</text>'
                         % (at, top, top + plot_h, at, top + plot_h + 18, 10.0 ** decade))
        for decade in range(y_from, y_to + 1):
            at = y(10.0 ** decade)
            parts.append('<path d="M%g %gH%g" stroke="#ccc"/><text x="%g" y="%g" text-anchor="end">%g</text>'
                         % (x0, at, x0 + plot_w, x0 - 6, at + 4, 10.0 ** decade))
        for row, (name, line) in enumerate(points.items()):
            path = "M" + "L".join("%.1f %.1f" % (x(t), y(e)) for t, e in line)
            parts.append('<path d="%s" fill="none" stroke="%s" stroke-width="2"/>' % (path, colors[name]))
            parts += ['<circle cx="%.1f" cy="%.1f" r="3.5" fill="%s"/>' % (x(t), y(e), colors[name]) for t, e in line]
            parts.append('<text x="%g" y="%g" fill="%s" text-anchor="end">%s</text>'
                         % (x0 + plot_w - 8, top + 18 + 16 * row, colors[name], name))
    parts.append('<text x="%g" y="%g" text-anchor="middle">render time; error is the luminance\'s NRMSE</text></svg>'
                 % (width / 2, height - 16))
    return "\n".join(parts) + "\n"


def jsonable(value):
    if isinstance(value, Times):
        return value.json()
    if isinstance(value, dict):
        return {str(key): jsonable(item) for key, item in value.items()}
    return value


def prepare(options, program):
    """The scene with pure materials, for both programs: with its own lights, and with soft ones."""
    blends = [options.output / "delta.blend", options.output / "soft.blend"]
    glbs = [path.with_suffix(".glb") for path in blends]
    if options.fresh or not all(path.exists() for path in blends + glbs):
        say("making the scenes")
        run([options.blender, "-b", "-noaudio", "--factory-startup", "-P", HERE / "cycles_side.py", "--", "make",
             options.scene] + blends)
        for blend, glb in zip(blends, glbs):
            run([options.blender, "-b", "-noaudio", "--factory-startup", "-Y", blend, "-P",
                 ROOT / "blender_scripts/export_scene.py", "--", "--output", glb])
    return {"full": {"scumble": glbs[0], "Cycles": blends[0]}, "LDE": {"scumble": glbs[1], "Cycles": blends[1]}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scumble", type=Path, default=ROOT / "build/scumble")
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--scene", type=Path, default=ROOT / "scenes/stilllife.glb")
    parser.add_argument("--output", type=Path, default=ROOT / "out/bench-cycles",
                        help="folder for pictures and results")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--error-size", default="240x135", help="of the pictures whose error is measured")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--samples", default="1,4,16,64", help="with commas between; %d is among them" % TARGET_SAMPLES)
    parser.add_argument("--converged", type=int, default=4096, help="samples of the pictures taken for the truth")
    parser.add_argument("--fresh", action="store_true", help="make the scenes and the converged pictures again")
    options = parser.parse_args()
    options.samples = [int(n) for n in options.samples.split(",")]
    if TARGET_SAMPLES not in options.samples or len(options.samples) < 2:
        parser.error("--samples needs %d and at least one more" % TARGET_SAMPLES)
    options.output = options.output.resolve()
    options.output.mkdir(parents=True, exist_ok=True)
    load = os.getloadavg()[0]

    renderers = [Scumble(options.scumble), Cycles(options.blender)]
    scenes = prepare(options, options.blender)
    data = measure_data(options, renderers, options.scene)
    light = {kind: measure_light(options, renderers, kind, scenes[kind]) for kind in ("LDE", "full")}
    equal = {kind: at_equal_error(light[kind]) for kind in light}
    report = {
        "date": datetime.date.today().isoformat(), "scene": options.scene.name, "size": options.size,
        "repeats": options.repeats, "bounces": BOUNCES,
        "machine": {"processor": processor(), "threads": os.cpu_count(), "load": load},
        "ratios": {"data": data["Cycles"]["own"].median / data["scumble"]["own"].median,
                   "process": data["Cycles"]["process"].median / data["scumble"]["process"].median,
                   "LDE": equal["LDE"]["ratio"], "full": equal["full"]["ratio"]},
        "goals": GOALS, "data": data, "light": light, "equal_error": equal,
    }
    (options.output / "results.json").write_text(json.dumps(jsonable(report), indent=2) + "\n", encoding="utf-8")
    (options.output / "error.svg").write_text(chart(light), encoding="utf-8")
    text = markdown(report, data, light, equal)
    (options.output / "results.md").write_text(text, encoding="utf-8")
    print(text, end="")


main()
