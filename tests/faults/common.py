"""Shared code of the tests of faults: small inputs, running the program, and checks of its end."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy
import OpenImageIO as oiio

SUFFIX = ".scumble-tmp"
# Files of `tradeoff -o`, with the one picture that every report has.
REPORT = ("report.html", "chart.svg", "tradeoff.csv", "tradeoff.json", "pictures/01-the-style.png")
# The factor of a program's time limit: tests/CMakeLists.txt sets it where a sanitizer slows it down.
SLOWER = int(os.environ.get("SCUMBLE_TESTS_SLOWER", "1"))


class Failures:
    """Collects faults; the test fails at its end, with all of them."""

    def __init__(self):
        self.lines = []

    def check(self, right, what):
        if not right:
            self.lines.append(what)
            print("FAILED:", what, flush=True)
        return right

    def end(self):
        raise SystemExit(1 if self.lines else 0)


class Program:
    """The program, run in a folder of its own with a cache of its own."""

    def __init__(self, path, folder):
        self.path = str(path)
        self.folder = pathlib.Path(folder)
        self.environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))

    def start(self, *arguments, **more):
        command = [self.path, *map(str, arguments)]
        settings = dict(cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                        stderr=subprocess.PIPE, text=True)
        return subprocess.Popen(command, **{**settings, **more})

    def run(self, *arguments, patience=60, **more):
        """(exit code, stderr); the code is negative where a signal ended it, and None where it had to be stopped."""
        process = self.start(*arguments, **more)
        try:
            _, said = process.communicate(timeout=SLOWER * patience)
            return process.returncode, said or ""
        except subprocess.TimeoutExpired:
            process.kill()
            return None, (process.communicate()[1] or "") + "did not end"


def error_in(said):
    """The sentence of the error, or ""."""
    for line in said.splitlines():
        for start in ("scumble: error: ", "scumble: internal error: "):
            if line.startswith(start):
                return line[len(start):]
    return ""


def write_picture(path, values):
    """Rows × columns × channels of bytes."""
    height, width, channels = values.shape
    output = oiio.ImageOutput.create(str(path))
    spec = oiio.ImageSpec(width, height, channels, "uint8")
    if not output or not output.open(str(path), spec) or not output.write_image(values) or not output.close():
        raise SystemExit(f"{path}: {oiio.geterror()}")


def write_style(folder, size=64, rules=""):
    """A painted sphere of many colours, which compresses badly."""
    folder.mkdir(parents=True)
    y, x = numpy.mgrid[0:size, 0:size]
    inside = (x + 0.5 - size / 2) ** 2 + (y + 0.5 - size / 2) ** 2 <= (size / 2) ** 2
    paint = numpy.random.RandomState(7).randint(0, 256, (size, size, 4)).astype(numpy.uint8)
    paint[..., 3] = numpy.where(inside, 255, 0)
    write_picture(folder / "ball.png", paint)
    (folder / "style.toml").write_text('name = "ball"\n[transfer]\n' + rules + '[[exemplar]]\nimage = "ball.png"\n')


def contents(folder, ignored=()):
    """Bytes of every file below the folder, by its name there."""
    folder = pathlib.Path(folder)
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(folder.rglob("*")) if path.is_file() and path.name not in ignored}


def leftovers(folder):
    return sorted(name for name in os.listdir(folder) if name.endswith(SUFFIX))


def textured_scene(folder):
    """A .gltf of one square with a texture in a file of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    write_picture(folder / "paint.png", numpy.random.RandomState(3).randint(0, 256, (64, 64, 3)).astype(numpy.uint8))
    corners = numpy.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], numpy.float32)
    places = numpy.array([[0, 1], [1, 1], [1, 0], [0, 0]], numpy.float32)
    order = numpy.array([0, 1, 2, 0, 2, 3], numpy.uint16)
    parts = [corners.tobytes(), places.tobytes(), order.tobytes()]
    (folder / "square.bin").write_bytes(b"".join(parts))
    views = [{"buffer": 0, "byteOffset": sum(map(len, parts[:i])), "byteLength": len(part)}
             for i, part in enumerate(parts)]
    scene = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"name": "Square", "mesh": 0}, {"name": "Front", "camera": 0, "translation": [0, 0, 4]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"name": "Paint", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": "paint.png"}],
        "buffers": [{"byteLength": sum(map(len, parts)), "uri": "square.bin"}], "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}]}
    (folder / "square.gltf").write_text(json.dumps(scene))
    return folder / "square.gltf"


def temporary_folder():
    return tempfile.TemporaryDirectory(prefix="scumble_faults_")


def clean(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
