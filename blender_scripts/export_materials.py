"""Materials in the terms of glTF and our extras: part of export_scene.py.

Every material becomes a new one with a Principled node that carries its colour and texture, which the exporter keeps,
and an entry of extras with the original shader. Other parts of a node tree are listed in `unsupported`; an unknown tree
becomes a Diffuse surface in the material's viewport colour.
"""

import bpy

import export_alpha
import export_bends
import export_copies
import export_images
import export_styles
from export_nodes import clear_links, constant, name_of, one_texture, previous, principled_input

PLAIN = {"BSDF_DIFFUSE": "DIFFUSE", "BSDF_GLOSSY": "GLOSSY", "EMISSION": "EMISSION", "BSDF_PRINCIPLED": "PRINCIPLED"}
CYCLES_DEFAULT = (0.8, 0.8, 0.8)  # Cycles' material of faces without one
GGX = {"GGX", "MULTI_GGX"}

# Inputs of the Principled node that nothing here can express, and the value at which they do nothing.
IGNORED = {"Subsurface": 0.0, "Specular": 0.5, "Specular Tint": 0.0, "Anisotropic": 0.0, "Sheen": 0.0, "Clearcoat": 0.0,
           "Transmission": 0.0, "Diffuse Roughness": 0.0, "Thin Film Thickness": 0.0}
DEFAULT_INDEX, CLOSE_INDEX = 1.5, 0.06  # 1.45 was the default of 4.0 and 4.1: F0 is 0.034 instead of 0.04
CYCLES_OWN = {"N", "generated", "pointiness", "random_per_island", "tangent"}  # attributes that no mesh stores
OPAQUE = ": its surfaces are opaque, also to light"
GLASS = {"BSDF_GLASS", "BSDF_REFRACTION", "BSDF_TRANSLUCENT"}
WHITE = (1.0, 1.0, 1.0)  # of Specular Tint from Blender 4.0 on, where it is a colour


class Reader:
    """Reads one material's nodes; losses go to `unsupported` under the material's name."""

    def __init__(self, name, shown_map, unsupported):
        self.name = name
        self.shown_map = shown_map  # the UV map that renders take, "" where its meshes differ
        self.unsupported = unsupported

    def complain(self, what):
        self.unsupported.add(f"material '{self.name}': {what}")

    def number(self, socket):
        value = constant(socket)
        if value is None:
            node = previous(socket).node
            self.complain(f"node '{name_of(node)}' ({node.type}) feeds {socket.name}, which keeps its own value "
                          "instead")
            value = socket.default_value
        return float(value)

    def color(self, socket):
        """The colour, and the part of the input that glTF can keep: nothing, an image's socket, or an attribute: its
        name, "" for the mesh's own choice, and whether it has to be one of colours."""
        value = constant(socket)
        if value is not None:
            return value, None
        source = previous(socket)
        node = source.node
        if node.type == "TEX_IMAGE" and source.name == "Color":
            fault = export_images.fault(node, "colour", self.unsupported)
            if fault is None:
                return (1.0, 1.0, 1.0), source
            self.complain(f"{fault} feeds {socket.name}, which keeps its own colour instead")
        elif node.type == "VERTEX_COLOR" and source.name == "Color":
            return (1.0, 1.0, 1.0), (node.layer_name, True)
        elif node.type == "ATTRIBUTE" and source.name == "Color" and node.attribute_type == "GEOMETRY":
            if not node.attribute_name:
                return (0.0, 0.0, 0.0), None  # as in Cycles
            if node.attribute_name in CYCLES_OWN:
                self.complain(f"attribute '{node.attribute_name}', which Cycles makes up, is black")
            return (1.0, 1.0, 1.0), (node.attribute_name, False)
        else:
            self.complain(f"node '{name_of(node)}' ({node.type}) feeds {socket.name}, which keeps its own colour "
                          "instead")
        return tuple(socket.default_value)[:3], None


def is_texture(source):
    return True if isinstance(source, bpy.types.NodeSocket) else None


def surface_of(material):
    output = material.node_tree.get_output_node("CYCLES")
    return output, previous(output.inputs["Surface"]) if output else None


def diffuse(color):
    return {"type": "DIFFUSE", "color": list(color), "roughness": 0.0, "texture": None}


def read_plain(kind, node, reader):
    """A Diffuse, Glossy or Emission node: its extras and the input of its colour."""
    color, source = reader.color(node.inputs["Color"])
    bsdf = {"type": kind, "color": list(color), "texture": is_texture(source)}
    if kind == "EMISSION":
        bsdf["strength"] = reader.number(node.inputs["Strength"])
        return bsdf, source
    bsdf["roughness"] = reader.number(node.inputs["Roughness"])
    if kind == "GLOSSY":
        bsdf["distribution"] = node.distribution
        if node.distribution == "SHARP":
            bsdf["roughness"] = 0.0
        elif node.distribution not in GGX:
            reader.complain(f"distribution {node.distribution} is taken for GGX")
    bsdf["roughness"] = min(max(bsdf["roughness"], 0.0), 1.0)  # as Cycles clamps it
    return bsdf, source


def number_image(socket):
    """The node of the image that feeds an input of numbers, alone or by one of its channels; None where none does."""
    source = previous(socket)
    if source is not None and source.node.type in {"SEPARATE_COLOR", "SEPRGB"}:
        source = previous(source.node.inputs[0])
    return source.node if source is not None and source.node.type == "TEX_IMAGE" else None


def keep_or_cut(tree, reader, node, name, beside=None):
    """An input of numbers that only an image may feed. Returns its constant, or None for an image. `beside`: another
    input's image, which shares a texture with it."""
    image = number_image(node.inputs[name])
    if image is not None and export_images.fault(image, "data", reader.unsupported) is None:
        if beside is None or one_texture(image, beside, reader.shown_map):
            return None
        reader.complain(f"node '{name_of(image)}' at other places than the roughness' image, with which it shares a "
                        f"texture, feeds {name}, which keeps its own value instead")
        value = node.inputs[name].default_value
    else:
        value = reader.number(node.inputs[name])
    value = min(max(value, 0.0), 1.0)  # as Cycles clamps it
    clear_links(tree, node.inputs[name])
    node.inputs[name].default_value = value
    return value


def drop_ignored(tree, node, reader):
    for name, nothing in IGNORED.items():
        socket = principled_input(node, name)
        if socket is None:
            continue
        value = socket.default_value
        if not isinstance(value, float):
            value, nothing = tuple(value)[:3], WHITE
        if previous(socket) is None and value == nothing:
            continue
        reader.complain(f"Principled {socket.name} is ignored" + (OPAQUE if name == "Transmission" else ""))
        clear_links(tree, socket)
        socket.default_value = nothing if isinstance(nothing, float) else (*nothing, 1.0)
    # From Blender 4.0 on the index is that of the reflection, too.
    index = node.inputs["IOR"]
    if "Specular IOR Level" in node.inputs:
        if previous(index) is not None or abs(index.default_value - DEFAULT_INDEX) > CLOSE_INDEX:
            reader.complain(f"Principled IOR is taken for {DEFAULT_INDEX}")
        clear_links(tree, index)
        index.default_value = DEFAULT_INDEX


def read_principled(tree, node, reader):
    """Everything of the Principled node that glTF has no place for is cut off its copy, so that nothing half-understood
    is exported."""
    color, source = reader.color(node.inputs["Base Color"])
    emits = principled_input(node, "Emission")
    emission, emission_source = reader.color(emits)
    strength = reader.number(node.inputs["Emission Strength"])
    if isinstance(emission_source, tuple):
        reader.complain("a colour attribute feeds Emission, which keeps its own colour instead")
        emission, emission_source = tuple(emits.default_value)[:3], None
    if emission_source is None:
        clear_links(tree, emits)
        emits.default_value = (*emission, 1.0)
    roughness = keep_or_cut(tree, reader, node, "Roughness")
    beside = number_image(node.inputs["Roughness"])
    bsdf = {"type": "PRINCIPLED", "color": list(color), "texture": is_texture(source), "roughness": roughness,
            "metallic": keep_or_cut(tree, reader, node, "Metallic", beside),
            "emission": [strength * c for c in emission] if emission_source is None else None,
            "strength": strength, "distribution": node.distribution}
    drop_ignored(tree, node, reader)
    return bsdf, source, export_alpha.read(tree, node, source if is_texture(source) else None, reader)


def rebuild(copy, bsdf, source, bends, surface, output):
    """Puts a Principled node that carries the colour in the place of another surface node, and returns it."""
    tree = copy.node_tree
    carrier = tree.nodes.new("ShaderNodeBsdfPrincipled")
    carrier.inputs["Base Color"].default_value = (*[min(max(c, 0.0), 1.0) for c in bsdf["color"]], 1.0)
    carrier.inputs["Metallic"].default_value = 1.0 if bsdf["type"] == "GLOSSY" else 0.0
    carrier.inputs["Roughness"].default_value = bsdf.get("roughness", 1.0) if bsdf["type"] == "GLOSSY" else 1.0
    if bsdf["type"] == "EMISSION":
        principled_input(carrier, "Emission").default_value = carrier.inputs["Base Color"].default_value
        carrier.inputs["Emission Strength"].default_value = bsdf["strength"]
    if isinstance(source, bpy.types.NodeSocket):
        tree.links.new(source, carrier.inputs["Base Color"])
        if bsdf["type"] == "EMISSION":
            tree.links.new(source, principled_input(carrier, "Emission"))
    export_bends.attach(tree, carrier, bends)
    if surface:
        tree.nodes.remove(surface.node)
    tree.links.new(carrier.outputs[0], output.inputs["Surface"])
    return carrier


def shown_surface(copy, reader):
    """The output node, the surface's output and the alpha of a Mix Shader with Transparent, None without one, which
    leaves the tree. A surface of None with an alpha is nothing."""
    tree = copy.node_tree
    output, surface = surface_of(copy)
    if output is None:
        return tree.nodes.new("ShaderNodeOutputMaterial"), None, None
    has_volume = previous(output.inputs["Volume"]) is not None
    if surface is None and has_volume:
        reader.complain("it has a volume and no surface: its faces are left out")
        return output, None, 0.0
    for name in ("Volume", "Displacement"):
        if previous(output.inputs[name]) is not None:
            reader.complain(f"its {name.lower()} is ignored")
    if surface is None:
        return output, None, None
    shown, alpha = export_alpha.without_transparent(tree, surface, reader)
    if alpha is not None:
        tree.nodes.remove(surface.node)
    if shown is not None:
        tree.links.new(shown, output.inputs["Surface"])
    return output, shown, alpha


def unknown_surface(copy, surface, reader):
    if surface is None:
        reader.complain("a surface without a node is black")
        return diffuse((0.0, 0.0, 0.0))  # as in Cycles
    reader.complain(f"node '{surface.node.name}' ({surface.node.type}) cannot be expressed; it is Diffuse in its "
                    "viewport colour instead" + (OPAQUE if surface.node.type in GLASS else ""))
    return diffuse(copy.diffuse_color[:3])


def simplify_nodes(copy, reader):
    """The extras of a material with nodes, whose copy is made exportable; what bends its normals; whether it has holes;
    and the attribute that is its colour."""
    tree = copy.node_tree
    export_copies.prepare(tree)
    output, surface, alpha = shown_surface(copy, reader)
    kind = PLAIN.get(surface.node.type) if surface else None
    bends = export_bends.read(surface.node.inputs.get("Normal") if kind else None, reader)
    if kind == "PRINCIPLED":
        if alpha is not None:
            export_alpha.put(tree, surface.node, alpha, reader)
        bsdf, source, holes = read_principled(tree, surface.node, reader)
        if source is None:
            clear_links(tree, surface.node.inputs["Base Color"])
            surface.node.inputs["Base Color"].default_value = (*bsdf["color"], 1.0)
        export_bends.attach(tree, surface.node, bends)
    else:
        if kind is not None:
            bsdf, source = read_plain(kind, surface.node, reader)
        elif surface is None and alpha is not None:
            bsdf, source = diffuse((0.0, 0.0, 0.0)), None
        else:
            bsdf, source = unknown_surface(copy, surface, reader), None
        carrier = rebuild(copy, bsdf, source, bends, surface, output)
        holes = False
        if alpha is not None:
            export_alpha.put(tree, carrier, alpha, reader)
            holes = export_alpha.read(tree, carrier, source if is_texture(source) else None, reader)
    if isinstance(source, tuple):
        carrier = surface_of(copy)[1].node.inputs["Base Color"]
        clear_links(tree, carrier)
        carrier.default_value = (1.0, 1.0, 1.0, 1.0)
    return bsdf, bends, holes, source if isinstance(source, tuple) else None


def copy_at_this_frame(material):
    """A copy without animation and drivers, which would set its values anew at the frame of the export's scene."""
    copy = material.copy()
    for owner in (copy, copy.node_tree):
        if owner is not None:
            owner.animation_data_clear()
    return copy


def simplify(materials, shown_maps, unsupported):
    """For each material by its key: {"material": the exporter's, "name": the original's, "extras": …, …}. `shown_maps`:
    the names of the UV maps that renders take, likewise."""
    entries = {}
    for number, (key, material) in enumerate(materials.items()):
        if material is None:
            copy = bpy.data.materials.new("scumble")
            copy.diffuse_color = (*CYCLES_DEFAULT, 1.0)
            name = "default"
        else:
            copy, name = copy_at_this_frame(material), material.name
        copy.name = f"scumble.{number:06d}"
        shown = next(iter(shown_maps[key])) if len(shown_maps[key]) == 1 else ""
        holes, bends, bsdf, attribute = False, export_bends.Bends(), diffuse(copy.diffuse_color[:3]), None
        if copy.use_nodes and copy.node_tree:
            bsdf, bends, holes, attribute = simplify_nodes(copy, Reader(name, shown, unsupported))
        # Old files hold values beyond 1 here, which the exporter writes for a material without nodes.
        copy.roughness, copy.metallic = min(copy.roughness, 1.0), min(copy.metallic, 1.0)
        # These settings are the viewport's; Cycles shows both sides of every surface and always applies alpha.
        copy.use_backface_culling = False
        copy.blend_method = "BLEND" if holes else "OPAQUE"
        extras = {"bsdf": bsdf, **bends.extras, "pass_index": material.pass_index if material else 0}
        style = export_styles.own_style(material) if material else None
        if style is not None:
            extras["style"] = style
        entries[key] = {"material": copy, "name": name, "extras": extras, "exported": copy.name, "bends": bends,
                        "color_attribute": attribute}
    return entries
