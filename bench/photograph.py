#!/usr/bin/python3
"""Photographs a painted template askew on a table, in warm light from the left, for the gallery.

Usage: photograph.py TEMPLATE PAINTING PHOTOGRAPH     PAINTING covers the template's inner square.
"""
import sys

import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT = 1000, 780
TILT, AXIS, TURN = np.radians((24.0, 35.0, -13.0))
POINTS = 2  # in each direction, per pixel


def read(name):
    pixels = oiio.ImageBuf(name).get_pixels(oiio.FLOAT)[:, :, :3]
    return np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)


def turned(axis, angle):
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def main():
    template, painting, photograph = sys.argv[1:]
    sheet, paint = read(template), read(painting)
    margin = (sheet.shape[0] - paint.shape[0]) // 2
    sheet[margin:-margin, margin:-margin] = paint
    side = sheet.shape[0]
    # Sheet, in sides of the template around its middle, to picture.
    turn = turned(np.array([0, 0, 1]), TURN) @ turned(np.array([np.cos(AXIS), np.sin(AXIS), 0]), TILT)
    focal = 0.75 * WIDTH
    camera = np.array([[focal, 0, WIDTH / 2], [0, focal, HEIGHT / 2], [0, 0, 1]])
    back = np.linalg.inv(camera @ np.column_stack([turn[:, 0], turn[:, 1], [0, 0, focal / 560]]))
    y, x = (np.mgrid[0:HEIGHT * POINTS, 0:WIDTH * POINTS] + 0.5) / POINTS
    at = np.einsum("ij,jyx->iyx", back, np.stack([x, y, np.ones_like(x)]))
    u, v = at[0] / at[2], at[1] / at[2]
    i, j = (np.clip((w + 0.5) * side, 0, side - 1).astype(int) for w in (u, v))
    light = np.where((np.maximum(abs(u), abs(v)) < 0.5)[..., None], sheet[j, i], 1.0)
    light = np.where((np.maximum(abs(u), abs(v)) < 0.56)[..., None], light, (0.10, 0.06, 0.035))
    light = light.reshape(HEIGHT, POINTS, WIDTH, POINTS, 3).mean(axis=(1, 3))
    lamp = (1 - 0.4 * np.linspace(0, 1, WIDTH))[None, :, None] * np.array([0.88, 0.76, 0.55])
    light = light * lamp
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    encoded += np.random.default_rng(1).normal(0, 0.012, encoded.shape)
    picture = oiio.ImageBuf(oiio.ImageSpec(WIDTH, HEIGHT, 3, oiio.FLOAT))
    picture.set_pixels(oiio.ROI(), np.clip(encoded, 0, 1).astype(np.float32))
    picture.specmod().attribute("CompressionQuality", 85)
    if not picture.write(photograph, oiio.UINT8):
        sys.exit(picture.geterror())


main()
