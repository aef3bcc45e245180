"""Makes an animated scene, exports it by Blender's own glTF exporter, and writes where Blender has each vertex.

    blender -b -noaudio --factory-startup -P tests/blender/make_animation.py -- --output FOLDER

FOLDER gets animated.glb and expected.json. Positions are glTF's: metres, +Y up. A vertex is identified by its rest
position.
"""

import argparse
import json
import math
import sys
import traceback
from pathlib import Path

import bmesh
import bpy
from mathutils import Matrix, Vector

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import versions  # noqa: E402  (Blender does not put a script's own folder on the path)

FPS = 25
FRAMES = [1, 7, 12, 20]
GLTF_FROM_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))


def link(thing):
    bpy.context.scene.collection.objects.link(thing)
    return thing


def tube(name):
    """4 m high along z, no two vertices at one place."""
    data = bpy.data.meshes.new(name)
    shape = bmesh.new()
    rings = [[shape.verts.new((math.cos(a), 0.7 * math.sin(a), 0.4 * z)) for a in (i * math.pi / 4 for i in range(8))]
             for z in range(11)]
    for low, high in zip(rings, rings[1:]):
        for i in range(8):
            shape.faces.new((low[i], low[(i + 1) % 8], high[(i + 1) % 8], high[i]))
    shape.to_mesh(data)
    shape.free()
    for polygon in data.polygons:
        polygon.use_smooth = True
    return link(bpy.data.objects.new(name, data))


def skinned_tube():
    """Three bones; the weights overlap, and the armature stands away from the origin, turned and scaled."""
    armature = link(bpy.data.objects.new("Armature", bpy.data.armatures.new("Armature")))
    armature.location = (3, -2, 0.5)
    armature.rotation_euler = (0.2, -0.1, 0.7)
    armature.scale = (1.1, 1.1, 1.1)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    last = None
    for i in range(3):
        bone = armature.data.edit_bones.new(f"Bone{i}")
        bone.head, bone.tail = (0, 0, 4 * i / 3), (0, 0, 4 * (i + 1) / 3)
        bone.parent, bone.use_connect = last, last is not None
        last = bone
    bpy.ops.object.mode_set(mode="POSE")
    for i, bone in enumerate(armature.pose.bones):
        bone.rotation_mode = "XYZ" if i == 1 else "QUATERNION"
        for frame, turn in ((1, 0.0), (12, 0.5 + 0.2 * i), (20, -0.3)):
            if i == 1:
                bone.rotation_euler = (turn, 0.5 * turn, 0)
                bone.keyframe_insert("rotation_euler", frame=frame)
            else:
                bone.rotation_quaternion = (math.cos(turn), math.sin(turn), 0, 0)
                bone.keyframe_insert("rotation_quaternion", frame=frame)
    bone = armature.pose.bones["Bone0"]
    for frame, height in ((1, 0.0), (20, 1.5)):
        bone.location = (0, height, 0)
        bone.keyframe_insert("location", frame=frame)
    bpy.ops.object.mode_set(mode="OBJECT")
    skin = tube("Tube")
    skin.parent = armature
    skin.modifiers.new("Armature", "ARMATURE").object = armature
    for i in range(3):
        group = skin.vertex_groups.new(name=f"Bone{i}")
        for vertex in skin.data.vertices:
            weight = max(0.0, 1.0 - abs(vertex.co.z - (4 * i + 2) / 3) / 2.0)
            if weight > 0:
                group.add([vertex.index], weight, "REPLACE")
    return skin


def face():
    """Two shape keys."""
    thing = tube("Face")
    thing.location = (-4, 0, 0)
    thing.shape_key_add(name="Basis")
    for name, scale, values in (("Wide", (2, 1, 1), ((1, 0.0), (12, 1.0))),
                                ("Bent", (1, 1.3, 0.5), ((1, 0.2), (20, 0.9)))):
        key = thing.shape_key_add(name=name)
        for vertex, point in zip(thing.data.vertices, key.data):
            point.co = Vector(vertex.co[i] * scale[i] for i in range(3)) + Vector((0, 0.1 * vertex.co.z ** 2, 0))
        for frame, value in values:
            key.value = value
            key.keyframe_insert("value", frame=frame)
    return thing


def movers():
    parent = link(bpy.data.objects.new("Parent", None))
    child = tube("Child")
    child.parent = parent
    child.location = (0, 5, 0)
    for frame, turn in ((1, 0.0), (12, 1.0), (20, 2.5)):
        parent.rotation_euler = (0.3 * turn, 0, turn)
        parent.scale = (1 + turn, 1, 1)
        parent.keyframe_insert("rotation_euler", frame=frame)
        parent.keyframe_insert("scale", frame=frame)
    camera = link(bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye")))
    for frame, x in ((1, 0), (20, 6)):
        camera.location = (x, -20, 3)
        camera.rotation_euler = (1.4, 0.05 * x, 0.1 * x)
        camera.keyframe_insert("location", frame=frame)
        camera.keyframe_insert("rotation_euler", frame=frame)
    return child, camera


def point(vector):
    return list((GLTF_FROM_BLENDER @ vector.to_4d()).xyz)


def evaluated(thing):
    """[[rest position in the file, world position], …]; the exporter puts a skinned mesh's rest pose into the world."""
    file_from_rest = thing.matrix_world if thing.find_armature() else Matrix()
    shown = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = shown.to_mesh()
    pairs = [[point(file_from_rest @ rest.co), point(shown.matrix_world @ vertex.co)]
             for rest, vertex in zip(thing.data.vertices, mesh.vertices)]
    shown.to_mesh_clear()
    return pairs


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--output", type=Path, required=True)
    folder = parser.parse_args(sys.argv[sys.argv.index("--") + 1:]).output
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = FPS
    scene.frame_start, scene.frame_end = 1, 20
    things = [skinned_tube(), face()]
    child, camera = movers()
    things.append(child)
    scene.camera = camera
    expected = {"fps": FPS, "frames": {}}
    for frame in FRAMES:
        scene.frame_set(frame)
        camera_matrix = GLTF_FROM_BLENDER @ camera.matrix_world
        expected["frames"][str(frame)] = {
            "objects": {thing.name: evaluated(thing) for thing in things},
            "camera": [list(column) for column in camera_matrix.transposed()],
        }
    scene.frame_set(1)
    bpy.ops.export_scene.gltf(filepath=str(folder / "animated.glb"), export_format="GLB", export_cameras=True,
                              export_animations=True, export_morph=True, export_skins=True, **versions.ONE_ANIMATION)
    (folder / "expected.json").write_text(json.dumps(expected))


try:
    main()
except Exception:
    traceback.print_exc()
    sys.exit(1)
