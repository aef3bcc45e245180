#!/usr/bin/env python3
"""Renders the guides that the styles scene-* share: exemplars/scene/guides.exr, of
scenes/ball.glb. Licence: CC0-1.0.

    python3 exemplars/paint/make_scene_guides.py [--scumble build/scumble] [--rendered FILE]

Needs numpy and OpenImageIO's Python module. Rendering takes some minutes; `--rendered` takes a file of the same
settings instead. The output of `scumble guidegen` is then made small enough for a repository: light that comes from
other surfaces, the only noisy part, is averaged among neighbours on the same object, and values are rounded to the
digits that matter.
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

SIDE, SAMPLES = 768, 448
LAYERS = "albedo,luminance,shadow,lpe.full,lpe.LDE,lpe.LSE,lpe.LDDE,lpe.LD12E"
REACH = 4.0  # sigma of the averaging, in pixels
COLOR_BITS, PLACE_STEP = 7, 2.0**-12  # mantissa of light; metres of depth and lengths of normals

HERE = Path(__file__).resolve().parent


def average(values, ids):
    """A Gaussian among the pixels of each object by itself. `values` is height × width × 3."""
    taps = np.exp(-0.5 * (np.arange(-12, 13) / REACH) ** 2)

    def blur(plane):
        for axis in (0, 1):
            padded = np.pad(plane, [(12, 12) if a == axis else (0, 0) for a in range(plane.ndim)])
            plane = sum(t * np.take(padded, range(i, i + plane.shape[axis]), axis) for i, t in enumerate(taps))
        return plane

    result = np.zeros_like(values)
    for one in np.unique(ids):
        inside = (ids == one).astype(np.float64)[..., None]
        result += inside * blur(values * inside) / np.maximum(blur(inside), 1e-12)
    return result


def rounded(values, bits):
    """To so many bits of mantissa."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(mantissa * 2.0**bits) / 2.0**bits, exponent)


def finish(source, target):
    reader = oiio.ImageInput.open(str(source))
    spec = reader.spec()
    pixels = reader.read_image("float").astype(np.float64)
    reader.close()
    at = {name: i for i, name in enumerate(spec.channelnames)}

    def planes(layer):
        return [at[f"{layer}.{c}"] for c in "RGB"]

    ids = pixels[..., at["object.ID"]]
    direct, mirrored = pixels[..., planes("lpe.LDE")], pixels[..., planes("lpe.LSE")]
    for layer, smooth in (("lpe.LDDE", 0.0), ("lpe.LD12E", direct), ("lpe.full", direct + mirrored)):
        pixels[..., planes(layer)] = smooth + average(pixels[..., planes(layer)] - smooth, ids)
    for name, i in at.items():
        if name.startswith("lpe.") or name == "luminance.Y":
            pixels[..., i] = rounded(pixels[..., i], COLOR_BITS)
        elif name.startswith(("normal.", "depth.", "shadow.")):
            pixels[..., i] = np.round(pixels[..., i] / PLACE_STEP) * PLACE_STEP
    spec.attribute("compression", "zip")
    writer = oiio.ImageOutput.create(str(target))
    if not writer.open(str(target), spec) or not writer.write_image(pixels.astype(np.float32)) or not writer.close():
        raise SystemExit(f"{target} cannot be written: {writer.geterror()}")


def main():
    parser = argparse.ArgumentParser(description="Renders the guides that the styles scene-* share.")
    parser.add_argument("--scumble", type=Path, default=HERE.parents[1] / "build/scumble")
    parser.add_argument("--rendered", type=Path, help="guides that guidegen has written with these settings")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rendered = arguments.rendered or Path(folder) / "ball.exr"
        if not arguments.rendered:
            subprocess.run([arguments.scumble, "guidegen", HERE.parents[1] / "scenes/ball.glb", "--size", str(SIDE),
                            "--layers", LAYERS, "--half", "--samples", str(SAMPLES), "-o", rendered], check=True)
        finish(rendered, HERE.parent / "scene/guides.exr")


if __name__ == "__main__":
    main()
