"""Holes in Principled surfaces: part of export_scene.py.

Guides know no half-transparent surfaces: what lies below one half is a hole, all else is solid.
"""

import numpy as np

from export_nodes import clear_links, image_fault, one_texture, previous

CUT = 0.5
MOSTLY = (0.1, 0.9)  # between them an alpha is neither hole nor surface
MOST_PIXELS = 2048 * 2048  # of an image that is looked at
SOFT_SHARE = 0.1  # of an image's pixels: more is no soft rim


def alphas_of(source):
    """The values of an image's output as the exporter takes them, a row for each of the picture; empty where it cannot
    be read, or is so large that to look at it would take longer than to export the rest."""
    image = source.node.image
    width, height = image.size if image is not None else (0, 0)
    if width * height > MOST_PIXELS:
        return np.empty((0, 0), np.float32)
    values = np.empty(len(image.pixels) if width else 0, np.float32)
    if not values.size or values.size != width * height * image.channels:
        return np.empty((0, 0), np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(height, width, -1)
    if source.name == "Alpha":
        return values[..., 3] if image.channels == 4 else np.ones((height, width), np.float32)
    return values[..., 0]


def close_clipped(source, alphas, reader):
    """Beyond an image that is clipped all is hole, as it is if the picture's rim is a hole that goes on."""
    rims = (alphas[0], alphas[-1], alphas[:, 0], alphas[:, -1]) if alphas.size else ()
    if any(rim.max() >= CUT for rim in rims):
        reader.complain(f"image '{source.node.image.name}' is its alpha and clipped: beyond it, its rim goes on")
    source.node.extension = "EXTEND"


def fault_of(source, color, reader):
    """The reason why the image cannot be the surface's alpha; None where it can."""
    fault = image_fault(source.node, "alpha" if source.name == "Alpha" else "any")
    if fault is None and color is not None and not one_texture(source.node, color.node, reader.shown_map):
        fault = f"node '{source.node.name}' at other places than the colour's image, with which it shares a texture,"
    return fault


def set_constant(tree, socket, value):
    """Sets 0 or 1. Returns whether that is a hole."""
    clear_links(tree, socket)
    socket.default_value = float(value >= CUT)
    return value < CUT


def read(tree, node, color, reader):
    """Whether the Principled node has holes. `color`: the image's output that is its colour, None for another. An alpha
    that cannot be expressed is cut off."""
    socket = node.inputs["Alpha"]
    source = previous(socket)
    if source is None or source.node.type != "TEX_IMAGE":
        value = reader.number(socket)
        if 0.0 < value < 1.0:
            reader.complain(f"its alpha {value:.3g} is cut at one half: the surface is "
                            + ("left out" if value < CUT else "solid"))
        return set_constant(tree, socket, value)
    if source.name == "Alpha" and source.node.image is not None and source.node.image.alpha_mode == "NONE":
        return set_constant(tree, socket, 1.0)  # as in Cycles
    alphas = alphas_of(source)
    if source.node.extension == "CLIP" and source.node.image is not None:
        close_clipped(source, alphas, reader)
    fault = fault_of(source, color, reader)
    if fault is not None:
        reader.complain(f"{fault} feeds Alpha, which keeps its own value instead")
        return set_constant(tree, socket, socket.default_value)
    soft = np.count_nonzero((alphas > MOSTLY[0]) & (alphas < MOSTLY[1]))
    if soft > SOFT_SHARE * alphas.size:
        reader.complain(f"image '{source.node.image.name}' is its alpha and half transparent in wide parts, which are "
                        "cut at one half")
    return True
