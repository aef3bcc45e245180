#!/usr/bin/python3
"""Checks how many source files a folder holds: at most 30, and at least 4 in a subfolder.

Usage: check_folders.py [SOURCE_FOLDER]     Prints each offender; exit code 1 if there are any.

A subfolder is a folder of source files below a library, or below another folder of ROOTS: the stage of a library, a
group of tests. Folders without a source file hold data.
"""
import pathlib
import sys

from check_includes import LIBRARIES

MOST, LEAST = 30, 4
SOURCES = {".h", ".cpp", ".py", ".sh", ".js", ".css", ".html", ".svg"}
# What is searched, and where subfolders begin.
TOP = ("include", "core", "guidegen", "transfer", "finish", "measure", "pipeline", "apps", "blender_scripts",
       "exemplars", "tests", "bench")
ROOTS = {folder for folder, _, _ in LIBRARIES.values()} | set(TOP)
# Subfolders that may hold fewer, each with its reason.
SMALL = {}


def is_root(folder):
    """Whether a folder, a path from the repository's root, is no subfolder. Of tests those of an area are none."""
    name = folder.removeprefix("tests/")
    return folder in ROOTS or name in ROOTS or "/" not in name


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
    counts = {}
    for top in TOP:
        for path in (root / top).rglob("*"):
            if path.suffix in SOURCES and path.is_file():
                folder = path.parent.relative_to(root).as_posix()
                counts[folder] = counts.get(folder, 0) + 1
    offences = []
    for folder, count in sorted(counts.items()):
        if count > MOST:
            offences.append(f"{folder}/ holds {count} source files, {MOST} at most: make a subfolder of one thing")
        elif count < LEAST and not is_root(folder) and folder not in SMALL:
            offences.append(f"{folder}/ holds {count} source files, {LEAST} at least: join it to the folder above")
    offences += [f"{folder}/ needs no exception: delete its line in {pathlib.Path(__file__).name}" for folder in SMALL
                 if counts.get(folder, 0) >= LEAST or folder not in counts]
    if not counts:
        offences.append(f"{root} holds none of {', '.join(TOP)}: name the folder of the sources")
    print("\n".join(offences) or f"{len(counts)} folders of source files, none too full and none too small")
    return 1 if offences else 0


if __name__ == "__main__":
    sys.exit(main())
