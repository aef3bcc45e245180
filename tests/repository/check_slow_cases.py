#!/usr/bin/python3
"""Checks that each test case named in tests/slow_cases.txt exists: a filter that finds no case fails as a test.

Usage: check_slow_cases.py [SOURCE_FOLDER]     Prints each name that no source file has; exit code 1 if there are any.
"""
import pathlib
import re
import sys

CASE = re.compile(r"^(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)", re.MULTILINE)


def main():
    tests = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".") / "tests"
    cases = set()
    for source in tests.rglob("*.cpp"):
        cases.update(CASE.findall(source.read_text(encoding="utf-8")))
    listed = 0
    missing = []
    for number, line in enumerate((tests / "slow_cases.txt").read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("#") or not line:
            continue
        listed += 1
        # Prefix/Suite.Case/parameter; the prefix and the parameter belong to INSTANTIATE_TEST_SUITE_P.
        suite, case = line.split()[1].split(".", 1)
        if (suite.split("/")[-1], case.split("/")[0]) not in cases:
            missing.append(f"tests/slow_cases.txt:{number}: no source file has {suite}.{case}; delete the line or name "
                           "the case that took its place")
    print("\n".join(missing) or f"{listed} slow cases, all of them in the sources")
    return 1 if missing or not listed else 0


if __name__ == "__main__":
    sys.exit(main())
