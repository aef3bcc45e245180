"""One .blend with everything in it that an export knows, for everything_test.py.

    blender -b -noaudio --factory-startup -P tests/blender/make_everything.py -- --output FOLDER

FOLDER gets everything.blend, which moves from frame 1 to 12, and library.blend, from which it links.
"""

import argparse
import math
import sys
import traceback
from pathlib import Path

import bmesh
import bpy
import numpy as np
from mathutils import Euler

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "matrix")]  # Blender does not put a script's own folder there
import make_matrix as kit  # noqa: E402
import matrix_bends  # noqa: E402
import matrix_hair  # noqa: E402
import matrix_shapes  # noqa: E402
import versions  # noqa: E402

LAST = 12
LOW = -1.5  # z of the row below the shapes


def keys(thing, path, values, index=-1):
    for frame, value in values:
        if index < 0:
            setattr(thing, path, value)
        else:
            getattr(thing, path)[index] = value
        thing.keyframe_insert(path, index=index, frame=frame)


def small_ball(name, place, material, radius=0.2):
    def build(shape):
        shape.loops.layers.uv.new("UVMap")
        bmesh.ops.create_uvsphere(shape, u_segments=32, v_segments=16, radius=radius, calc_uvs=True)

    thing = matrix_shapes.add_mesh(name, build, material, True)
    thing.location, thing.rotation_euler = place, Euler()
    return thing


# ---- Materials ------------------------------------------------------------------------------------------------------


def principled_sockets():
    """A ball for each input of the Principled node, which has another value there than the node's own."""
    model = kit.material("principled", (0.6, 0.6, 0.6), 0.4)
    names = [socket.name for socket in model.node_tree.nodes["Principled BSDF"].inputs
             if socket.type in {"VALUE", "RGBA"} and not socket.is_unavailable and socket.name != "Weight"]
    for number, name in enumerate(names):
        paint = kit.material("principled", (0.6, 0.6, 0.6), 0.4)
        paint.name = "With " + name
        socket = paint.node_tree.nodes["Principled BSDF"].inputs[name]
        if socket.type == "RGBA":
            socket.default_value = (0.8, 0.5, 0.3, 1.0)
        else:
            socket.default_value = 1.8 if name == "IOR" else 300.0 if name == "Thin Film Thickness" else 0.6
        if "Emission" in name:
            versions.input_of(paint.node_tree.nodes["Principled BSDF"], "Emission").default_value = (0.2, 0.1, 0.05, 1)
        small_ball(paint.name, (0.45 * (number % 26 - 12.5), -0.4, LOW - 0.95 - 0.45 * (number // 26)), paint)


def textured_balls():
    """Images as colour, metalness, roughness, emission, normal map and bump of Principled; and in pure shaders."""
    height, normals = matrix_bends.relief(64, 2)
    waves, relief = kit.picture("Waves"), matrix_bends.data_image("Height", height)
    bends = matrix_bends.data_image("Normals", normals)
    every = kit.material("principled", (1, 1, 1), 0.4, waves)
    tree = every.node_tree
    shader = tree.nodes["Principled BSDF"]
    parts = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(matrix_bends.texture(tree, relief), parts.inputs[0])
    tree.links.new(parts.outputs[1], shader.inputs["Roughness"])
    tree.links.new(parts.outputs[2], shader.inputs["Metallic"])
    tree.links.new(tree.nodes["Image Texture"].outputs["Color"], versions.input_of(shader, "Emission"))
    shader.inputs["Emission Strength"].default_value = 0.2
    bend = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(matrix_bends.texture(tree, bends), bend.inputs["Color"])
    tree.links.new(bend.outputs["Normal"], shader.inputs["Normal"])
    paints = [every, matrix_bends.add_map(kit.material("diffuse", (0.7, 0.6, 0.5), 0.5, waves), bends, 0.7),
              matrix_bends.add_bump(kit.material("diffuse", (0.5, 0.6, 0.7)), relief),
              matrix_bends.add_bump(kit.material("glossy", (0.9, 0.8, 0.5), 0.3), relief, 0.8, 0.08),
              kit.material("emission", (1.0, 0.8, 0.5), strength=0.5)]
    for number, paint in enumerate(paints):
        small_ball(f"Textured{number}", (-5.4 + 0.7 * (number % 2), -0.3, 3.0 - 0.7 * number), paint, 0.32)
    return waves


# ---- Things ---------------------------------------------------------------------------------------------------------


def instances(paint):
    """Of a collection, on the vertices of a mesh, by geometry nodes, and of a mesh that two share."""
    leaf = bpy.data.collections.new("Leaf")
    part = small_ball("Leaf", (0, 0, 0), paint, 0.16)
    bpy.context.scene.collection.objects.unlink(part)
    leaf.objects.link(part)
    for number in range(2):
        empty = bpy.data.objects.new(f"Group{number}", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", leaf
        empty.location, empty.scale = (4.9, -0.3, 3.0 - 0.6 * number), (1.0, 1.0, 1.0 + 0.4 * number)
        bpy.context.scene.collection.objects.link(empty)
    grid = matrix_shapes.add_mesh("Scatter", lambda shape: bmesh.ops.create_grid(shape, x_segments=1, y_segments=1,
                                                                                 size=0.4), paint, False)
    grid.location, grid.rotation_euler = (5.1, -0.3, 1.2), Euler((math.pi / 2, 0, 0))
    seed = small_ball("Seed", (0, 0, 0), paint, 0.14)
    seed.parent, grid.instance_type = grid, "VERTS"
    grid.show_instancer_for_render = False
    holder = matrix_shapes.add_mesh("Nodes", lambda shape: bmesh.ops.create_grid(shape, x_segments=1, y_segments=1,
                                                                                 size=0.4), paint, False)
    holder.location, holder.rotation_euler = (5.1, -0.3, 0.0), Euler((math.pi / 2, 0, 0))
    tree = versions.geometry_nodes("Nodes")
    inputs, outputs = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    spread, cone = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeMeshCone")
    cone.inputs["Radius Bottom"].default_value, cone.inputs["Depth"].default_value = 0.16, 0.3
    tree.links.new(inputs.outputs[0], spread.inputs["Points"])
    tree.links.new(cone.outputs["Mesh"], spread.inputs["Instance"])
    tree.links.new(spread.outputs[0], outputs.inputs[0])
    holder.modifiers.new("Nodes", "NODES").node_group = tree


def library(folder):
    """A file with an object that is linked as it is, and a collection that is linked and overridden."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    paint = kit.material("principled", (0.2, 0.6, 0.3), 0.5)
    small_ball("Linked", (3.6, -0.3, LOW), paint, 0.3)
    group = bpy.data.collections.new("Prop")
    bpy.context.scene.collection.children.link(group)
    prop = small_ball("Overridden", (0, 0, 0), paint, 0.3)
    bpy.context.scene.collection.objects.unlink(prop)
    group.objects.link(prop)
    path = folder / "library.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def linked(path, paint):
    with bpy.data.libraries.load(str(path), link=True, relative=False) as (_, wanted):
        wanted.objects, wanted.collections = ["Linked"], ["Prop"]
    scene = bpy.context.scene
    scene.collection.objects.link(wanted.objects[0])
    own = wanted.collections[0].override_hierarchy_create(scene, bpy.context.view_layer)
    thing = own.objects[0]
    thing.location, thing.scale = (4.5, -0.3, LOW), (1.0, 1.0, 1.3)
    slot = thing.material_slots[0]
    slot.link = "OBJECT"
    slot.material = paint


def moving(paint):
    """Bones, a shape key, an object, a colour of a node, a lamp's energy and whether something is seen."""
    bones = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
    bpy.context.scene.collection.objects.link(bones)
    bpy.context.view_layer.objects.active = bones
    bpy.ops.object.mode_set(mode="EDIT")
    for number in range(2):
        bone = bones.data.edit_bones.new(f"Bone{number}")
        bone.head, bone.tail = (0, 0, 0.5 * number), (0, 0, 0.5 * number + 0.5)
        bone.parent = bones.data.edit_bones[0] if number else None
    bpy.ops.object.mode_set(mode="OBJECT")
    bones.location = (-4.6, -0.4, LOW - 0.5)
    upper = bones.pose.bones["Bone1"]
    upper.rotation_mode = "XYZ"
    keys(upper, "rotation_euler", ((1, (0.0, 0.0, 0.0)), (LAST, (0.0, 0.9, 0.3))))
    rise = np.linspace(0, 1, 13)[:, None]
    turn = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    points = 0.2 * np.stack([np.cos(turn) + 0 * rise, np.sin(turn) + 0 * rise, 5 * rise + 0 * turn], -1)
    arm = kit.grid("Arm", points, paint, wrap_columns=True)
    arm.parent = bones
    arm.modifiers.new("Armature", "ARMATURE").object = bones
    for number in range(2):
        group = arm.vertex_groups.new(name=f"Bone{number}")
        for vertex in arm.data.vertices:
            upper_share = min(max(2.0 * vertex.co.z - 0.5, 0.0), 1.0)
            group.add([vertex.index], upper_share if number else 1.0 - upper_share, "REPLACE")
    shaped = small_ball("Shaped", (-3.6, -0.3, LOW), paint, 0.35)
    shaped.shape_key_add(name="Basis")
    key = shaped.shape_key_add(name="Tall")
    for point in key.data:
        point.co.z *= 1.6
    keys(key, "value", ((1, 0.0), (LAST, 1.0)))
    mover = small_ball("Mover", (0, 0, 0), kit.material("diffuse", (0.2, 0.3, 0.8)), 0.25)
    keys(mover, "location", ((1, (2.6, -0.6, LOW + 0.4)), (LAST, (2.9, -0.6, LOW - 0.2))))
    color = mover.data.materials[0].node_tree.nodes["Diffuse BSDF"].inputs["Color"]
    keys(color, "default_value", ((1, (0.2, 0.3, 0.8, 1.0)), (LAST, (0.8, 0.3, 0.2, 1.0))))
    comes = small_ball("Comes", (-2.7, -0.3, LOW), paint, 0.25)
    keys(comes, "hide_render", ((1, True), (LAST, False)))
    driven = small_ball("Driven", (2.2, -0.5, LOW), paint, 0.2)
    driven.driver_add("location", 2).driver.expression = f"{LOW} - 0.02 * frame"


def lamps():
    """All kinds in view of everything, none without soft falloff; the sun's energy is a key's."""
    for number, (kind, energy, settings) in enumerate((
            ("POINT", 300, {}), ("POINT", 300, {"shadow_soft_size": 0.3}),
            ("SPOT", 700, {"spot_size": math.radians(80), "spot_blend": 0.5}),
            ("SPOT", 700, {"spot_size": math.radians(60), "spot_blend": 0.2, "shadow_soft_size": 0.2}),
            ("AREA", 200, {"shape": "SQUARE", "size": 1.0}),
            ("AREA", 200, {"shape": "RECTANGLE", "size": 1.5, "size_y": 0.5}),
            ("AREA", 200, {"shape": "DISK", "size": 1.0}),
            ("AREA", 200, {"shape": "ELLIPSE", "size": 1.5, "size_y": 0.5}))):
        kit.lamp(kind, energy, (1.5 * (number - 3.5), -5.0, 5.0), (0.5 * (number - 3.5), 0, 1), **settings)
    sun = kit.lamp("SUN", 1.0, (-3, -4, 5), angle=math.radians(5))
    keys(sun.data, "energy", ((1, 1.0), (LAST, 1.5)))
    kit.world((0.6, 0.75, 1.0), 0.2)


def build(path):
    grey = kit.material("diffuse", (0.6, 0.6, 0.6))
    matrix_shapes.build(grey)
    waves = textured_balls()
    before = set(bpy.data.objects)
    matrix_hair.build([kit.material("diffuse", (0.6, 0.6, 0.6)), kit.material("diffuse", (0.7, 0.5, 0.2)),
                       kit.material("diffuse", (1, 1, 1), 0.5, waves)], "THICK")
    for thing in set(bpy.data.objects) - before:
        thing.location.z += LOW - 0.4
        thing.location.x *= 1.2
    principled_sockets()
    instances(kit.material("diffuse", (0.3, 0.7, 0.35)))
    linked(path, kit.material("diffuse", (0.7, 0.2, 0.5)))
    moving(kit.material("principled", (0.7, 0.5, 0.3), 0.5))
    kit.quad("Wall", (-7, 1.5, -4), (14, 0, 0), (0, 0, 9), kit.material("diffuse", (0.7, 0.7, 0.75), 0.3))
    lamps()
    camera = bpy.data.objects["Camera"]
    camera.data.ortho_scale, camera.location.z = 12.4, 0.55
    keys(camera, "rotation_euler", ((1, (1.6, 0.0, 0.0)), (LAST, (1.6, 0.0, 0.05))))


def main():
    parser = argparse.ArgumentParser(prog="make_everything.py")
    parser.add_argument("--output", required=True, type=Path)
    folder = parser.parse_args(sys.argv[sys.argv.index("--") + 1:]).output.resolve()
    path = library(folder)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    build(path)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.frame_start, scene.frame_end = 1, LAST
    scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "everything.blend"), compress=True)
    bpy.ops.file.make_paths_relative()
    bpy.ops.wm.save_mainfile()


try:
    main()
except Exception:
    traceback.print_exc()
    sys.exit(1)
