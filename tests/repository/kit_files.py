#!/usr/bin/python3
"""Reads the output of `scumble sphere` with other programs: the layers with Python's zipfile and OpenImageIO, the page
with poppler. All three files must show the same template, to the pixel.

Usage: kit_files.py PROGRAM
"""
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
import zipfile

import numpy
import OpenImageIO as oiio


def check(right, what):
    if not right:
        raise SystemExit(f"kit_files: {what}")


def run(*command, **more):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True, **more).stdout


def pixels(path):
    """8-bit RGBA as height × width × 4."""
    source = oiio.ImageInput.open(str(path))
    check(source is not None, f"{path}: {oiio.geterror()}")
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(path), config)
    return source.read_image("uint8").reshape(source.spec().height, source.spec().width, -1).astype(int)


def over(top, below, opacity):
    alpha = top[..., 3:] / 255 * opacity
    return top[..., :3] * alpha + below * (1 - alpha)


def check_png(path, side, dpi):
    """The resolution stands in the chunk pHYs: pixels a metre, twice, and 1 for the metre."""
    data = path.read_bytes()
    at = data.find(b"pHYs")
    check(at > 0, "template.png has no pHYs")
    across, down, unit = struct.unpack(">IIB", data[at + 4:at + 13])
    check(unit == 1 and across == down and abs(across * 0.0254 - dpi) < 0.02, f"pHYs says {across} a metre")
    check(pixels(path).shape == (side, side, 4), "template.png has another size")


def check_layers(path, template, dpi, work):
    with zipfile.ZipFile(path) as archive:
        check(archive.testzip() is None, "a wrong checksum")
        entries = archive.infolist()
        check(entries[0].filename == "mimetype" and entries[0].compress_type == zipfile.ZIP_STORED,
              "mimetype is not first and stored")
        check(archive.read("mimetype") == b"image/openraster", "mimetype")
        check(all(entry.date_time == (1980, 1, 1, 0, 0, 0) for entry in entries), "a date")
        archive.extractall(work)
    image = xml.etree.ElementTree.parse(work / "stack.xml").getroot()
    side = template.shape[0]
    check(image.get("w") == image.get("h") == str(side) and image.get("xres") == str(dpi),
          "size or resolution in stack.xml")
    layers = image.find("stack").findall("layer")
    check([layer.get("name") for layer in layers if layer.get("selected")] == ["paint here"], "one layer is selected")
    check([layer.get("name") for layer in layers if not layer.get("edit-locked")] == ["paint here"],
          "all others are locked")
    shown = numpy.zeros((side, side, 3))
    for layer in reversed(layers):
        picture = pixels(work / layer.get("src"))
        check(picture.shape == (side, side, 4), f"{layer.get('name')} has another size")
        check((layer.get("visibility") == "hidden") == layer.get("name").startswith("guide"),
              "guides are hidden, others are shown")
        check(picture[..., 3].any() != (layer.get("name") == "paint here"), f"{layer.get('name')}: painted or not")
        if layer.get("visibility") == "visible":
            shown = over(picture, shown, float(layer.get("opacity")))
    check(numpy.abs(shown - template[..., :3]).max() <= 0.5, "the layers together are not the template")
    check((pixels(work / "mergedimage.png") == template).all(), "mergedimage.png is not the template")
    check(pixels(work / "Thumbnails/thumbnail.png").shape == (256, 256, 4), "the thumbnail's size")


def check_page(path, template, size, dpi, work, paper):
    info = dict(line.split(":", 1) for line in run("pdfinfo", path).splitlines() if ":" in line)
    width, height = (float(part) for part in info["Page size"].split()[0:3:2])
    check(abs(width / 72 * 25.4 - paper[0]) < 0.02 and abs(height / 72 * 25.4 - paper[1]) < 0.02,
          f"page of {info['Page size']}")
    check(info["Pages"].strip() == "1" and "CreationDate" not in info, "one page, no date")
    run("pdftoppm", "-r", dpi, "-gray", "-png", "-singlefile", path, work / "page")
    page = pixels(work / "page.png")[..., 0]
    side = template.shape[0]
    margin = (side - size) // 2
    left = round((paper[0] / 25.4 * dpi - side) / 2)
    top = round(8 / 25.4 * dpi)
    shown = page[top:top + side, left:left + side]
    grey = template[..., 0]
    inner = (slice(margin, margin + size), slice(margin, margin + size))
    # The sphere: 18% as dark as in the template, but for the line around it, 0.2 mm wide.
    down, across = numpy.mgrid[0:side, 0:side] + 0.5 - side / 2
    from_edge = numpy.abs(numpy.hypot(down, across) - size / 2)
    width = 0.2 / 25.4 * dpi
    beside = from_edge > width / 2 + 1
    pale = numpy.abs(255 - (255 - grey) * 0.18 - shown)
    check(pale[inner][beside[inner]].max() <= 1.5, "the pale sphere")
    check(width < 1 or abs(shown[from_edge < 0.15].mean() - 184) < 30, "the line around the sphere")
    # The marks, as dark as there. The template mixes edges between pixels in light, the page in its encoding.
    outside = numpy.ones_like(grey, bool)
    outside[inner] = False
    sharp = outside & beside & ((grey == 0) | (grey == 255))
    check(numpy.abs(grey - shown)[sharp].max() <= 1, "the marks")
    check((grey[outside] == 0).sum() > size * size // 100, "there are marks to compare")
    page[top:top + side, left:left + side] = 255
    words = numpy.argwhere(page < 200)
    check(len(words) and words[:, 0].min() >= top + side, "only words, under the template")
    room = round(8 / 25.4 * dpi)
    check(words[:, 1].max() < page.shape[1] - room and words[:, 1].min() >= room
          and words[:, 0].max() < page.shape[0] - room,
          "words stay off the page's edge")
    lowest = page[words[:, 0].max() - round(3 / 25.4 * dpi):] < 128
    bar = lowest.sum(axis=1).max() / dpi * 25.4
    check(abs(bar - 50) < 1.1 * 25.4 / dpi, f"the bar is {bar} mm long")
    text = run("pdftotext", path, "-")
    for words in ("Print at 100%", f"{size} pixels at {dpi} dpi", "50 mm", "the upper left", "--rectify"):
        check(words in text, f"the page lacks '{words}'")


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    for size, dpi, page, paper in ((512, 150, "a4", (210, 297)), (640, 110, "letter", (215.9, 279.4)),
                                   (450, 72, "a3", (297, 420))):
        with tempfile.TemporaryDirectory() as folder:
            work = pathlib.Path(folder)
            kit = work / "kit"
            command = (program, "sphere", "--size", size, "--dpi", dpi, "--page", page, "--quiet", "-o")
            run(*command, kit)
            template = pixels(kit / "template.png")
            check_png(kit / "template.png", size + 2 * ((size + 7) // 8), dpi)
            check_layers(kit / "template.ora", template, dpi, work)
            check_page(kit / "template.pdf", template, size, dpi, work, paper)
            # The clock and the place leave no trace.
            run(*command, work / "again", env={**os.environ, "TZ": "XXX-11"})
            for name in ("template.png", "template.ora", "template.pdf"):
                check((kit / name).read_bytes() == (work / "again" / name).read_bytes(),
                      f"{name} differs from run to run")


if __name__ == "__main__":
    main()
