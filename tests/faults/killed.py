#!/usr/bin/python3
"""Kills the program at random moments while it writes sequences, until fifty kills have met it between its first file
and its last. Every file under a final name must have the bytes of a complete run. `--resume` must make the missing
files, with the same bytes, and remove the temporary file of a killed run. Then signals with handlers, which leave no
temporary file at all; and runs at the same time in one folder, of which some are killed.

The moments are drawn from a seeded generator, in shares of the time that whole runs take here and now from their first
file to their last.

Usage: killed.py PROGRAM SOURCE [KILLS]
"""
import os
import pathlib
import random
import signal
import statistics
import sys
import time

import common

FRAMES = 12


class Verb:
    """A sequence, its expected files, and its time."""

    def __init__(self, program, name, arguments, failures):
        self.program, self.name, self.failures = program, name, failures
        self.folder = program.folder / name
        self.arguments = [*arguments, "--frames", f"1-{FRAMES}", "-o", name + "/f.####" + name[-4:]]
        self.seconds = []  # from the first file to the last, of the last whole runs
        for _ in range(3):
            self.whole_run()
        self.whole = common.contents(self.folder)
        failures.check(len(self.whole) == FRAMES, f"{name}: {list(self.whole)}")

    def begin(self):
        """Starts a run, and waits for its first file, temporary or not, or its end."""
        process = self.program.start(*self.arguments)
        while process.poll() is None and not os.listdir(self.folder):
            time.sleep(0.0005)
        return process

    def whole_run(self):
        common.clean(self.folder)
        process = self.begin()
        start = time.monotonic()
        while process.poll() is None and not self.is_complete():
            time.sleep(0.0005)
        self.seconds = self.seconds[-8:] + [time.monotonic() - start]
        _, said = process.communicate()
        self.failures.check(process.returncode == 0, f"{self.name}: {process.returncode}: {said}")

    def is_complete(self):
        names = os.listdir(self.folder)
        return len(names) == FRAMES and not common.leftovers(self.folder)

    def resume(self):
        code, said = self.program.run(*self.arguments, "--resume")
        self.failures.check(code == 0, f"{self.name} --resume: {code}: {said}")

    def stop(self, share, how):
        """Stops a run after that share of the time in which it writes; whether it was still running."""
        process = self.begin()
        time.sleep(share * statistics.median(self.seconds))
        process.send_signal(how)
        process.communicate()
        return process.returncode == -how

    def check_left(self, where):
        """Whole files under final names; how many there are, and how many temporary ones."""
        temporary = common.leftovers(self.folder)
        made = common.contents(self.folder, ignored=temporary)
        for name, content in made.items():
            self.failures.check(self.whole.get(name) == content, f"{where}: {name} is not whole, {len(content)} bytes")
        return len(made), len(temporary)

    def check_whole(self, where):
        self.failures.check(common.contents(self.folder) == self.whole,
                            f"{where}: differs from a whole run: {sorted(os.listdir(self.folder))}")


def kill_many(verbs, chance, kills):
    running = between = with_leftover = tries = 0
    # Moments are uniform in the median time from the first file to the last, so more than half of them hit. A quarter
    # must hit at any pace of the machine.
    while between < kills and tries < 4 * kills:
        i, tries = tries, tries + 1
        verb = verbs[i % len(verbs)]
        where = f"kill {i} of {verb.name}"
        common.clean(verb.folder)
        was_running = verb.stop(chance.random(), signal.SIGKILL)
        made, temporary = verb.check_left(where)
        running += was_running
        between += was_running and 0 < made + temporary and made < FRAMES
        with_leftover += temporary > 0
        verb.failures.check(temporary <= 2, f"{where}: {temporary} temporary files")
        verb.resume()
        verb.check_whole(where + ", resumed")
        if i % 10 == 9:
            verb.whole_run()  # the machine's pace may have changed
    print(f"{tries} kills: {running} met a running program, {between} of them between its first file and its last; "
          f"{with_leftover} left a temporary file", flush=True)
    verbs[0].failures.check(between >= kills, f"only {between} of {tries} kills were among the files")


def end_politely(verbs, chance, times):
    met = tries = 0
    while met < times and tries < 4 * times:
        i, tries = tries, tries + 1
        verb, how = verbs[i % len(verbs)], (signal.SIGTERM, signal.SIGINT)[i // len(verbs) % 2]
        common.clean(verb.folder)
        met += verb.stop(chance.random(), how)
        _, temporary = verb.check_left(f"{how.name} {i}")
        verb.failures.check(temporary == 0, f"{how.name} {i} of {verb.name} left {common.leftovers(verb.folder)}")
    print(f"{tries} signals that a program may answer: {met} met a running program", flush=True)
    verbs[0].failures.check(met >= times, f"only {met} of {tries} signals met a running program")


def run_together(verb, chance, times):
    """Three runs write the same files at once, and one of them is killed: the others do not notice."""
    for i in range(times):
        common.clean(verb.folder)
        runs = [verb.program.start(*verb.arguments) for _ in range(3)]
        time.sleep(chance.random() * statistics.median(verb.seconds))
        runs[0].kill()
        for place, process in enumerate(runs):
            _, said = process.communicate()
            verb.failures.check(place == 0 or process.returncode == 0, f"beside others: {process.returncode}: {said}")
        verb.program.run(*verb.arguments, "--resume")  # the killed run's file may have been locked when they looked
        verb.check_whole(f"three at once, round {i}")


def main():
    path, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    kills = int(sys.argv[3]) if len(sys.argv) > 3 else 50
    failures = common.Failures()
    with common.temporary_folder() as name:
        program = common.Program(path, name)
        common.write_style(program.folder / "style")
        scene = source / "scenes" / "ball.glb"
        code, said = program.run("guidegen", scene, "--size", 40, "-o", "guides.exr")
        failures.check(code == 0, said)
        verbs = [Verb(program, "guides_f.exr", ["guidegen", scene, "--size", 40], failures),
                 Verb(program, "transfer.png", ["transfer", "guides.exr", "--style", "style"], failures),
                 Verb(program, "stylize.exr", ["stylize", scene, "--style", "style", "--size", 40], failures)]
        chance = random.Random(20)
        kill_many(verbs, chance, kills)
        end_politely(verbs, chance, 12)
        run_together(verbs[0], chance, 4)
    failures.end()


if __name__ == "__main__":
    main()
