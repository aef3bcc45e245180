#!/usr/bin/python3
"""Checks the #include lines of the sources against the table of who may include whom.

Usage: check_includes.py [SOURCE_FOLDER]     Prints each offender as file:line; exit code 1 if there are any.
"""
import pathlib
import re
import sys

# A folder may include its own headers and those of the folders named here.
MAY_INCLUDE = {
    "image": set(),
    "io": {"image"},
    "guidegen": {"image", "io"},
    "style": {"image", "io"},
    "transfer": {"image"},
    "measure": {"image", "io"},
    "cli": {"image", "io", "guidegen", "style", "transfer", "measure"},
}

# Third parties by the start of the included path, and the folders that may name them.
THIRD_PARTY = {
    "glm/": {"image", "io", "guidegen", "style", "transfer", "measure", "cli"},
    "OpenImageIO/": {"io"},
    "OpenEXR/": {"io"},
    "Imath/": {"io"},
    "png.h": {"io"},
    "zip.h": {"io"},
    "zlib.h": {"io"},
    "hpdf.h": {"style"},
    "embree": {"guidegen"},
    "tiny_gltf": {"guidegen"},
    "tinygltf": {"guidegen"},
    "tiny_obj_loader": {"guidegen"},
    "stb_image": {"guidegen"},
    "oneapi/tbb": {"guidegen", "transfer"},
    "tbb/": {"cli", "guidegen", "transfer"},
    "nanoflann": {"transfer"},
    "hwy/": {"guidegen", "transfer"},
    "toml++/": {"style"},
    "apriltag/": {"style"},
    "fmt/": {"measure", "cli"},
    "nlohmann/": {"measure", "cli"},
    "CLI/": {"cli"},
}

# What C, C++ and POSIX bring along.
STANDARD = re.compile(r"[a-z0-9_]+(\.h)?|sys/[a-z]+\.h")

INCLUDE = re.compile(r'\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')


def offence(folder, quoted, bracketed, root):
    """What is wrong with one #include line of a file in `folder`, or None."""
    if quoted:
        owner = quoted.split("/")[0]
        if "/" not in quoted:
            return "is not written from the repository's root"
        if not (root / quoted).is_file():
            return "is no file of this repository; third parties go into angle brackets"
        if owner != folder and owner not in MAY_INCLUDE[folder]:
            return f"is not for {folder}/, which may include {', '.join(sorted(MAY_INCLUDE[folder])) or 'nothing else'}"
        return None
    if bracketed.split("/")[0] in MAY_INCLUDE:
        return "is ours: write it in quotes"
    for start, folders in THIRD_PARTY.items():
        if bracketed.startswith(start):
            if folder in folders:
                return None
            return f"is not for {folder}/, only for {', '.join(sorted(folders))}"
    return None if STANDARD.fullmatch(bracketed) else "is a third party that no folder may include yet"


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    files = [path for folder in MAY_INCLUDE for path in sorted((root / folder).rglob("*")) if path.suffix in (".h", ".cpp")]
    offences = []
    for path in files:
        name = path.relative_to(root)
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found = INCLUDE.match(line)
            problem = offence(name.parts[0], found[1], found[2], root) if found else None
            if problem:
                offences.append(f"{name}:{number}: {found[1] or found[2]} {problem}")
    if not files:
        offences.append(f"{root} holds none of {', '.join(MAY_INCLUDE)}: name the folder of the sources")
    print("\n".join(offences) if offences else f"{len(files)} files include only what they may")
    return 1 if offences else 0


if __name__ == "__main__":
    sys.exit(main())
