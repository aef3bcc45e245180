#!/usr/bin/python3
"""Runs every case of the test programs, one program at a time, and writes those that are slow for their tier to
tests/slow_cases.txt, from where CMake registers them. Counts processor time, so that a busy machine measures the same.

Usage: tests/support/slow_cases.py BUILD [--only PROGRAM,PROGRAM]    the others keep their lines
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

LIST = pathlib.Path(__file__).resolve().parent.parent / "slow_cases.txt"


def tiers(build):
    """The tier of each program whose cases share processes, from CMake's labels."""
    shown = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], check=True, capture_output=True,
                           text=True)
    found = {}
    for test in json.loads(shown.stdout)["tests"]:
        path = pathlib.Path(test.get("command", ["none"])[0])
        labels = next((p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"), [])
        tier = next((tier for tier in ("unit", "oracle", "paint", "cli") if tier in labels and "slow" not in labels),
                    None)
        isolated = any("--gtest_also_run_disabled_tests" in word for word in test.get("command", []))
        if path.parent.name == "tests" and path.name.endswith("_test") and tier and not isolated:
            found[path] = tier
    return found


def seconds_of_cases(program):
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"
        done = subprocess.run([program, f"--gtest_output=json:{report}"], capture_output=True, text=True)
        if done.returncode != 0:
            print(f"{program.name} failed:\n" + "\n".join(done.stdout.splitlines()[-20:]), file=sys.stderr)
        for suite in json.loads(report.read_text())["testsuites"]:
            for case in suite["testsuite"]:
                yield f"{suite['name']}.{case['name']}", float(case["processor_seconds"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    only = [name for name in options.only.split(",") if name]

    head = [line for line in LIST.read_text().splitlines() if line.startswith("#")]
    kept = [line for line in LIST.read_text().splitlines() if line and not line.startswith("#")]
    lines = [line for line in kept if only and line.split()[0] not in only]
    for program, tier in sorted(tiers(options.build).items()):
        if only and program.name not in only:
            continue
        limit = 0.1 if tier == "unit" else 2.0
        total = 0.0
        for case, seconds in seconds_of_cases(program):
            total += seconds
            if seconds > limit:
                lines.append(f"{program.name} {case} {seconds:.1f}")
        print(f"{program.name}: {total:.1f} s")
    LIST.write_text("\n".join(head + sorted(lines)) + "\n")


if __name__ == "__main__":
    main()
