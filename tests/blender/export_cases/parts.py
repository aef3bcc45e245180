"""What the scenes are made of: empty files, boxes and materials."""

import bmesh
import bpy

import versions


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.engine = "CYCLES"


def link(thing, collection=None):
    (collection or bpy.context.scene.collection).objects.link(thing)
    return thing


def save(folder, name):
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / (name + ".blend")), check_existing=False)


def cube(name, location=(0, 0, 0), material=None, collection=None, data=None):
    if data is None:
        data = bpy.data.meshes.new(name)
        shape = bmesh.new()
        shape.loops.layers.uv.new("UVMap")
        bmesh.ops.create_cube(shape, size=1.0, calc_uvs=True)
        shape.to_mesh(data)
        shape.free()
        if material:
            data.materials.append(material)
    thing = link(bpy.data.objects.new(name, data), collection)
    thing.location = location
    return thing


def new_material(name, node_type, **inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    node = tree.nodes.new(node_type)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for key, value in inputs.items():
        versions.input_of(node, key.replace("_", " ")).default_value = value
    return material, node


def textured(name, node_type, image, socket="Color", mapping=False):
    material, node = new_material(name, node_type)
    tree = material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.interpolation = "Closest"
    tree.links.new(texture.outputs["Color"], node.inputs[socket])
    if mapping:
        place, source = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
        place.inputs["Scale"].default_value = (2, 2, 1)
        tree.links.new(source.outputs["UV"], place.inputs["Vector"])
        tree.links.new(place.outputs["Vector"], texture.inputs["Vector"])
    return material


def checker():
    """Left half red, right half green, its upper half dark."""
    image = bpy.data.images.new("Checker", 4, 4)
    rows = []
    for y in range(4):
        for x in range(4):
            light = 1.0 if y < 2 else 0.5
            rows += [light if x < 2 else 0.0, 0.0 if x < 2 else light, 0.0, 1.0]
    image.pixels = rows
    image.pack()
    return image
