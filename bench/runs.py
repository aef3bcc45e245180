"""Shared code of the benches in Python: running programs, the spread of measurements, and the machine's description."""

import os
import platform
import resource
import statistics
import subprocess
import sys
import time


def run(command, **environment):
    """Seconds from start to end, seconds of processor time, and the program's output."""
    begin, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True,
                          env={**os.environ, **environment})
    seconds, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    processor_time = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode != 0:
        sys.exit("%s\nexit code %d\n%s%s" % (" ".join(map(str, command)), done.returncode, done.stdout, done.stderr))
    return seconds, processor_time, done.stdout


class Times:
    """Repeated times of one thing: their median and quartiles."""

    def __init__(self, values):
        self.median = statistics.median(values)
        quartiles = statistics.quantiles(values, n=4, method="inclusive") if len(values) > 1 else [values[0]] * 3
        self.low, self.high = quartiles[0], quartiles[2]

    def text(self):
        return "%.3g s (%.3g–%.3g)" % (self.median, self.low, self.high)

    def json(self):
        return {"median": self.median, "quartiles": [self.low, self.high]}


def say(text):
    print(text, file=sys.stderr, flush=True)


def processor():
    for line in open("/proc/cpuinfo", encoding="utf-8"):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
