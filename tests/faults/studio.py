#!/usr/bin/python3
"""The studio's writing under faults. It is killed at random moments while it saves keys into style.toml, strokes into a
painting, and styles under new names: every style is then whole. On a full disk, in a folder for reading only, and where
the folder has vanished, it says so, changes nothing, and goes on.

Runs in a mount namespace of its own, as disk.py does, with the same exit code 77 where the system allows none.

Usage: studio.py PROGRAM SOURCE [KILLS]
"""
import http.client
import json
import pathlib
import random
import shutil
import sys
import threading

import common
import disk
from common import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "apps" / "studio"))
from studio_client import Studio  # noqa: E402

SIZE = 64


class Painter:
    """A studio on a style of its own, and the calls that write."""

    def __init__(self, program, scene, home):
        self.pictures = program.folder
        self.studio = Studio(program.path, scene, "--style", home / "mine", "--size", "32x32", "--save-to", home,
                             cwd=program.folder, env=program.environment)

    def change_key(self, number):
        self.studio.json("PATCH", "/api/state", {"keys": {"transfer.threshold": number / 10000}})

    def save(self, number):
        self.change_key(number)
        return self.studio.call("POST", "/api/save", {})

    def paint(self, number):
        """One pixel, whose colour is the number's."""
        pixels = numpy.zeros((SIZE, SIZE, 4), numpy.uint8)
        pixels[SIZE // 2, SIZE // 2] = (number % 256, number // 256 % 256, 7, 255)
        common.write_picture(self.pictures / "strokes.png", pixels)
        stamp = self.studio.json("GET", "/api/paintable").get("stamp", "none")
        return self.studio.call("POST", "/api/paint", (self.pictures / "strokes.png").read_bytes(), exemplar=0,
                                stamp=stamp)

    def save_as(self, number):
        answer = self.studio.call("POST", "/api/save-as", {"name": f"new {number}"})
        self.studio.json("PATCH", "/api/state", {"style": "mine"})
        return answer


WRITES = ("save", "paint", "save_as")


def begin(home):
    shutil.rmtree(home / "mine", ignore_errors=True)
    common.write_style(home / "mine", SIZE, "threshold = 0.5  # coarse\n")


def check_styles(program, failures, home, where):
    """Every style is whole: its text has its one line of each kind, and its painting can be read."""
    styles = sorted(path for path in home.iterdir() if path.is_dir() and not path.name.startswith("."))
    for style in styles:
        text = (style / "style.toml").read_text()
        failures.check(text.count("[[exemplar]]") == 1 and text.count("threshold = ") == 1 and "# coarse" in text,
                       f"{where}: {style.name}: {text!r}")
        code, said = program.run("styles", "check", style)
        failures.check(code == 0, f"{where}: {style.name}: exit code {code}: {said}")
    return len(styles)


def kill_many(program, failures, scene, home, kills):
    chance = random.Random(27)
    written = dict.fromkeys(WRITES, 0)
    styles = 0
    for kill in range(kills):
        shutil.rmtree(home, ignore_errors=True)
        begin(home)
        painter = Painter(program, scene, home)
        painter.studio.json("GET", "/api/paintable")  # the first takes a while
        killer = threading.Timer(chance.uniform(0.0, 0.1 * common.SLOWER), painter.studio.process.kill)
        killer.start()
        number = chance.randrange(3)
        try:
            while True:
                number += 1
                name = WRITES[number % len(WRITES)]
                status, _, body = getattr(painter, name)(number)
                failures.check(status == 200, f"kill {kill}: {name}: {status}: {body}")
                written[name] += 1
        except (OSError, http.client.HTTPException):
            pass  # it is gone
        killer.join()
        painter.studio.process.wait()
        styles += check_styles(program, failures, home, f"kill {kill} in call {number}, {name}")
    print(f"{kills} kills; answered before them: {written}; {styles} styles were whole", flush=True)
    failures.check(min(written.values()) > 0, f"a kind was never written: {written}")


def refuses(program, failures, painter, home, reasons, where):
    """Each kind of writing is refused for its reason, a sentence with the name of a file; nothing is changed."""
    before = common.contents(home, ignored=("filler",))
    for name, reason in zip(WRITES, reasons):
        status, _, body = getattr(painter, name)(77)
        message = json.loads(body).get("error", {}).get("message", "")
        failures.check(status in (403, 404, 422, 507) and reason in message and str(home) in message,
                       f"{where}: {name}: {status}: {body}")
        failures.check(common.contents(home, ignored=("filler",)) == before, f"{where}: {name} changed a file")
    print(f"{where}: refused", flush=True)


def accepts(program, failures, painter, home, where):
    """All is well again."""
    for name in WRITES:
        status, _, body = getattr(painter, name)(78)
        failures.check(status == 200, f"{where}: {name}: {status}: {body}")
    check_styles(program, failures, home, where)


def full_disk(program, failures, scene, home):
    home.mkdir()
    disk.mount("-t", "tmpfs", "-o", "size=256k", "none", home)
    begin(home)
    painter = Painter(program, scene, home)
    painter.change_key(1)
    disk.fill(home)
    refuses(program, failures, painter, home, ["No space left on device"] * 3, "full disk")
    (home / "filler").unlink()
    accepts(program, failures, painter, home, "room again")
    failures.check(painter.studio.end() == 0, "the end after a full disk")
    disk.subprocess.run(["umount", str(home)])


def read_only(program, failures, scene, home):
    home.mkdir()
    begin(home)
    disk.mount("--bind", home, home)
    disk.mount("-o", "remount,bind,ro", home)
    painter = Painter(program, scene, home)
    refuses(program, failures, painter, home, ["cannot be written", "cannot be written", "Read-only file system"],
            "read-only folder")
    failures.check(painter.studio.end() == 0, "the end in a read-only folder")
    disk.subprocess.run(["umount", str(home)])


def vanished(program, failures, scene, home):
    home.mkdir()
    begin(home)
    painter = Painter(program, scene, home)
    failures.check(painter.studio.call("GET", "/api/frame", quality="final", format="png")[0] == 200, "a picture")
    (home / "mine").rename(home / "away")
    refuses(program, failures, painter, home, ["mine"] * 3, "vanished folder")
    (home / "away").rename(home / "mine")
    accepts(program, failures, painter, home, "the folder is back")
    failures.check(painter.studio.end() == 0, "the end after a folder vanished")


def main():
    disk.enter_namespace()
    path, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    kills = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    failures = common.Failures()
    with common.temporary_folder() as name:
        program = common.Program(path, name)
        scene = source / "scenes" / "ball.glb"
        kill_many(program, failures, scene, program.folder / "kills", kills)
        full_disk(program, failures, scene, program.folder / "disk")
        read_only(program, failures, scene, program.folder / "read_only")
        vanished(program, failures, scene, program.folder / "vanished")
    failures.end()


if __name__ == "__main__":
    main()
