"""Materials of a glTF scene as guidegen understands them: part of render_guides.py."""

import bpy

from export_nodes import principled_input
from guide_materials import feed, math as math_node, take_over

IGNORED_MATERIALS = {"KHR_materials_unlit", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_sheen"}


def ours(extras):
    """What stands in extras.scumble, or nothing."""
    found = extras.get("scumble") if isinstance(extras, dict) else None
    return found if isinstance(found, dict) else {}


def complete_material(source, unsupported):
    for extension in sorted(IGNORED_MATERIALS & set(source.extensions or {})):
        unsupported.add(f"material '{source.name}': {extension} is shaded otherwise by Blender than here")
    for name in source.blender_material.values():
        material = bpy.data.materials[name]
        tree = material.node_tree
        mend_emission(tree)
        principled = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
        bsdf = ours(source.extras).get("bsdf")
        if principled is not None and isinstance(bsdf, dict):
            apply_bsdf(tree, principled, bsdf)
        if not source.double_sided:
            hide_back(tree)


def mend_emission(tree):
    """The importer of 3.4 links its factor's node by the wrong output."""
    for node in tree.nodes:
        if node.type == "MIX" and node.label == "Emissive Factor":
            for link in list(node.outputs[0].links):
                tree.links.new(node.outputs[2], link.to_socket)


def tint(tree, socket, color):
    """Base colour: texture and vertex colours as imported, times the colour."""
    if not socket.is_linked:
        socket.default_value = (*color, 1.0)
        return
    source = socket.links[0].from_socket
    if source.node.label == "Color Factor":
        source.node.inputs[7].default_value = (*color, 1.0)
        return
    factor = tree.nodes.new("ShaderNodeMixRGB")
    factor.blend_type = "MULTIPLY"
    factor.inputs[0].default_value = 1.0
    tree.links.new(source, factor.inputs["Color1"])
    factor.inputs["Color2"].default_value = (*color, 1.0)
    tree.links.new(factor.outputs[0], socket)


def apply_bsdf(tree, principled, bsdf):
    tint(tree, principled.inputs["Base Color"], bsdf["color"])
    if bsdf["type"] == "PRINCIPLED":
        for key, name in (("roughness", "Roughness"), ("metallic", "Metallic")):
            if bsdf.get(key) is not None and not principled.inputs[name].is_linked:
                principled.inputs[name].default_value = bsdf[key]
        emission = principled_input(principled, "Emission")
        if bsdf.get("emission") is not None and not emission.is_linked:
            emission.default_value = (*bsdf["emission"], 1.0)
            principled.inputs["Emission Strength"].default_value = 1.0
        return
    kind = {"DIFFUSE": "ShaderNodeBsdfDiffuse", "GLOSSY": "ShaderNodeBsdfGlossy", "EMISSION": "ShaderNodeEmission"}
    shader = tree.nodes.new(kind[bsdf["type"]])
    feed(tree, shader.inputs["Color"], principled.inputs["Base Color"])
    if bsdf["type"] == "EMISSION":
        shader.inputs["Strength"].default_value = bsdf["strength"]
    else:
        if bsdf["type"] == "GLOSSY":
            shader.distribution = "GGX"
        shader.inputs["Roughness"].default_value = bsdf.get("roughness", 0.0)
        if principled.inputs["Normal"].is_linked:
            feed(tree, shader.inputs["Normal"], principled.inputs["Normal"])
    take_over(tree, principled.outputs[0], shader.outputs[0])
    tree.nodes.remove(principled)


def hide_back(tree):
    """A surface that glTF calls one-sided has no back to the camera; other rays meet both of its sides."""
    output = next((node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"), None)
    if output is None or not output.inputs["Surface"].is_linked:
        return
    surface = output.inputs["Surface"].links[0].from_socket
    side = tree.nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"]
    seen = tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"]
    choice = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(math_node(tree, "MULTIPLY", side, seen), choice.inputs[0])
    tree.links.new(surface, choice.inputs[1])
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], choice.inputs[2])
    tree.links.new(choice.outputs[0], output.inputs["Surface"])
