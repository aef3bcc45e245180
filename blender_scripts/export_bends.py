"""Normal maps and bumps in the terms of our extras: part of export_scene.py.

A surface's Normal may be fed by a Normal Map node with an image, in tangent or object space, by a Bump node whose
height is an image, or by such a bump over such a map. The exporter carries the map where glTF has normal maps, and the
height where it would carry the normal map of a clear coat, the only other place for an image as it is; afterwards
`complete` moves them into the extras. What else feeds a Normal is named in `unsupported` and left out.
"""

from dataclasses import dataclass, field

import bpy
import numpy as np

import export_images
from export_flat import material_key
from export_nodes import clear_links, constant, coordinates_of, name_of, previous, principled_input

SPACES = {"TANGENT", "OBJECT", "BLENDER_OBJECT"}
COAT = "KHR_materials_clearcoat"
ATTRIBUTE = "_scumble_v"  # as in export_rest.py
NEUTRAL = (0.5, 0.5, 1.0)  # a Normal Map node's colour that changes nothing


@dataclass
class Bends:
    """What bends a surface's normal: extras, and the image sockets of the map and of the height."""
    extras: dict = field(default_factory=dict)
    map: object = None
    height: object = None
    frame: object = None  # the name of the UV map in whose frame a tangent map lies, "": the active one


def read(socket, reader):
    bends = Bends()
    source = previous(socket) if socket is not None else None
    while source is not None:
        node = source.node
        if node.type == "BUMP":
            read_bump(node, bends, reader)
            source = previous(node.inputs["Normal"])
            continue
        if node.type == "NORMAL_MAP":
            read_map(node, bends, reader)
        elif node.type != "NEW_GEOMETRY" or source.name != "Normal":
            reader.complain(f"node '{node.name}' ({node.type}) feeds Normal and cannot be expressed; the surface's own "
                            "normal stays")
        break
    return bends


def read_map(node, bends, reader):
    where = f"normal map '{node.name}'"
    color, space = constant(node.inputs["Color"]), node.space
    strength = max(reader.number(node.inputs["Strength"]), 0.0)
    if strength == 0.0:
        return
    if space not in SPACES:
        space = space.lower().replace("_", " ")
        reader.complain(f"{where} is in {space} space, which cannot be expressed; it is left out")
        return
    if color is not None:
        if space != "TANGENT" or max(abs(a - b) for a, b in zip(color, NEUTRAL)) > 1e-6:
            reader.complain(f"{where} has a constant colour; it is left out")
        return
    image = previous(node.inputs["Color"])
    fault = fault_of(image, "data", reader)
    if fault is not None:
        reader.complain(f"{where}: {fault} cannot be expressed; it is left out")
        return
    check_tangents(node, image.node, where, reader)
    check_interpolation(image.node, where, reader)
    bends.map = image
    bends.frame = coordinates_of(image.node.inputs["Vector"])[0] if space == "TANGENT" else None
    bends.extras["normal"] = {"space": space, "strength": strength}


def fault_of(source, use, reader):
    """The fault in an image's colour as input; None where there is none."""
    if source.node.type != "TEX_IMAGE" or source.name != "Color":
        return f"node '{name_of(source.node)}' ({source.node.type}), its output {source.name},"
    return export_images.fault(source.node, use, reader.unsupported)


def check_tangents(node, image, where, reader):
    """The frame of a map comes from the UV map of its image, in glTF; from the one that the node names, in Cycles."""
    frame, places = node.uv_map, coordinates_of(image.inputs["Vector"])[0]
    if node.space != "TANGENT" or frame == places:
        return
    if "" in (frame, places):
        active = {layer.name for mesh in bpy.data.meshes if reader.name in mesh.materials
                  for layer in mesh.uv_layers if layer.active_render}
        if active <= {frame or places}:
            return
    reader.complain(f"{where} lies in the frame of UV map '{frame}' and its image in UV map '{places}'; the image's is "
                    "taken for both")


def check_interpolation(image, where, reader):
    if image.interpolation in {"Cubic", "Smart"}:
        reader.complain(f"{where}: interpolation {image.interpolation} of node '{name_of(image)}' is taken for Linear")


def read_bump(node, bends, reader):
    where = f"bump '{node.name}'"
    strength = max(reader.number(node.inputs["Strength"]), 0.0)
    distance = reader.number(node.inputs["Distance"]) * (-1.0 if node.invert else 1.0)
    image, factor = height_of(node.inputs["Height"])
    distance *= factor
    if image is None or strength == 0.0 or distance == 0.0:
        return
    fault = fault_of(image, "height", reader)
    if fault is not None:
        reader.complain(f"{where}: {fault} as Height cannot be expressed; the bump is left out")
        return
    if bends.height is not None:
        reader.complain(f"{where} lies under another bump, which alone is kept")
        return
    check_interpolation(image.node, where, reader)
    bends.height = image
    picture = image.node.image
    bends.extras["bump"] = {"strength": strength, "distance": distance * picture.get(export_images.RANGE, 1.0),
                            "srgb": picture.colorspace_settings.name == "sRGB"}


def height_of(socket):
    """(source, factor): the height is the source's value times the factor, plus a constant, which bends nothing. The
    source is None where the height is constant."""
    factor = 1.0
    while True:
        source = previous(socket)
        if source is None or source.node.type in {"RGB", "VALUE"}:
            return None, 0.0
        step = linear_step(source.node)
        if step is None:
            return source, factor
        socket, factor = step[0], factor * step[1]


def linear_step(node):
    """(input, factor) of a node whose value is that of one input times a factor, plus a constant; else None."""
    if node.type == "RGBTOBW":
        return node.inputs["Color"], 1.0
    if node.type == "INVERT" and constant(node.inputs[0]) is not None:
        return node.inputs["Color"], 1.0 - 2.0 * constant(node.inputs[0])
    if node.type != "MATH" or node.use_clamp:
        return None
    first, second = node.inputs[0], node.inputs[1]
    a, b = constant(first), constant(second)
    if node.operation in {"ADD", "SUBTRACT", "MULTIPLY", "DIVIDE"} and isinstance(b, (int, float)):
        scale = {"MULTIPLY": b, "DIVIDE": 1.0 / b if b else 0.0}
        return first, scale.get(node.operation, 1.0)
    if node.operation in {"ADD", "SUBTRACT", "MULTIPLY"} and isinstance(a, (int, float)):
        return second, {"ADD": 1.0, "SUBTRACT": -1.0, "MULTIPLY": a}[node.operation]
    return None


def attach(tree, principled, bends):
    """Gives the exporter's Principled node the images, and takes all else away from its Normal."""
    clear_links(tree, principled.inputs["Normal"])
    if bends.map is not None:
        node = tree.nodes.new("ShaderNodeNormalMap")
        node.inputs["Strength"].default_value = bends.extras["normal"]["strength"]
        tree.links.new(bends.map, node.inputs["Color"])
        tree.links.new(node.outputs["Normal"], principled.inputs["Normal"])
    if bends.height is not None:
        for name in ("Clearcoat", "Clearcoat Roughness", "Clearcoat Normal"):
            clear_links(tree, principled_input(principled, name))
        principled_input(principled, "Clearcoat").default_value = 1.0
        tree.links.new(bends.height, principled_input(principled, "Clearcoat Normal"))


def add_exact_v(flat, materials):
    """Gives meshes with a map in tangent space the v of their corners as an attribute; returns whether there are any.
    The exporter writes 1 − v, which rounds, and corners that are not quite equal would become so: Blender's tangents
    end at them."""
    done = set()
    for placed in flat.meshes:
        mesh = placed.mesh
        frames = [materials[material_key(slot)]["bends"].frame for slot in placed.slots]
        frame = next((frame for frame in frames if frame is not None), None)
        if frame is None or mesh.name in done:
            continue
        layer = next((layer for layer in mesh.uv_layers if layer.name == frame or (not frame and layer.active_render)),
                     None)
        if layer is None:
            continue
        done.add(mesh.name)
        places = np.empty(2 * len(mesh.loops), np.float32)
        layer.data.foreach_get("uv", places)
        attribute = mesh.attributes.new(ATTRIBUTE, "FLOAT", "CORNER")
        attribute.data.foreach_set("value", np.ascontiguousarray(places[1::2]))
    return bool(done)


def complete(material, extras):
    """The extras of a material that was exported, with the images that glTF has no place for."""
    extras = dict(extras)
    if extras.get("normal", {}).get("space", "TANGENT") != "TANGENT":
        extras["normal"] = {**extras["normal"], "texture": material.pop("normalTexture", None)}
        if extras["normal"]["texture"] is None:
            del extras["normal"]
    elif "normalTexture" not in material:
        extras.pop("normal", None)
    if "bump" in extras:
        coat = material.get("extensions", {}).pop(COAT, {})
        extras["bump"] = {**extras["bump"], "texture": coat.get("clearcoatNormalTexture")}
        if extras["bump"]["texture"] is None:
            del extras["bump"]
        if not material.get("extensions", True):
            del material["extensions"]
    return extras


def drop_unused_coat(document):
    used = any(COAT in material.get("extensions", {}) for material in document.get("materials", []))
    if not used and COAT in document.get("extensionsUsed", []):
        document["extensionsUsed"].remove(COAT)
        if not document["extensionsUsed"]:
            del document["extensionsUsed"]
