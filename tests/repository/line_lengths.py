#!/usr/bin/python3
"""Checks that no line of the tracked text files has more than 120 characters. Data, pages of Markdown, which have
tables, and inputs of fuzzing may.

Usage: line_lengths.py [SOURCE_FOLDER]     Prints each longer line; exit code 1 if there are any.
"""
import pathlib
import subprocess
import sys

LIMIT = 120
FREE_TYPES = {".json", ".md", ".svg"}
FREE_FOLDERS = ("tests/fuzz/corpus/", "tests/fuzz/crashes/")


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z"], check=True, capture_output=True).stdout.decode()
    read = 0
    long = []
    for name in listed.split("\0"):
        path = root / name
        if not path.is_file() or path.suffix in FREE_TYPES or name.startswith(FREE_FOLDERS):
            continue
        data = path.read_bytes()
        if b"\0" in data:  # a picture, a scene
            continue
        read += 1
        for number, line in enumerate(data.decode(errors="replace").split("\n"), 1):
            if len(line) > LIMIT:
                long.append(f"{name}:{number}: {len(line)} characters, {LIMIT} at most: wrap it: {line[:60]}")
    print("\n".join(long) or f"{read} files, no line over {LIMIT} characters")
    return 1 if long or not read else 0


if __name__ == "__main__":
    sys.exit(main())
