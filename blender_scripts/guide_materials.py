"""Materials that two renderers mean alike, and light-path filters built of nodes: part of render_guides.py."""

import bpy

from export_nodes import constant, principled_input

SPECULAR = {"BSDF_GLOSSY", "BSDF_ANISOTROPIC", "BSDF_GLASS", "BSDF_REFRACTION"}


def trees():
    """Every node tree that shades a surface, node groups included."""
    for material in bpy.data.materials:
        if material.use_nodes and material.node_tree:
            yield material.node_tree, material
    for group in bpy.data.node_groups:
        if group.type == "SHADER":
            yield group, None


def feed(tree, socket, source):
    """Gives `socket` the link or the value of `source`, an input of the same kind."""
    if source.is_linked:
        tree.links.new(source.links[0].from_socket, socket)
    else:
        socket.default_value = source.default_value


def take_over(tree, old, new):
    """Everything that `old`, an output, fed is fed by `new`."""
    for link in list(old.links):
        if link.to_node != new.node:
            tree.links.new(new, link.to_socket)


def math(tree, operation, first, second):
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    for socket, value in zip(node.inputs, (first, second)):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        else:
            socket.default_value = value
    return node.outputs[0]


def has_image(socket):
    """Whether an image is anywhere behind an input."""
    pending, seen = [socket], set()
    while pending:
        for link in pending.pop().links:
            node = link.from_node
            if node.type == "TEX_IMAGE":
                return True
            if node.name not in seen:
                seen.add(node.name)
                pending += node.inputs
    return False


def is_metal(node):
    """As guidegen decides: a texture of metalness or roughness makes the surface diffuse, else metalness does."""
    if has_image(node.inputs["Metallic"]) or has_image(node.inputs["Roughness"]):
        return False
    metallic = constant(node.inputs["Metallic"])
    return (node.inputs["Metallic"].default_value if metallic is None else metallic) >= 0.5


def purify_node(tree, node, cutoff):
    glossy = is_metal(node)
    shader = tree.nodes.new("ShaderNodeBsdfGlossy" if glossy else "ShaderNodeBsdfDiffuse")
    feed(tree, shader.inputs["Color"], node.inputs["Base Color"])
    if glossy:
        shader.distribution = "GGX"
        feed(tree, shader.inputs["Roughness"], node.inputs["Roughness"])
    else:
        shader.inputs["Roughness"].default_value = 0.0
    if node.inputs["Normal"].is_linked:
        feed(tree, shader.inputs["Normal"], node.inputs["Normal"])
    surface = shader.outputs[0]
    strength, color = node.inputs["Emission Strength"], principled_input(node, "Emission")
    dark = not color.is_linked and max(color.default_value[:3]) == 0.0
    if not dark and (strength.is_linked or strength.default_value != 0.0):
        emission = tree.nodes.new("ShaderNodeEmission")
        feed(tree, emission.inputs["Color"], color)
        feed(tree, emission.inputs["Strength"], strength)
        both = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(surface, both.inputs[0])
        tree.links.new(emission.outputs[0], both.inputs[1])
        surface = both.outputs[0]
    alpha = node.inputs["Alpha"]
    if alpha.is_linked or alpha.default_value < 1.0:
        holes = tree.nodes.new("ShaderNodeMixShader")
        transparent = tree.nodes.new("ShaderNodeBsdfTransparent")
        kept = math(tree, "LESS_THAN", 0.0, cutoff)
        feed(tree, kept.node.inputs[0], alpha)
        tree.links.new(kept, holes.inputs[0])
        tree.links.new(surface, holes.inputs[1])
        tree.links.new(transparent.outputs[0], holes.inputs[2])
        surface = holes.outputs[0]
    take_over(tree, node.outputs[0], surface)
    tree.nodes.remove(node)


def purify():
    """Puts a pure Diffuse or a pure Glossy GGX shader in the place of every Principled one, as guidegen does with
    glTF's metallic-roughness surfaces for a cross-check. Emission and normal maps stay; alpha is cut where guidegen
    cuts it."""
    for tree, material in list(trees()):
        cutoff = material.alpha_threshold if material and material.blend_method == "CLIP" else 0.5
        for node in [node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"]:
            purify_node(tree, node, cutoff)


def dim(tree, socket, factor):
    """Multiplies an input of numbers by `factor`, an output."""
    if not socket.is_linked:
        if socket.default_value == 0.0:
            return
        product = math(tree, "MULTIPLY", socket.default_value, factor)
    else:
        product = math(tree, "MULTIPLY", socket.links[0].from_socket, factor)
    tree.links.new(product, socket)


def blacken_principled(tree, node, second, elsewhere):
    """The remaining part of a Principled surface is diffuse: the base colour times 1 − metalness."""
    metallic = node.inputs["Metallic"]
    if metallic.is_linked or metallic.default_value > 0.0:
        share = math(tree, "MULTIPLY", second, 0.0)
        feed(tree, share.node.inputs[1], metallic)
        darken = tree.nodes.new("ShaderNodeMixRGB")
        darken.blend_type = "MIX"
        darken.inputs["Color2"].default_value = (0.0, 0.0, 0.0, 1.0)
        tree.links.new(share, darken.inputs[0])
        feed(tree, darken.inputs["Color1"], node.inputs["Base Color"])
        tree.links.new(darken.outputs[0], node.inputs["Base Color"])
    for name in ("Metallic", "Specular", "Clearcoat", "Transmission", "Sheen"):
        dim(tree, principled_input(node, name), elsewhere)


def blacken_second_surface():
    """Removes the specular lobes where a path meets its second surface, so that light reflected to a diffuse surface
    comes from diffuse ones. Returns whether any material was changed."""
    changed = False
    for tree, _ in list(trees()):
        nodes = [node for node in tree.nodes if node.type in SPECULAR or node.type == "BSDF_PRINCIPLED"]
        if not nodes:
            continue
        changed = True
        path = tree.nodes.new("ShaderNodeLightPath")
        second = math(tree, "COMPARE", path.outputs["Ray Depth"], 1.0)
        second.node.inputs[2].default_value = 0.5
        elsewhere = math(tree, "SUBTRACT", 1.0, second)
        for node in nodes:
            if node.type == "BSDF_PRINCIPLED":
                blacken_principled(tree, node, second, elsewhere)
                continue
            choice = tree.nodes.new("ShaderNodeMixShader")  # its other input stays empty: no surface at all
            take_over(tree, node.outputs[0], choice.outputs[0])
            tree.links.new(second, choice.inputs[0])
            tree.links.new(node.outputs[0], choice.inputs[1])
    return changed
