#!/usr/bin/python3
"""Whether the studio's memory stays flat: a day's worth of changes in minutes. Of ten changes six are orbits with a
draft, two are keys with a final, one is a save of the painting in place or by rename with a final, and one is another
frame, assignment, light or undo of all.

Usage: studio_changes.py --scumble build/scumble [--changes 10000] [--size 320x180]

Prints the memory that the program has allocated (RssAnon) after each tenth, at rest. Exit code 1 where any later tenth
has over 5% more than the first one, or where the studio does not answer or end as it should.
"""
import argparse
import pathlib
import random
import shutil
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(SOURCE / "tests" / "apps" / "studio"))
from studio_client import Studio  # noqa: E402


def memory_mb(process):
    for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines():
        if line.startswith("RssAnon:"):  # without the pages of libraries, which are loaded when they are needed
            return int(line.split()[1]) / 1024.0
    raise SystemExit("studio_changes.py: the studio has ended")


class Changes:
    def __init__(self, studio, folder):
        self.studio, self.folder = studio, folder
        self.chance = random.Random(5)
        self.paintings = [(SOURCE / "exemplars" / name / "lit.png").read_bytes() for name in ("oil", "gouache")]
        self.eye = studio.json("GET", "/api/state")["eye"]
        # A broken file first: it has the libraries loaded that know other formats.
        (folder / "lit.png").write_bytes(self.paintings[0][:1000])
        studio.call("GET", "/api/frame", quality="final")
        time.sleep(3.0)
        (folder / "lit.png").write_bytes(self.paintings[0])
        time.sleep(1.0)

    def patch(self, **changes):
        self.studio.json("PATCH", "/api/state", changes)

    def frame(self, quality):
        status, _, body = self.studio.call("GET", "/api/frame", quality=quality)
        while status == 409:  # as the page does it: a file is being written, or its new picture painted
            time.sleep(0.05)
            status, _, body = self.studio.call("GET", "/api/frame", quality=quality)
        if status != 200:
            raise SystemExit(f"studio_changes.py: {quality}: {status}: {body[:300]}")

    def one(self, number):
        kind = number % 10
        if kind < 6:
            self.patch(view=dict(self.eye, azimuth=self.chance.uniform(-180, 180)))
            self.frame("draft")
        elif kind < 8:
            self.patch(keys={"transfer.threshold": self.chance.uniform(0.05, 0.5), "transfer.levels": 4 + number % 3})
            self.frame("final")
        elif kind == 8:
            self.save(number)
            self.frame("final")
        else:
            self.other(number // 10)

    def save(self, number):
        whole, file = self.paintings[number // 10 % 2], self.folder / "lit.png"
        if number % 20 < 10:
            file.write_bytes(whole)
        else:
            (self.folder / "new.png").write_bytes(whole)
            (self.folder / "new.png").rename(file)

    def other(self, number):
        if number % 4 == 0:
            self.patch(frame=self.chance.randrange(24))
        elif number % 4 == 1:
            self.patch(assignments=[{"name": "*", "style": self.chance.choice(["ink", "pastel"])}])
        elif number % 4 == 2:
            self.patch(light={"azimuth": self.chance.uniform(0, 360), "elevation": 40})
        else:
            self.patch(view=None, frame=None, assignments=[], light=None,
                       keys={"transfer.threshold": None, "transfer.levels": None})
        self.frame("final")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scumble", default=SOURCE / "build" / "scumble")
    parser.add_argument("--changes", type=int, default=10000)
    parser.add_argument("--size", default="320x180")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary) / "painted"
        shutil.copytree(SOURCE / "exemplars" / "oil", folder)
        studio = Studio(given.scumble, SOURCE / "scenes" / "toys.glb", "--style", folder, "--size", given.size)
        begun, changes, tenths = time.monotonic(), Changes(studio, folder), []
        for number in range(given.changes):
            changes.one(number)
            if (number + 1) % max(given.changes // 10, 1) == 0:
                time.sleep(2.0)  # at rest it gives back what it does not need
                rest = []
                for _ in range(5):
                    rest.append(memory_mb(studio.process))
                    time.sleep(0.4)
                tenths.append(min(rest))
                print(f"{number + 1} changes, {time.monotonic() - begun:.0f} s: {tenths[-1]:.0f} MB", flush=True)
        if studio.end() != 0:
            raise SystemExit("studio_changes.py: the studio did not end with 0")
    growth = max(tenths) / tenths[0] - 1.0
    print(f"most over the first tenth: {100.0 * growth:+.1f}%")
    raise SystemExit(0 if growth <= 0.05 else 1)


if __name__ == "__main__":
    main()
