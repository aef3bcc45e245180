"""The parts of `make bench` that are separate programs: guides beside bare Embree, and the command line as a whole."""

import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

from runs import Times

ROOT = Path(__file__).resolve().parent.parent
STYLE = "exemplars/oil"


def figure(item, what, frame, unit, values, target=None, at_least=False, note="", more=None):
    """As the C++ part writes them (bench/performance/figures.h)."""
    times = Times(values)
    made = {"item": item, "what": what, "frame": frame, "unit": unit, "median": times.median, "low": times.low,
            "high": times.high, "least": min(values), "rounds": len(values)}
    if target is not None:
        made.update(target=target, at_least=at_least)
    if note:
        made["note"] = note
    if more:
        made["more"] = more
    return made


def timed(command):
    """Wall-clock seconds, bytes of memory at the peak, and the program's output."""
    begin = time.perf_counter()
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE, cwd=ROOT)
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    seconds = time.perf_counter() - begin
    if process.returncode != 0:
        sys.exit("%s\nexit code %d" % (" ".join(map(str, command)), process.returncode))
    return seconds, usage.ru_maxrss * 1024, text.decode("utf-8")


def size_of(options):
    return "160x90" if options.smoke else "1920x1080"


def stylize(options, scene, arguments, output, most_repeats=100):
    """Runs of the command line; the first one warms the disk's cache and does not count. Without --json, whose counters
    a plain run does not need."""
    command = [options.build / "scumble", "stylize", "scenes/%s.glb" % scene, "--style", STYLE, "--size",
               size_of(options),
               "--png-level", 1, "--threads", 2, "--quiet", "-o", options.scratch / output] + arguments
    repeats = 1 if options.smoke else min(options.repeats, most_repeats)
    runs = [timed(command) for _ in range(repeats + 1)][1:]
    return [seconds for seconds, _, _ in runs], [peak for _, peak, _ in runs], [text for _, _, text in runs]


def stages(reports):
    """Median milliseconds, on the wall, of each line of the tables of --timing."""
    def of(report):
        lines = [line.split() for line in report.split("wall ms", 1)[1].splitlines()[1:]]
        return {words[0]: float(words[1]) for words in lines if words and words[0] != "total"}
    return {name: statistics.median(of(report)[name] for report in reports) for name in of(reports[0])}


def measure_process(options):
    seconds, peaks, reports = stylize(options, "suzanne", ["--timing"], "picture.png")
    width, height = map(int, size_of(options).split("x"))
    pixels = width * height
    frame = "suzanne %d×%d, style oil" % (width, height)
    where = stages(reports)
    where["the rest"] = 1000.0 * statistics.median(seconds) - sum(where.values())
    return {"figures": [
        figure("7", "scumble stylize, two threads, PNG level 1", frame, "s", seconds, 0.7, more=where),
        figure("7", "its peak memory, everything included", frame, "bytes/px", [peak / pixels for peak in peaks]),
    ], "stages": where}


def measure_sequence(options):
    count = 2 if options.smoke else 24
    seconds, _, _ = stylize(options, "toys", ["--frames", "1-%d" % count], "frame.####.png", 3)
    frame = "toys %s, style oil, %d frames" % (size_of(options).replace("x", "×"), count)
    return {"figures": [figure("8", "scumble stylize --frames, a frame", frame, "s", [s / count for s in seconds],
                               0.2)]}


def benchmark(options, program, arguments):
    """Google Benchmark's records by name: of single runs, or of the aggregates if it writes no others."""
    done = subprocess.run([options.build / "bench" / program, "--benchmark_format=json",
                           "--benchmark_enable_random_interleaving=true"] + arguments, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("%s: exit code %d\n%s" % (program, done.returncode, done.stderr))
    runs = {}
    for record in json.loads(done.stdout)["benchmarks"]:
        if record.get("run_type") == "iteration" or record.get("aggregate_name") in ("median", "stddev"):
            runs.setdefault(record["run_name"].split("/repeats")[0].split("/process_time")[0], []).append(record)
    return runs


def values_of(records, key):
    """A counter's values; of aggregates the median, and one standard deviation on either side."""
    single = [record[key] for record in records if record.get("run_type") == "iteration"]
    if single:
        return single
    by_name = {record["aggregate_name"]: record[key] for record in records}
    return [by_name["median"] - by_name["stddev"], by_name["median"], by_name["median"] + by_name["stddev"]]


def measure_guides(options):
    """guidegen beside a bare Embree loop over the same triangles and rays, in turns."""
    name = "BM_GuidesAlwaysWritten/%d/1"
    arguments = ["--benchmark_filter=" + name % 1 + "|" + name % 2] + (
        ["--benchmark_min_time=0.01"] if options.smoke else [])
    runs = benchmark(options, "guidegen_bench", arguments)
    if any("ratio_cpu" not in record for threads in (1, 2) for record in runs.get(name % threads, [{}])):
        return {"figures": [], "notes": ["guidegen_bench does not print what this table needs: " + name % 1]}
    frame = "100,002 triangles 1920×1080"
    figures = []
    # On one thread by processor time, on two by the clock on the wall.
    for threads, ratio, kind in ((1, "ratio_cpu", "cpu"), (2, "ratio", "ms")):
        records = runs[name % threads]
        figures.append(figure("6", "normals, depth and ids against bare Embree, threads: %d" % threads, frame, "×",
                              values_of(records, ratio), 1.3,
                              more={key: statistics.median(values_of(records, key + "_" + kind))
                                    for key in ("bare", "guides")}))
    pair = runs[name % 2]
    figures.append(figure("6", "guides a second, two threads, hierarchy built for each", frame, "frames/s",
                          values_of(pair, "fps_with_build"), 15.0, True))
    figures.append(figure("6", "guides a second, two threads, hierarchy kept", frame, "frames/s",
                          values_of(pair, "fps")))
    return {"figures": figures}
