#!/usr/bin/python3
"""Checks the #include lines of the sources against the table of who may include whom.

Usage: check_includes.py [SOURCE_FOLDER]     Prints each offender as file:line; exit code 1 if there are any.

Libraries include only the libraries that the table names, and of these only the headers in the root: they are public.
Inside a library a folder's subfolders are stages of the data flow, listed in order: a stage includes itself, its parent
folders' headers and the stages before it. A public header whose definitions lie in a stage counts as that stage's. The
other files in the root of a library conduct, and may include every stage.
"""
import pathlib
import re
import sys

# Each library: its folder, the libraries that it may include, and its stages in order. A stage's own stages follow as
# "parent/child".
LIBRARIES = {
    "public": ("include/scumble", set(), []),
    "image": ("core/image", {"public"}, []),
    "painting": ("core/painting", {"public", "image"}, []),
    "io": ("core/io", {"public", "image"}, ["file", "png", "exr", "picture", "guides", "blender", "oiio"]),
    "filter": ("core/filter", {"public", "image"}, []),
    "style": ("core/style", {"public", "image", "painting", "io"}, ["finish", "kit", "scan"]),
    "guidegen": ("guidegen", {"public", "image", "io", "filter"},
                 ["scene", "load", "load/gltf", "load/obj", "surface", "rays", "light", "cast"]),
    "transfer": ("transfer", {"public", "image", "painting", "filter"},
                 ["nearest", "exemplar", "seeds", "match", "vote", "vote/edge", "vote/wide", "tint", "frame",
                  "rim", "shadow"]),
    "finish": ("finish", {"public", "image", "filter"}, ["tone", "area", "points", "smooth", "hatch", "outline"]),
    "measure": ("measure", {"public", "image", "painting", "io", "filter"},
                ["compare", "mosaic", "texture", "painting", "crosscheck", "tradeoff"]),
    "pipeline": ("pipeline",
                 {"public", "image", "painting", "io", "filter", "guidegen", "style", "transfer", "finish", "measure"},
                 ["request", "style", "machine", "scene", "frame", "variant", "run", "tradeoff", "api"]),
    "cli": ("apps/cli",
            {"public", "image", "io", "filter", "guidegen", "style", "transfer", "finish", "measure", "pipeline",
             "studio"},
            ["app", "verbs"]),
    "studio": ("apps/studio",
               {"public", "image", "io", "filter", "guidegen", "style", "transfer", "finish", "measure", "pipeline"},
               ["http", "session"]),
}

# Third parties by the start of the included path, and the libraries that may name them.
THIRD_PARTY = {
    "glm/": {"filter", "image", "painting", "io", "guidegen", "style", "transfer", "finish", "measure", "cli",
             "pipeline"},
    "OpenImageIO/": {"io"},
    "OpenEXR/": {"io"},
    "Imath/": {"io"},
    "png.h": {"io"},
    "zip.h": {"io"},
    "lcms2.h": {"io"},
    "zlib.h": {"io"},
    "hpdf.h": {"style"},
    "embree": {"guidegen"},
    "tiny_gltf": {"guidegen"},
    "tinygltf": {"guidegen"},
    "tiny_obj_loader": {"guidegen"},
    "stb_image": {"guidegen"},
    "oneapi/tbb": {"guidegen", "transfer"},
    "tbb/": {"cli", "filter", "finish", "guidegen", "measure", "pipeline", "transfer"},
    "hwy/": {"filter", "finish", "guidegen", "measure", "transfer"},
    "toml++/": {"style"},
    "apriltag/": {"style"},
    "fmt/": {"measure", "cli", "pipeline", "studio"},
    "nlohmann/": {"measure", "cli", "studio"},
    "boost/": {"studio"},
    "turbojpeg.h": {"studio"},
    "CLI/": {"cli"},
}

# Headers of C, C++ and POSIX.
STANDARD = re.compile(r"[a-z0-9_]+(\.h)?|(sys|netinet|arpa)/[a-z]+\.h")

INCLUDE = re.compile(r'\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')


def where(quoted):
    """The path of an included file from the repository's root: public headers are included by their installed names."""
    return "include/" + quoted if quoted.startswith("scumble/") else quoted


def library_of(path):
    """The library of a path from the repository's root, and the remaining path; (None, path) outside."""
    for library, (folder, _, _) in LIBRARIES.items():
        if path.startswith(folder + "/"):
            return library, path[len(folder) + 1:]
    return None, path


def stage_of(path, inside, of_headers):
    """The stage that a path belongs to; "" for the root."""
    return inside.rpartition("/")[0] or of_headers.get(path, "")


def rank(library, stage):
    """Where a stage stands in its library's order; the root conducts and stands above all."""
    stages = LIBRARIES[library][2]
    return stages.index(stage) if stage in stages else None


def stages_of_headers(root):
    """The stage that holds the definitions of each header in a library's root, by path."""
    found = {}
    for folder, _, stages in LIBRARIES.values():
        for stage in stages:
            for path in (root / folder / stage).glob("*.cpp"):
                found[f"{folder}/{path.stem}.h"] = stage
    return found


def stage_offence(library, stage, included):
    """The fault of an include from one stage of a library to another, or None."""
    if (not stage or stage == included or included == "" or stage.startswith(included + "/")
            or included.startswith(stage + "/")):
        return None
    for name in (stage, included):
        if rank(library, name) is None:
            return (f"joins the stages of {LIBRARIES[library][0]}/, of which {name}/ is none: "
                    "add it to the table in its place")
    if rank(library, included) > rank(library, stage):
        return f"points upwards: {included}/ comes after {stage}/ in {LIBRARIES[library][0]}/"
    return None


def offence(name, quoted, bracketed, root, of_headers):
    """The fault of one #include line of the file `name`, or None."""
    library, inside = library_of(name)
    _, allowed, _ = LIBRARIES[library]
    if quoted:
        if "/" not in quoted:
            return "is not written from the repository's root"
        if not (root / where(quoted)).is_file():
            return "is no file of this repository; third parties go into angle brackets"
        owner, rest = library_of(where(quoted))
        if owner == library:
            return stage_offence(library, stage_of(name, inside, of_headers),
                                 stage_of(quoted, rest, of_headers))
        if owner not in allowed:
            return f"is not for {library}, which may include {', '.join(sorted(allowed)) or 'nothing else'}"
        if "/" in rest:
            return f"is not public: headers for other libraries lie in the root of {LIBRARIES[owner][0]}/"
        return None
    if library_of(bracketed)[0]:
        return "is ours: write it in quotes"
    for start, libraries in THIRD_PARTY.items():
        if bracketed.startswith(start):
            return None if library in libraries else f"is not for {library}, only for {', '.join(sorted(libraries))}"
    return None if STANDARD.fullmatch(bracketed) else "is a third party that no library may include yet"


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
    files = [path for folder, _, _ in LIBRARIES.values() for path in sorted((root / folder).rglob("*"))
             if path.suffix in (".h", ".cpp")]
    offences, of_headers = [], stages_of_headers(root)
    for path in files:
        name = path.relative_to(root).as_posix()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found = INCLUDE.match(line)
            problem = offence(name, found[1], found[2], root, of_headers) if found else None
            if problem:
                offences.append(f"{name}:{number}: {found[1] or found[2]} {problem}")
    if not files:
        offences.append(f"{root} holds none of {', '.join(LIBRARIES)}: name the folder of the sources")
    print("\n".join(offences) if offences else f"{len(files)} files include only what they may")
    return 1 if offences else 0


if __name__ == "__main__":
    sys.exit(main())
