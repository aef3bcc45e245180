"""Materials: those that the export takes as they are, and those that it has to simplify."""

import bpy

from export_cases.parts import checker, cube, new_material, textured


def mixed(name):
    material, node = new_material(name, "ShaderNodeMixShader")
    material.diffuse_color = (0.1, 0.2, 0.3, 1.0)
    return material


def bent(name, *nodes):
    """A Diffuse surface whose Normal is fed by a chain of nodes, the last one first: (type, what feeds it, settings).
    What feeds it is an image or the type of a node."""
    surface, shader = new_material(name, "ShaderNodeBsdfDiffuse")
    tree, socket = surface.node_tree, shader.inputs["Normal"]
    for kind, feed, settings in nodes:
        node = tree.nodes.new("ShaderNode" + kind)
        for key, value in settings.items():
            if key[0].isupper():
                node.inputs[key].default_value = value
            else:
                setattr(node, key, value)
        tree.links.new(node.outputs["Normal" if "Normal" in node.outputs else 0], socket)
        if isinstance(feed, str):
            source = tree.nodes.new("ShaderNode" + feed)
        elif feed is not None:
            source = tree.nodes.new("ShaderNodeTexImage")
            source.image = feed
        if feed is not None:
            tree.links.new(source.outputs["Color"], node.inputs["Height" if kind == "Bump" else "Color"])
        socket = node.inputs.get("Normal")
    return surface


def bent_materials(colors):
    numbers = bpy.data.images.new("Numbers", 4, 4, is_data=True)
    numbers.pixels.foreach_set([0.5, 0.25, 1.0, 1.0] * 16)
    numbers.pack()
    by_map = ("NormalMap", numbers, {"Strength": 0.5})
    every = [
        bent("BumpOnMap", ("Bump", numbers, {"Strength": 0.75, "Distance": 0.5, "invert": True}), by_map),
        bent("PaintedBump", ("Bump", colors, {}), ("NewGeometry", None, {})),
        bent("ObjectMap", ("NormalMap", numbers, {"space": "OBJECT"})),
        bent("NoBend", ("Bump", None, {}), ("NormalMap", None, {})),
        bent("NoiseOnMap", ("Bump", "TexNoise", {}), by_map),
        bent("TwoBumps", ("Bump", numbers, {}), ("Bump", colors, {})),
        bent("WorldMap", ("NormalMap", numbers, {"space": "WORLD"})),
        bent("PaintedMap", ("NormalMap", colors, {})),
        bent("Bevelled", ("Bevel", None, {})),
    ]
    tree = every[1].node_tree  # half the height, upside down: a factor of −½ and two constants
    for operation, inputs in (("MULTIPLY", (None, 0.5)), ("SUBTRACT", (1.0, None))):
        math = tree.nodes.new("ShaderNodeMath")
        math.operation = operation
        height = tree.nodes["Bump"].inputs["Height"]
        for socket, value in zip(math.inputs, inputs):
            if value is None:
                tree.links.new(height.links[0].from_socket, socket)
            else:
                socket.default_value = value
        tree.links.new(math.outputs[0], height)
    principled = textured("PrincipledBump", "ShaderNodeBsdfPrincipled", colors, "Base Color")
    tree = principled.node_tree
    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(tree.nodes["Image Texture"].outputs["Color"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], tree.nodes["Principled BSDF"].inputs["Normal"])
    return every + [principled]


def materials():
    image = checker()
    every = [
        new_material("Diffuse", "ShaderNodeBsdfDiffuse", Color=(0.2, 0.4, 0.8, 1))[0],
        new_material("Glossy", "ShaderNodeBsdfGlossy", Color=(0.9, 0.7, 0.3, 1), Roughness=0.3)[0],
        new_material("Sharp", "ShaderNodeBsdfGlossy", Color=(1, 1, 1, 1), Roughness=0.3)[0],
        new_material("Emission", "ShaderNodeEmission", Color=(1.0, 0.5, 0.25, 1), Strength=4.0)[0],
        new_material("Principled", "ShaderNodeBsdfPrincipled", Base_Color=(0.3, 0.6, 0.9, 1), Metallic=0.25,
                     Roughness=0.35, Emission=(0.5, 0.25, 0.0, 1), Emission_Strength=3.0)[0],
        new_material("Waxy", "ShaderNodeBsdfPrincipled", Subsurface=0.3)[0],
        textured("DiffuseTextured", "ShaderNodeBsdfDiffuse", image),
        textured("GlossyTextured", "ShaderNodeBsdfGlossy", image, mapping=True),
        textured("EmissionTextured", "ShaderNodeEmission", image),
        textured("PrincipledTextured", "ShaderNodeBsdfPrincipled", image, "Base Color"),
        new_material("Seen", "ShaderNodeBsdfDiffuse")[0],
        new_material("Noisy", "ShaderNodeBsdfDiffuse", Color=(0.5, 0.25, 0.75, 1))[0],
        mixed("Mixed"),
        bpy.data.materials.new("Plain"),
        new_material("Unlinked", "ShaderNodeBsdfDiffuse")[0],
        new_material("Rough", "ShaderNodeBsdfDiffuse", Roughness=0.6)[0],
        *bent_materials(image),
    ]
    by_name = {material.name: material for material in every}
    sharp = by_name["Sharp"].node_tree.nodes["Glossy BSDF"]
    if bpy.app.version < (4, 0):
        sharp.distribution = "SHARP"
    else:  # which has roughness 0 in its place
        sharp.inputs["Roughness"].default_value = 0.0
    by_name["EmissionTextured"].node_tree.nodes["Emission"].inputs["Strength"].default_value = 2.0
    by_name["Plain"].diffuse_color = (0.7, 0.6, 0.5, 1.0)
    by_name["Diffuse"].use_backface_culling = True
    by_name["Unlinked"].node_tree.links.clear()
    painted = by_name["Seen"].node_tree
    attribute = painted.nodes.new("ShaderNodeVertexColor")
    attribute.layer_name = "Paint"
    painted.links.new(attribute.outputs["Color"], painted.nodes["Diffuse BSDF"].inputs["Color"])
    noisy = by_name["Noisy"].node_tree
    noisy.links.new(noisy.nodes.new("ShaderNodeTexNoise").outputs["Color"], noisy.nodes["Diffuse BSDF"].inputs["Color"])
    for number, material in enumerate(every):
        cube("On" + material.name, (2.0 * number, 0, 0), material)
    two = bpy.data.objects["OnBumpOnMap"].data  # the exporter writes an attribute for it, and must keep both materials
    two.materials.append(by_name["Glossy"])
    two.polygons[0].material_index = 1
    for name in ("OnSeen", "OnDiffuse"):  # the same colours; only one material reads them
        data = bpy.data.objects[name].data
        for layer in ("Other", "Paint"):
            paint = data.color_attributes.new(layer, "FLOAT_COLOR", "POINT")
            for i in range(len(data.vertices)):
                paint.data[i].color = (0.25, 0.5, 0.75, 1.0) if layer == "Paint" else (1, 0, 0, 1)
    cube("OnNothing", (-2, 0, 0))
    by_name["Glossy"].pass_index = 7
    return {}
