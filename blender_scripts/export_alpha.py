"""Holes in surfaces, by a Principled node's Alpha or a Mix Shader with Transparent: part of export_scene.py.

Guides know no half-transparent surfaces: what lies below one half is a hole, all else is solid.
"""

import bpy
import numpy as np

import export_images
from export_nodes import ORIGINAL, clear_links, constant, name_of, one_texture, previous, stand_for

CUT = 0.5
MOSTLY = (0.1, 0.9)  # between them an alpha is neither hole nor surface
MOST_PIXELS = 2048 * 2048  # of an image that is looked at
SOFT_SHARE = 0.1  # of an image's pixels: more is no soft rim
MASK, INVERTED = "scumble_mask", "scumble_inverted"  # properties of an image, by output: the mask that stands for it


def is_transparent(source):
    """Whether it is a Transparent shader that lets at least half of every colour through."""
    if source is None or source.node.type != "BSDF_TRANSPARENT":
        return False
    color = constant(source.node.inputs["Color"])
    return color is not None and min(color) >= CUT


def inverted_by(node):
    """The input whose value the node takes from 1; None for other nodes."""
    if node.type == "INVERT" and constant(node.inputs["Fac"]) == 1.0:
        return node.inputs["Color"]
    if node.type == "MATH" and node.operation == "SUBTRACT" and constant(node.inputs[0]) == 1.0:
        return node.inputs[1]
    return None


def mask_of(source, invert):
    """A white image whose alpha is that output of an image, or 1 minus it; None where the image cannot be read."""
    image, key = source.node.image, f"{INVERTED if invert else MASK}.{source.name}"
    if key not in image:
        values = values_of(source).ravel()
        if not values.size:
            return None
        pixels = np.ones((values.size, 4), np.float32)
        pixels[:, 3] = np.clip(1.0 - values if invert else values, 0.0, 1.0)
        copy = bpy.data.images.new(image.name, *image.size, alpha=True)
        copy.pixels.foreach_set(pixels.ravel())
        copy.pack()
        stand_for(copy, image)
        copy[f"{MASK}.Alpha"] = 0
        image[key] = copy
    return image[key] or image


def masked(tree, source, invert):
    """The alpha of a node like the image's whose picture is that output's mask; `source` where it has to stay."""
    node = source.node
    mask = mask_of(source, invert)
    if mask in (None, node.image):
        return source
    other = tree.nodes.new("ShaderNodeTexImage")
    other[ORIGINAL] = name_of(node)
    other.image, other.interpolation, other.extension = mask, node.interpolation, node.extension
    below = previous(node.inputs["Vector"])
    if below is not None:
        tree.links.new(below, other.inputs["Vector"])
    return other.outputs["Alpha"]


def inverted(tree, source, reader):
    """The output of an image's copy that is 1 where the image is 0; the image's own where that has a fault."""
    fault = export_images.fault(source.node, "alpha", reader.unsupported)
    return source if fault is not None else masked(tree, source, True)


def without_transparent(tree, surface, reader):
    """What a Mix Shader of Transparent and another shader shows: that shader's output, and its alpha, a number or an
    image's output. Transparent alone is nothing with an alpha of 0; any other surface is itself without an alpha."""
    if is_transparent(surface):
        return None, 0.0
    if surface.node.type != "MIX_SHADER":
        return surface, None
    factor, *sides = surface.node.inputs
    sides = [previous(side) for side in sides]
    clear = [is_transparent(side) for side in sides]
    if None in sides or clear[0] == clear[1]:
        return surface, None
    invert = clear[1]  # the factor is the second shader's share
    source = previous(factor)
    while source is not None and inverted_by(source.node) is not None:
        factor, invert = inverted_by(source.node), not invert
        source = previous(factor)
    alpha = constant(factor)
    if isinstance(alpha, tuple):
        alpha = alpha[0]
    if alpha is None and source.node.type == "TEX_IMAGE":
        alpha = source
        if source.name == "Alpha" and source.node.image is not None and source.node.image.alpha_mode == "NONE":
            alpha = 1.0  # as in Cycles
        elif invert:
            alpha = inverted(tree, source, reader)
    if alpha is None:
        return surface, None
    if isinstance(alpha, float) and invert:
        alpha = 1.0 - alpha
    return sides[0] if clear[1] else sides[1], alpha


def put(tree, node, alpha, reader):
    """Gives the Principled node the alpha of a Mix Shader around it."""
    socket = node.inputs["Alpha"]
    own = previous(socket)
    if (own is not None and own != alpha) or (own is None and socket.default_value != 1.0):
        reader.complain("Principled Alpha within a Mix Shader with Transparent is ignored")
    clear_links(tree, socket)
    socket.default_value = 1.0
    if isinstance(alpha, float):
        socket.default_value = min(max(alpha, 0.0), 1.0)
    else:
        tree.links.new(alpha, socket)


def values_of(source):
    """The values of an image's output as the exporter takes them, a row for each of the picture; empty where it cannot
    be read."""
    image = source.node.image
    width, height = image.size if image is not None else (0, 0)
    values = np.empty(len(image.pixels) if width else 0, np.float32)
    if not values.size or values.size != width * height * image.channels:
        return np.empty((0, 0), np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(height, width, -1)
    if source.name == "Alpha":
        return values[..., 3] if image.channels == 4 else np.ones((height, width), np.float32)
    return values[..., 0]


def alphas_of(source):
    """The same; empty also where the image is so large that to look at it would take longer than to export the rest."""
    image = source.node.image
    is_large = image is not None and image.size[0] * image.size[1] > MOST_PIXELS
    return np.empty((0, 0), np.float32) if is_large else values_of(source)


def close_clipped(source, reader):
    """Beyond an image that is clipped all is hole, as it is if the picture's rim is a hole that goes on."""
    alphas = alphas_of(source)
    rims = (alphas[0], alphas[-1], alphas[:, 0], alphas[:, -1]) if alphas.size else ()
    if any(rim.max() >= CUT for rim in rims):
        reader.complain(f"image '{name_of(source.node.image)}' is its alpha and clipped: beyond it, its rim goes on")
    source.node.extension = "EXTEND"


def fault_of(source, color, reader):
    """The reason why the image cannot be the surface's alpha; None where it can."""
    fault = export_images.fault(source.node, "alpha" if source.name == "Alpha" else "any", reader.unsupported)
    if fault is None and color is not None and not one_texture(source.node, color.node, reader.shown_map):
        fault = (f"node '{name_of(source.node)}' at other places than the colour's image, with which it shares a "
                 "texture,")
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
    if source.node.extension == "CLIP" and source.node.image is not None:
        close_clipped(source, reader)
    fault = fault_of(source, color, reader)
    if fault is not None:
        reader.complain(f"{fault} feeds Alpha, which keeps its own value instead")
        return set_constant(tree, socket, socket.default_value)
    alphas = alphas_of(source)
    soft = np.count_nonzero((alphas > MOSTLY[0]) & (alphas < MOSTLY[1]))
    if soft > SOFT_SHARE * alphas.size:
        reader.complain(f"image '{name_of(source.node.image)}' is its alpha and half transparent in wide parts, which "
                        "are cut at one half")
    if color is None and source.name == "Alpha":  # else the exporter would write its RGB as the colour
        tree.links.new(masked(tree, source, False), socket)
    return True
