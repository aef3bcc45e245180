"""Makes the .blend of crosscheck_blender_test.cpp: a diffuse room, a glossy ball, a lamp with extent, and a box that moves.

    blender -b -noaudio --factory-startup -P tests/blender/make_crosscheck.py -- OUTPUT.blend
"""

import sys

import bmesh
import bpy
from mathutils import Euler


def material(name, kind, color, roughness=0.0):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new(kind)
    shader.inputs["Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    if kind == "ShaderNodeBsdfGlossy":
        shader.distribution = "GGX"
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def mesh(name, build, location, made, smooth=False):
    data = bpy.data.meshes.new(name)
    shape = bmesh.new()
    build(shape)
    for face in shape.faces:
        face.smooth = smooth
    shape.to_mesh(data)
    shape.free()
    data.materials.append(made)
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    return thing


def main():
    output = sys.argv[sys.argv.index("--") + 1]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    floor = material("Floor", "ShaderNodeBsdfDiffuse", (0.7, 0.6, 0.5))
    red = material("Red", "ShaderNodeBsdfDiffuse", (0.8, 0.2, 0.1))
    metal = material("Metal", "ShaderNodeBsdfGlossy", (0.9, 0.8, 0.6), 0.5)
    mesh("Floor", lambda b: bmesh.ops.create_grid(b, x_segments=1, y_segments=1, size=3.0), (0, 0, 0), floor)
    mesh("Ball", lambda b: bmesh.ops.create_uvsphere(b, u_segments=96, v_segments=48, radius=0.7), (-0.8, 0, 0.7), metal, True)
    box = mesh("Box", lambda b: bmesh.ops.create_cube(b, size=1.0), (0.8, 0.2, 0.5), red)
    for frame, x in ((1, 0.8), (5, 1.4)):
        box.location.x = x
        box.keyframe_insert("location", frame=frame)
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy, lamp.shadow_soft_size = 300.0, 0.3
    thing = bpy.data.objects.new("Lamp", lamp)
    thing.location = (1.5, -2.0, 3.0)
    scene.collection.objects.link(thing)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0.0, -5.0, 2.4)
    camera.rotation_euler = Euler((1.2, 0.0, 0.0))
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=output)


main()
