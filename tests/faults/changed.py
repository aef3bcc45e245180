#!/usr/bin/python3
"""Files that change while they are read: a texture that comes and goes, guides that are cut short and made whole again
under the reader. Each run ends by itself: well and with the bytes that whole files give, or with exit code 3 (no
readable input) and a sentence that names a file, never by a signal. Then pipes without a reader.

A seeded generator draws the changes and their times; the times of the program's reads are not fixed.

Usage: changed.py PROGRAM SOURCE
"""
import os
import pathlib
import random
import signal
import subprocess
import sys
import threading
import time

import common


class Meanwhile:
    """Calls change(round) on a thread of its own, over and over, until the end of the with block."""

    def __init__(self, change):
        self.change, self.is_over, self.rounds = change, threading.Event(), 0
        self.thread = threading.Thread(target=self.work)

    def work(self):
        while not self.is_over.is_set():
            self.change(self.rounds)
            self.rounds += 1

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.is_over.set()
        self.thread.join()


def is_refusal(code, said, name):
    return code == 3 and name in common.error_in(said)


def both_ends(failures, ends, what):
    """A race with one outcome tests nothing. The file is whole about half of the time, at any pace: if the outcomes
    were drawn evenly, 25 runs would all be equal once in sixteen million."""
    failures.check(ends.get(0, 0) > 0 and ends.get(3, 0) > 0, f"{what}: runs ended only with {ends}")


def whole_or_refused(program, failures, run, times, output, whole, blamed, what):
    """Every run ends with the whole bytes, or names the damaged file and its fault; both must occur."""
    ends = {}
    for i in range(times):
        output.unlink(missing_ok=True)
        code, said = program.run(*run)
        ends[code] = ends.get(code, 0) + 1
        if code == 0:
            failures.check(output.read_bytes() == whole, f"run {i}: other bytes: {said}")
        else:
            failures.check(is_refusal(code, said, blamed), f"run {i}: {code}: {said}")
    print(f"{what}, exit codes:", ends, flush=True)
    both_ends(failures, ends, what)


def texture_that_vanishes(program, failures, chance):
    scene = common.textured_scene(program.folder / "scene")
    run = ["guidegen", scene, "--size", 32, "--layers", "albedo", "-o", "square.exr"]
    picture, away = scene.parent / "paint.png", scene.parent / "away.png"
    output = program.folder / "square.exr"
    code, said = program.run(*run)
    failures.check(code == 0, said)
    whole = output.read_bytes()
    code, said = program.run(*run[:-1], "again.exr")
    os.rename(picture, away)
    output.unlink()
    code, said = program.run(*run)
    failures.check(is_refusal(code, said, "paint.png") and not output.exists(), f"without its texture: {code}: {said}")
    os.rename(away, picture)

    def come_and_go(_):
        os.rename(picture, away)
        time.sleep(chance.random() * 0.004)
        os.rename(away, picture)
        time.sleep(chance.random() * 0.004)

    with Meanwhile(come_and_go):
        whole_or_refused(program, failures, run, 25, output, whole, "paint.png", "a texture that comes and goes")
    for damaged in (b"", b"\x89PNG", picture.read_bytes()[:200]):
        good = picture.read_bytes()
        picture.write_bytes(damaged)
        code, said = program.run(*run)
        failures.check(is_refusal(code, said, "paint.png"), f"a texture of {len(damaged)} bytes: {code}: {said}")
        picture.write_bytes(good)


def guides_cut_short(program, failures, chance):
    guides, output = program.folder / "guides.exr", program.folder / "p.png"
    code, said = program.run("guidegen", program.source / "scenes" / "ball.glb", "--size", 200, "-o", guides)
    failures.check(code == 0, said)
    run = ["transfer", guides, "--style", "style", "-o", output]
    code, said = program.run(*run)
    failures.check(code == 0, said)
    whole, good = output.read_bytes(), guides.read_bytes()
    for i in range(20):  # cut short already when it is opened
        guides.write_bytes(good[:chance.randrange(len(good))])
        output.unlink(missing_ok=True)
        code, said = program.run(*run)
        failures.check(is_refusal(code, said, "guides.exr") and not output.exists(),
                       f"cut to {guides.stat().st_size} of {len(good)} bytes: {code}: {said}")

    def cut_and_mend(_):
        with open(guides, "r+b") as file:
            length = chance.randrange(len(good))
            file.truncate(length)
            time.sleep(chance.random() * 0.004)
            file.seek(length)
            file.write(good[length:])
        time.sleep(chance.random() * 0.004)

    guides.write_bytes(good)
    with Meanwhile(cut_and_mend):
        whole_or_refused(program, failures, run, 40, output, whole, "guides.exr",
                         "guides cut and restored while they are read")


def pipes_nobody_reads(program, failures):
    for arguments in (["help"], ["info", "guides.exr", "--json"], ["transfer", "guides.exr", "--style", "style",
                                                                   "--frames",
                                                                  "1-40", "-o", "f.##.png"]):
        for is_ignored in (False, True):
            reader, writer = os.pipe()
            os.close(reader)
            code, said = program.run(*arguments, stdout=writer, restore_signals=not is_ignored)
            os.close(writer)
            where = f"{arguments} into a closed pipe, its signal ignored: {is_ignored}: {code}: {said}"
            if is_ignored:
                failures.check(code == 4 and "standard output" in common.error_in(said), where)
            else:
                failures.check(code == -signal.SIGPIPE and common.error_in(said) == "", where)
            failures.check(common.leftovers(program.folder) == [], where + ": left temporary files")
    command = f"'{program.path}' styles --keys | head -1"
    ended = subprocess.run(["bash", "-c", command + "; exit ${PIPESTATUS[0]}"], cwd=program.folder,
                           env=program.environment, capture_output=True, text=True)
    failures.check(ended.returncode in (0, 128 + signal.SIGPIPE) and ended.stderr == "", f"| head -1: {ended}")


def main():
    path, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    failures = common.Failures()
    with common.temporary_folder() as name:
        program = common.Program(path, name)
        program.source = source
        common.write_style(program.folder / "style")
        chance = random.Random(21)
        texture_that_vanishes(program, failures, chance)
        guides_cut_short(program, failures, chance)
        pipes_nobody_reads(program, failures)
    failures.end()


if __name__ == "__main__":
    main()
