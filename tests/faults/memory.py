#!/usr/bin/python3
"""Runs commands under `ulimit -v`, from the least with which the system loads the program up to a limit without errors,
finely spaced, so that memory ends in every stage. Commands that refuse too large runs beforehand get a larger
--max-memory every other time. Each run must end by itself: with success and the bytes of a run without a limit, or with
exit code 6, a sentence, and no file. Never by a signal, never with a wrong reason.

Usage: memory.py PROGRAM SOURCE [STEP_KB [VERB…]], of those listed below; left out: all
"""
import pathlib
import resource
import sys

import numpy

import common

MB = 1024  # in kB, as ulimit counts
FORESEEN = "this takes up to"
FORESEES = ("guidegen", "transfer", "stylize", "sphere", "tradeoff")


def limits_for(kilobytes):
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (kilobytes * 1024, kilobytes * 1024))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return limit


def told_by_no_clock(contents):
    """Without files that contain times: the pages of a trade-off."""
    return {name: content for name, content in contents.items()
            if pathlib.PurePath(name).parts[0] != "t" or name.endswith(".png")}


def first_loaded(program):
    """The least memory, to 1 MB, with which the loader can start the program at all."""
    low, high = 1 * MB, 1024 * MB
    while high - low > 1 * MB:
        middle = (low + high) // 2
        code, said = program.run("--version", preexec_fn=limits_for(middle))
        if code == 0 or code == 6:
            high = middle
        else:
            low = middle
    return high


def few_addresses(program, failures):
    """Enough for all but OpenImageIO: the message has its purpose, the missing memory and the remedy, and no other
    reason."""
    limit = limits_for(800000)
    code, said = program.run("compare", "g.exr", "p.png", preexec_fn=limit)
    error = common.error_in(said)
    failures.check(code == 6 and all(words in error for words in ("g.exr", "768 MB of addresses", "ulimit -v", "PNG")),
                   f"few addresses: {code}: {said}")
    failures.check("smaller picture" not in error, f"few addresses: no size of it helps: {said}")
    for missing in (["compare", "missing.exr", "p.png"], ["compare", "missing.jpg", "p.png", "--flip"],
                    ["transfer", "missing.exr", "--style", "style", "-o", "x.png"]):
        code, said = program.run(*missing, preexec_fn=limit)
        error = common.error_in(said)
        failures.check(code == 3 and "missing." in error and "no such file" in error,
                       f"few addresses, {missing}: {code}: {said}")
    code, said = program.run("compare", "p.png", "p.png", "--flip", preexec_fn=limit)
    failures.check(code == 0, f"few addresses, plain PNGs: {code}: {said}")


def main():
    path, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    step = int(sys.argv[3]) if len(sys.argv) > 3 else 18001  # kB; no multiple of a page, so that runs differ
    failures = common.Failures()
    with common.temporary_folder() as name:
        folder = pathlib.Path(name)
        program = common.Program(path, folder)
        common.write_style(folder / "style")
        textured = common.textured_scene(folder / "scene")
        common.write_picture(folder / "p.png", numpy.zeros((64, 64, 3), numpy.uint8))
        scene = source / "scenes" / "suzanne.glb"
        code, said = program.run("guidegen", scene, "--size", 128, "-o", "g.exr")
        failures.check(code == 0, said)
        verbs = {
            "guidegen": ["guidegen", scene, "--size", 96, "-o", "out/g.exr"],
            "guidegen, all threads asked for": ["guidegen", textured, "--size", 64, "--threads", 8, "-o", "out/g.exr"],
            "guidegen, light paths": ["guidegen", scene, "--size", 48, "--layers", "luminance,lpe.full", "--samples", 4,
                                      "-o", "out/g.exr"],
            "transfer to PNG": ["transfer", "g.exr", "--style", "style", "-o", "out/p.png"],
            "transfer to EXR": ["transfer", "g.exr", "--style", "style", "--threads", 1, "-o", "out/p.exr"],
            "transfer to JPEG": ["transfer", "g.exr", "--style", "style", "-o", "out/p.jpg"],
            "a sequence": ["guidegen", scene, "--size", 48, "--frames", "1-3", "-o", "out/g.#.exr"],
            "stylize": ["stylize", scene, "--style", source / "exemplars" / "charcoal", "--size", 96, "-o",
                        "out/p.png"],
            "sphere": ["sphere", "--size", 96, "-o", "out"],
            "info": ["info", "g.exr"],
            "styles": ["styles", "check", source / "exemplars" / "charcoal", "--quiet"],
            "compare": ["compare", "g.exr", "g.exr", "-o", "out/map.png"],
            "compare, by FLIP": ["compare", "p.png", "p.png", "--flip", "-o", "out/map.png"],
            "tradeoff": ["tradeoff", scene, "--style", "style", "--size", 48, "--only", "levels 1,seed +1", "--repeat",
                         1,
                         "--no-memory", "-o", "out/t"],
        }
        few_addresses(program, failures)
        least = first_loaded(program)
        runs = foreseen = ended = 0
        for verb in sys.argv[4:] or verbs:
            arguments = verbs[verb]
            common.clean(folder / "out")
            code, said = program.run(*arguments)
            failures.check(code == 0, f"{verb}: without a limit: {code}: {said}")
            whole = told_by_no_clock(common.contents(folder / "out"))
            well = 0
            # Memory that a thread's heap takes at once makes more of it fail where less went well: the end is where
            # eight runs have gone well, and half as much again is allowed.
            kilobytes = least
            while well < 8 and kilobytes < 3000 * MB:
                common.clean(folder / "out")
                tried = ["--max-memory", "1T"] if runs % 2 and arguments[0] in FORESEES else []
                code, said = program.run(*arguments, *tried, preexec_fn=limits_for(kilobytes))
                where = f"{verb} {' '.join(tried)} within {kilobytes} kB: exit code {code}: {said.strip()[-400:]}"
                made = told_by_no_clock(common.contents(folder / "out"))
                runs += 1
                if code == 0:
                    failures.check(made == whole, where + " and other bytes than without a limit")
                    well += 1
                else:
                    foreseen += FORESEEN in said
                    ended += FORESEEN not in said
                    failures.check(not tried or FORESEEN not in said, where)
                    failures.check(code == 6 and common.error_in(said), where)
                    failures.check("please report" not in said, where)
                    failures.check(all(whole.get(name) == content for name, content in made.items()),
                                   where + " left " + ", ".join(made))
                kilobytes += step if well < 2 else 8 * step
            failures.check(well >= 8, f"{verb}: never went well within {kilobytes} kB")
            print(f"{verb}: well from about {kilobytes // MB} MB", flush=True)
        print(f"{runs} runs, {foreseen} refused beforehand, in {ended} memory or threads ended; the program loads "
              f"within {least} kB")
        failures.check(ended >= runs // 8, "memory hardly ever ended")
    failures.end()


if __name__ == "__main__":
    main()
