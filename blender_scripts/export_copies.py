"""Prepares the copy of a material's nodes, so that they say what Cycles does: part of export_scene.py.

Muted nodes and links go, an image's own mapping becomes a node, mappings in a row become one, the UV of the instancer
becomes a map, and images whose alpha is not read get Cycles' colours. What reads an image gets a node of its own.
"""

import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from export_nodes import (INSTANCER_MAP, ORIGINAL, READS_ALPHA, is_odd_panel, is_plain_mapping, is_used_panel, name_of,
                          passed_through, previous, stand_for, trace)

ASSOCIATED = "scumble_associated"  # property of an image: the one that stands for it


def make_zero(socket):
    value = getattr(socket, "default_value", None)
    if isinstance(value, float):
        socket.default_value = 0.0
    elif value is not None and not isinstance(value, (int, str)):
        socket.default_value = [0.0] * min(len(value), 3) + [1.0] * (len(value) - 3)


def bypass_muted(tree):
    """A muted node hands one of its inputs on; if nothing feeds that one, Cycles takes zero."""
    for link in [link for link in tree.links if link.is_muted]:
        tree.links.remove(link)
    for node in [node for node in tree.nodes if node.mute]:
        for output in node.outputs:
            handed = passed_through(output)
            source = trace(handed)[0]
            for socket in [link.to_socket for link in output.links]:
                if source is not None:
                    tree.links.new(source, socket)
                elif handed is not None:
                    make_zero(socket)
        tree.nodes.remove(node)


def name_instancer_map(tree):
    """What takes the UV of the instancer reads the map in which export_maps.py stores that."""
    for node in [node for node in tree.nodes if getattr(node, "from_instancer", False)]:
        named = tree.nodes.new("ShaderNodeUVMap")
        named.uv_map = INSTANCER_MAP
        for link in list(node.outputs["UV"].links):
            tree.links.new(named.outputs["UV"], link.to_socket)


def spread_panel(tree):
    """The Texture Mapping panel of an image becomes a Mapping node, where one can say it."""
    for node in [node for node in tree.nodes if node.type == "TEX_IMAGE"]:
        panel = node.texture_mapping
        if is_odd_panel(panel) or not is_used_panel(panel):
            continue
        source = previous(node.inputs["Vector"]) or tree.nodes.new("ShaderNodeTexCoord").outputs["UV"]
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.name, mapping.vector_type = f"Texture Mapping of {node.name}", panel.vector_type
        for name, value, nothing in (("Location", "translation", 0.0), ("Rotation", "rotation", 0.0),
                                     ("Scale", "scale", 1.0)):
            mapping.inputs[name].default_value = getattr(panel, value)
            setattr(panel, value, (nothing,) * 3)
        tree.links.new(source, mapping.inputs["Vector"])
        tree.links.new(mapping.outputs[0], node.inputs["Vector"])


def merge(upper, lower):
    """Puts the lower mapping into the upper one; false where one node cannot say both."""
    inputs = [{socket.name: socket.default_value for socket in node.inputs if socket.name != "Vector"}
              for node in (lower, upper)]
    first, then = inputs
    turn, scale = first["Rotation"][2], then["Scale"]
    if abs(turn) > 1e-6 and abs(scale[0] - scale[1]) > 1e-6 * abs(scale[0]):
        return False
    moved = Vector(a * b for a, b in zip(scale, first["Location"]))
    moved = Matrix.Rotation(then["Rotation"][2], 3, "Z") @ moved + Vector(then["Location"])
    then["Location"][:] = moved
    then["Scale"][:] = [a * b for a, b in zip(scale, first["Scale"])]
    then["Rotation"][2] = math.remainder(then["Rotation"][2] + turn, 2 * math.pi)
    return True


def merge_mappings(tree):
    for upper in [node for node in tree.nodes if is_plain_mapping(node)]:
        source = previous(upper.inputs["Vector"])
        while source is not None and is_plain_mapping(source.node) and merge(upper, source.node):
            source = previous(source.node.inputs["Vector"])
            for link in list(upper.inputs["Vector"].links):
                tree.links.remove(link)
            if source is not None:
                tree.links.new(source, upper.inputs["Vector"])


def associated(image):
    """The image whose colours are multiplied by alpha, before they are decoded; the image itself where it is opaque."""
    if ASSOCIATED not in image:
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(-1, 4)
        image[ASSOCIATED] = 0
        if pixels.size and pixels[:, 3].min() < 1.0:
            pixels[:, :3] *= pixels[:, 3:]
            pixels[:, 3] = 1.0
            copy = bpy.data.images.new(image.name, *image.size)
            copy.pixels.foreach_set(pixels.ravel())
            copy.pack()
            stand_for(copy, image)
            image[ASSOCIATED] = copy
    return image[ASSOCIATED] if image[ASSOCIATED] != 0 else image


def associate_images(tree):
    """Cycles multiplies straight alpha into the colour unless something reads the alpha."""
    for node in [node for node in tree.nodes if node.type == "TEX_IMAGE" and node.image is not None]:
        image = node.image
        if node.outputs["Alpha"].is_linked or image.alpha_mode != "STRAIGHT":
            continue
        if image.source not in {"FILE", "GENERATED"} or image.colorspace_settings.name != "sRGB":
            continue
        if image.depth == 32 and image.channels == 4:
            node.image = associated(image)


def give_each_its_own(tree):
    """What reads an image's colour gets a node of its own, which may have another copy of the image than the others."""
    readers = {}
    for node in tree.nodes:
        for socket in node.inputs if node.type != "REROUTE" else ():
            source = previous(socket) if socket.is_linked else None
            if source is not None and source.node.type == "TEX_IMAGE" and source.name == "Color":
                readers.setdefault(source.node.name, []).append(socket)
        if node.type == "TEX_IMAGE":
            node[READS_ALPHA] = node.outputs["Alpha"].is_linked
    for name, sockets in readers.items():
        if not is_odd_panel(tree.nodes[name].texture_mapping):
            for socket in sockets[1:]:
                tree.links.new(twin_of(tree, tree.nodes[name]).outputs["Color"], socket)


def twin_of(tree, node):
    twin = tree.nodes.new("ShaderNodeTexImage")
    for name in ("image", "interpolation", "extension", "projection"):
        setattr(twin, name, getattr(node, name))
    twin[ORIGINAL], twin[READS_ALPHA] = name_of(node), node[READS_ALPHA]
    source = previous(node.inputs["Vector"])
    if source is not None:
        tree.links.new(source, twin.inputs["Vector"])
    return twin


def prepare(tree):
    bypass_muted(tree)
    name_instancer_map(tree)
    spread_panel(tree)
    merge_mappings(tree)
    associate_images(tree)
    give_each_its_own(tree)
