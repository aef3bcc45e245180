"""Materials that few files have, each on a plane in a cell of its own: part of make_oddities.py.

Every texture has cells of one colour, so that renderers need not interpolate alike.
"""

import bpy
import numpy as np

COLUMNS, SIZE, GRID = 8, 0.9, 4


def plane(name, cell, material=None, collection=None):
    """A grid of 4 x 4 quads with a UV map from 0 to 1."""
    places = [(SIZE * (x / GRID - 0.5), SIZE * (y / GRID - 0.5), 0) for y in range(GRID + 1) for x in range(GRID + 1)]
    row = GRID + 1
    faces = [(y * row + x, y * row + x + 1, y * row + x + row + 1, y * row + x + row)
             for y in range(GRID) for x in range(GRID)]
    data = bpy.data.meshes.new(name)
    data.from_pydata(places, [], faces)
    data.uv_layers.new(name="UVMap")
    fill_map(data, "UVMap", 1.0)
    if material:
        data.materials.append(material)
    thing = bpy.data.objects.new(name, data)
    thing.location = (cell % COLUMNS, -(cell // COLUMNS), 0)
    (collection or bpy.context.scene.collection).objects.link(thing)
    return thing


def fill_map(data, name, scale):
    for loop in data.loops:
        place = data.vertices[loop.vertex_index].co
        data.uv_layers[name].data[loop.index].uv = [scale * (place[axis] / SIZE + 0.5) for axis in (0, 1)]


def shader(name, kind="ShaderNodeBsdfDiffuse"):
    """(material, node tree, surface node)"""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    surface = tree.nodes.new(kind)
    tree.links.new(surface.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material, tree, surface


def diffuse(name, color):
    material, _, surface = shader(name)
    surface.inputs["Color"].default_value = (*color, 1)
    return material


def picture(name, alpha=1.0):
    """4 x 4 cells; the lower half has that alpha."""
    image = bpy.data.images.new(name, 4, 4, alpha=alpha < 1.0)
    y, x = np.mgrid[0:4, 0:4]
    image.pixels.foreach_set(np.stack([x / 4, y / 4, (x + y) % 2, np.where(y < 2, alpha, 1.0)], axis=2)
                             .astype(np.float32).ravel())
    image.pack()
    return image


def textured(name, image, *chain):
    """A Diffuse surface; `chain` has what feeds the image's coordinates, the nearest first: (type, settings)."""
    material, tree, surface = shader(name)
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    tree.links.new(texture.outputs["Color"], surface.inputs["Color"])
    socket = texture.inputs["Vector"]
    for kind, settings in chain:
        node = tree.nodes.new("ShaderNode" + kind)
        for key, value in settings.items():
            if key[0].isupper():
                node.inputs[key].default_value = value
            else:
                setattr(node, key, value)
        tree.links.new(node.outputs["UV" if kind in {"UVMap", "TexCoord"} else 0], socket)
        socket = node.inputs["Vector"] if "Vector" in node.inputs else None
    return material


def painted(name, kind, attribute):
    material, tree, surface = shader(name)
    node = tree.nodes.new("ShaderNode" + kind)
    setattr(node, "layer_name" if kind == "VertexColor" else "attribute_name", attribute)
    tree.links.new(node.outputs["Color"], surface.inputs["Color"])
    return material


def paint(thing, name, kind, domain, prop, value):
    """An attribute whose items hold `value` of a number from 0 to 1."""
    thing.data.attributes.new(name, kind, domain)
    items = thing.data.attributes[name].data
    for number, item in enumerate(items):
        setattr(item, prop, value(number / len(items)))


def rainbow(share):
    return share, 0.5, 0.1, 1


# ---- The cells ------------------------------------------------------------------------------------------------------


def attributes():
    named = painted("named", "VertexColor", "B")
    for cell, (kind, domain) in enumerate((("FLOAT_COLOR", "CORNER"), ("BYTE_COLOR", "CORNER"),
                                           ("FLOAT_COLOR", "FACE"))):
        paint(plane(f"{kind} {domain}", cell, named), "B", kind, domain, "color", rainbow)
    paint(plane("Numbers", 3, painted("numbers", "Attribute", "n")), "n", "FLOAT", "POINT", "value", lambda n: n)
    paint(plane("Vectors", 4, painted("vectors", "Attribute", "v")), "v", "FLOAT_VECTOR", "POINT", "vector",
          lambda n: (n, 0.2, 0.9))
    paint(plane("Edges", 30, named), "B", "FLOAT_COLOR", "EDGE", "color", rainbow)
    paint(plane("Whole", 32, painted("whole", "Attribute", "B")), "B", "INT", "FACE", "value", lambda n: int(n > 0.4))
    plane("Missing", 5, painted("missing", "Attribute", "nowhere"))
    render = plane("Unnamed", 6, painted("unnamed", "VertexColor", ""))
    two = plane("Both", 7, named)
    two.data.materials.append(painted("other", "VertexColor", "A"))
    two.data.materials.append(diffuse("plain", (0.2, 0.3, 0.9)))
    for polygon in two.data.polygons:
        polygon.material_index = polygon.index % 3
    for thing in (render, two):
        paint(thing, "A", "FLOAT_COLOR", "POINT", "color", lambda n: (1, n, 0, 1))
        paint(thing, "B", "FLOAT_COLOR", "CORNER", "color", rainbow)
        thing.data.color_attributes.active_color_index = 0
        thing.data.color_attributes.render_color_index = 1


def maps():
    image = picture("Cells")
    shared = textured("shared", image, ("UVMap", {"uv_map": "paint"}))
    for cell, order in ((8, ("paint", "light")), (9, ("light", "more", "paint")), (10, ("light",))):
        thing = plane("Order " + " ".join(order), cell, shared)
        layers = thing.data.uv_layers
        layers[0].name = order[0]
        for name in order[1:]:
            layers.new(name=name)
        for name in order:
            fill_map(thing.data, name, 1.0 if name == "paint" else 0.3)
    plane("EmptySlots", 11).data.materials.append(None)
    turned = ("Mapping", {"Rotation": (0, 0, 0.5)})
    plane("TwoMappings", 12, textured("mapped twice", image, turned, ("Mapping", {"Scale": (2, 3, 1),
                                      "Location": (0.1, 0.2, 0)}), ("TexCoord", {})))
    plane("Straight", 13, textured("straight alpha", picture("Glass", 0.3)))


def tilted():
    return textured("tilted", picture("Cells"), ("Mapping", {"Rotation": (1, 0, 0)}), ("TexCoord", {}))


def muted():
    image = picture("Muted")
    plane("MutedMapping", 14, textured("muted mapping", image, ("Mapping", {"Scale": (4, 4, 4), "mute": True}),
                                       ("TexCoord", {})))
    hue = textured("muted hue", image)
    tree = hue.node_tree
    node = tree.nodes.new("ShaderNodeHueSaturation")
    node.mute = True
    surface = tree.nodes["Diffuse BSDF"]
    tree.links.new(tree.nodes["Image Texture"].outputs["Color"], node.inputs["Color"])
    tree.links.new(node.outputs["Color"], surface.inputs["Color"])
    plane("MutedHue", 15, hue)
    mix, tree, surface = shader("muted mix")
    surface.inputs["Color"].default_value = (1, 0, 0, 1)
    node = tree.nodes.new("ShaderNodeMixShader")
    node.mute = True
    tree.links.new(surface.outputs[0], node.inputs[1])
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    plane("MutedMix", 16, mix)
    blank, tree, surface = shader("muted, unfed")
    surface.inputs["Color"].default_value = (1, 0, 0, 1)
    node = tree.nodes.new("ShaderNodeHueSaturation")
    node.inputs["Color"].default_value, node.mute = (0, 1, 0, 1), True
    tree.links.new(node.outputs["Color"], surface.inputs["Color"])
    plane("MutedUnfed", 17, blank)


def numbers():
    glow, tree, surface = shader("glow", "ShaderNodeEmission")
    strength = tree.nodes.new("ShaderNodeRGB")
    strength.outputs[0].default_value = (0, 1, 0, 1)
    tree.links.new(strength.outputs[0], surface.inputs["Strength"])
    plane("Glow", 18, glow)


def feed(tree, image, output, inputs, scale=None, uv_map=None, extension="REPEAT"):
    """An image that feeds inputs of the Principled node, at mapped places or by a UV map of that name."""
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.extension = image, extension
    if scale:
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = (scale, scale, 1)
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    elif uv_map:
        named = tree.nodes.new("ShaderNodeUVMap")
        named.uv_map = uv_map
        tree.links.new(named.outputs[0], texture.inputs["Vector"])
    for name in inputs:
        tree.links.new(texture.outputs[output], tree.nodes["Principled BSDF"].inputs[name])


def holes():
    """Alpha, and two images of numbers, in cells of the last two rows."""
    mask = bpy.data.images.new("Mask", 8, 8)
    y, x = np.mgrid[0:8, 0:8]
    inside = (x > 0) & (x < 7) & (y > 0) & (y < 5)
    mask.pixels.foreach_set(np.stack([inside, inside, inside, np.ones((8, 8))], axis=2).astype(np.float32).ravel())
    mask.colorspace_settings.name = "Non-Color"
    mask.pack()
    fade, unread = picture("Fade", 0.4), picture("Unread", 0.3)
    unread.alpha_mode = "NONE"
    wanted = {
        "glass": [], "fade": [(fade, "Alpha", ["Alpha"])], "unread": [(unread, "Alpha", ["Alpha"])],
        "elsewhere": [(fade, "Color", ["Base Color"]), (mask, "Color", ["Alpha"], 3)],
        "named": [(fade, "Color", ["Base Color"]), (mask, "Color", ["Alpha"], None, "UVMap")],
        "alone": [(mask, "Color", ["Alpha"], 3)], "clipped": [(mask, "Color", ["Alpha"], 3, None, "CLIP")],
        "two": [(mask, "Color", ["Roughness"]), (mask, "Color", ["Metallic"], 3)],
        "one": [(mask, "Color", ["Roughness", "Metallic"], 3)]}
    for number, (name, images) in enumerate(wanted.items()):
        material, tree, surface = shader(name, "ShaderNodeBsdfPrincipled")
        surface.inputs["Alpha"].default_value = 0.3 if name == "glass" else 1.0
        for image in images:
            feed(tree, *image)
        plane("Holes " + name, 24 + number, material)


def mixed(name, kind, transparent, image=None, output="Alpha", factor=1.0, invert="", colored=True):
    """A Mix Shader of a shader and Transparent, which is its first or second input. `invert`: a node on the way.
    `colored`: by an image whose alpha is the factor, too."""
    material, tree, mix = shader(name, "ShaderNodeMixShader")
    mix.inputs["Fac"].default_value = factor
    clear, other = (tree.nodes.new("ShaderNode" + one) for one in ("BsdfTransparent", kind))
    tree.links.new(clear.outputs[0], mix.inputs[1 + transparent])
    tree.links.new(other.outputs[0], mix.inputs[2 - transparent])
    if image:
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image, texture.interpolation = image, "Closest"
        source = texture.outputs[output]
        if output == "Alpha" and colored and invert != "Math":  # Cycles forgets colours where alpha is 0
            tree.links.new(texture.outputs["Color"], other.inputs[0])
        if invert:
            node = tree.nodes.new("ShaderNode" + invert)
            if invert == "Math":
                node.operation, node.inputs[0].default_value = "SUBTRACT", 1.0
            tree.links.new(source, node.inputs[1])
            source = node.outputs[0]
        tree.links.new(source, mix.inputs["Fac"])
    return material


def leaves():
    """Cards whose lower half is a hole, one side of a factor's cut, and what nobody sees."""
    leaf = picture("Leaf", 0.0)
    mask = bpy.data.images.new("Leaf mask", 4, 4)
    mask.colorspace_settings.name = "Non-Color"  # before its pixels, which it would reset
    mask.pixels.foreach_set((np.mgrid[0:4, 0:4, 0:4][0] > 1).astype(np.float32).ravel())
    mask.pack()
    plane("Leaf", 19, mixed("leaf", "BsdfDiffuse", 0, leaf))
    plane("LeafSwapped", 34, mixed("leaf swapped", "BsdfPrincipled", 1, leaf, invert="Invert"))
    plane("LeafMask", 31, mixed("leaf mask", "BsdfDiffuse", 1, mask, "Color"))
    plane("LeafMath", 36, mixed("leaf math", "BsdfDiffuse", 0, leaf, invert="Math"))
    plane("LeafShape", 40, mixed("leaf shape", "BsdfPrincipled", 0, leaf, colored=False))
    plane("Unseen", 37, shader("unseen", "ShaderNodeBsdfTransparent")[0])
    plane("UnseenMix", 38, mixed("unseen mix", "BsdfDiffuse", 0, factor=0.0))


def said():
    """A fog box has faces of another material, too; and mixes that are no holes."""
    fog, tree, surface = shader("fog", "ShaderNodeVolumeScatter")
    output = tree.nodes["Material Output"]
    tree.links.new(surface.outputs[0], output.inputs["Volume"])
    for link in list(output.inputs["Surface"].links):
        tree.links.remove(link)
    box = plane("Fog", 33, fog)
    box.data.materials.append(diffuse("wall", (1, 0, 0)))
    for polygon in list(box.data.polygons)[:4]:
        polygon.material_index = 1
    plane("Veil", 34, mixed("veil", "BsdfDiffuse", 0, factor=0.6))
    plane("Velvet", 35, mixed("velvet", "BsdfVelvet", 0, picture("Leaf", 0.0)))
    plane("Pane", 37, shader("pane", "ShaderNodeBsdfGlass")[0])
    ray = mixed("by ray", "BsdfDiffuse", 0)
    ray.node_tree.links.new(ray.node_tree.nodes.new("ShaderNodeLightPath").outputs[0],
                            ray.node_tree.nodes["Mix Shader"].inputs["Fac"])
    plane("ByRay", 36, ray)


def build():
    for cells in (attributes, maps, muted, numbers, leaves):
        cells()
