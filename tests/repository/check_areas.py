#!/usr/bin/python3
"""Checks that `make check CHECK=AREA` finds tests for every area, and builds the programs that it runs.

Usage: check_areas.py SOURCE_FOLDER BUILD_FOLDER     Prints each fault; exit code 1 if there are any.

An area is a folder under tests/, or under tests/apps/, with tests of its own.
"""
import json
import pathlib
import shlex
import subprocess
import sys


def areas(source):
    """The names that CHECK= takes."""
    folders = [path.parent for path in sorted((source / "tests").rglob("CMakeLists.txt"))]
    return [folder.name for folder in folders if folder.name not in ("tests", "consumer")]


def selected(source, build, area):
    """The tests that the Makefile's own command line selects, as ctest describes them."""
    recipe = subprocess.run(["make", "-n", "--no-print-directory", "-C", source, "check", f"CHECK={area}"], check=True,
                            capture_output=True, text=True).stdout.replace("\\\n", " ")
    words = next(shlex.split(line) for line in recipe.splitlines() if "ctest" in line)
    words[words.index("--test-dir") + 1] = str(build)
    if "--no-tests=error" not in words:
        return None
    shown = subprocess.run(words + ["--show-only=json-v1"], check=True, capture_output=True, text=True)
    return json.loads(shown.stdout)["tests"]


def needs(build, target):
    """What a target of Ninja needs directly, by paths in the build's folder; None if Ninja has no such target."""
    shown = subprocess.run(["ninja", "-C", build, "-t", "query", target], capture_output=True, text=True)
    return set(shown.stdout.partition("outputs:")[0].replace("|", " ").split()) if shown.returncode == 0 else None


def main():
    source, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    faults = []
    count = 0
    for area in areas(source):
        tests = selected(source, build, area)
        if not tests:
            faults.append(f"make check CHECK={area} {'is green without a test' if tests is None else 'finds no test'}")
            continue
        count += len(tests)
        built = needs(build, f"tests/check_{area}") or set()
        for test in tests if (build / "build.ninja").is_file() else []:
            for word in test.get("command", []):
                program = pathlib.Path(word)
                program = program.relative_to(build).as_posix() if program.is_relative_to(build) else None
                if program and program not in built and needs(build, program) is not None:
                    faults.append(f"make check CHECK={area} runs {program} for {test['name']} and does not build it")
    print("\n".join(faults) or f"{count} tests of {len(areas(source))} areas")
    return 1 if faults or not count else 0


if __name__ == "__main__":
    sys.exit(main())
