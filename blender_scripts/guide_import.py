"""A glTF scene in Blender, with guidegen's lights and cameras: part of render_guides.py.

Blender's importer brings meshes, materials and punctual lights (cd · 4π / 683 watts, lux / 683). This completes it: the
`extras.scumble` of export_scene.py, the cones of KHR_lights_punctual, the cameras' own picture proportions, matrices
with shear, alpha cut-offs and back faces that cameras do not see.
"""

import math
import sys

import bpy
from mathutils import Matrix, Quaternion, Vector

import guide_camera
from blend_common import GLTF_FROM_BLENDER
from guide_import_lamps import complete_world, replace_lamp, use_punctual
from guide_import_materials import complete_material, ours


class Import:
    """The importer's data at the time when the nodes were made."""
    gltf = None

    def gather_import_scene_after_nodes_hook(self, *arguments):
        Import.gltf = arguments[-1]


def load(path, size, unsupported):
    """`size` is the picture's, in pixels."""
    import numpy
    if not hasattr(numpy, "bool"):
        numpy.bool = bool  # Debian's numpy has dropped an alias that the importer of 3.4 still uses
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon = sys.modules["io_scene_gltf2"]
    addon.glTF2ImportUserExtension = Import
    try:
        bpy.ops.import_scene.gltf(filepath=path, import_shading="NORMALS", merge_vertices=False)
    finally:
        del addon.glTF2ImportUserExtension
    gltf = Import.gltf
    if gltf is None:
        raise ValueError("Blender imported nothing")
    for image in bpy.data.images:
        image.alpha_mode = "CHANNEL_PACKED"  # glTF's alpha does not darken the colours beside it
    for thing in bpy.data.objects:
        thing.animation_data_clear()  # guidegen sees nodes as they stand
    worlds = world_matrices(gltf.data)
    cameras = []
    for index, world in worlds.items():
        complete_node(gltf, index, world, size[0] / size[1], cameras, unsupported)
    scene = bpy.context.scene
    scene.camera = cameras[0] if cameras else None
    complete_world(gltf, scene)
    for material in gltf.data.materials or []:
        complete_material(material, unsupported)


# ---- Nodes ----------------------------------------------------------------------------------------------------------


def local_matrix(node):
    if node.matrix:
        return Matrix([node.matrix[row::4] for row in range(4)])
    x, y, z, w = node.rotation or (0.0, 0.0, 0.0, 1.0)
    return Matrix.LocRotScale(Vector(node.translation or (0.0, 0.0, 0.0)), Quaternion((w, x, y, z)).normalized(),
                              Vector(node.scale or (1.0, 1.0, 1.0)))


def world_matrices(document):
    """glTF's world matrix by node, depth first, in the file's order."""
    chosen = document.scenes[document.scene or 0].nodes if document.scenes else None
    if chosen is None:
        children = {child for node in document.nodes or [] for child in node.children or []}
        chosen = [index for index in range(len(document.nodes or [])) if index not in children]
    worlds = {}
    pending = [(index, Matrix()) for index in reversed(chosen)]
    while pending:
        index, parent = pending.pop()
        node = document.nodes[index]
        worlds[index] = parent @ local_matrix(node)
        pending += [(child, worlds[index]) for child in reversed(node.children or [])]
    return worlds


def objects_of(gltf, index):
    """The Blender objects of a node by type; a node with two roles has a child for the second."""
    found = {}
    second = [vnode for vnode in gltf.vnodes.values() if index in (vnode.camera_node_idx, vnode.light_node_idx)]
    for vnode in [gltf.vnodes.get(index)] + second:
        thing = getattr(vnode, "blender_object", None)
        if thing is not None:
            found.setdefault(thing.type, thing)
    return found


def complete_node(gltf, index, world, aspect, cameras, unsupported):
    node = gltf.data.nodes[index]
    things = objects_of(gltf, index)
    extras = ours(node.extras)
    place = GLTF_FROM_BLENDER.transposed() @ world
    bpy.context.view_layer.update()
    if "MESH" in things:
        place_mesh(things["MESH"], place @ GLTF_FROM_BLENDER, unsupported)
    if "CAMERA" in things:
        put(things["CAMERA"], guide_camera.rigid(place))
        fit_camera(things["CAMERA"].data, gltf.data.cameras[node.camera], aspect, extras.get("camera"))
        cameras.append(things["CAMERA"])
    lamp = things.get("LIGHT")
    if "lamp" in extras:
        lamp = replace_lamp(lamp, node.name or "Lamp", extras["lamp"], guide_camera.rigid(place).col[2].to_3d())
    elif lamp is not None:
        light = gltf.data.extensions["KHR_lights_punctual"]["lights"][node.extensions["KHR_lights_punctual"]["light"]]
        lamp.data = lamp.data.copy()
        use_punctual(lamp.data, light, guide_camera.rigid(place).col[2].to_3d())
    if lamp is not None:
        put(lamp, guide_camera.rigid(place))


def put(thing, matrix):
    """Stays where the importer has put it if that is right: taking the matrix apart anew costs digits."""
    if difference(matrix, thing.matrix_world) > 1e-5:
        thing.parent = None
        thing.matrix_world = matrix


def difference(expected, matrix):
    """The largest of all entries, as a share of the largest expected one."""
    size = max(abs(value) for row in expected for value in row)
    return max(abs(a - b) for ours_, theirs in zip(expected, matrix) for a, b in zip(ours_, theirs)) / size


def place_mesh(thing, expected, unsupported):
    """The importer takes matrices apart into place, turn and scale, which loses shear: a parent brings it back."""
    if difference(expected, thing.matrix_world) <= 1e-5:
        return
    if any(modifier.type == "ARMATURE" for modifier in thing.modifiers):
        unsupported.add(f"object '{thing.name}': is moved by a skeleton, and the importer places it in its own way")
        return
    anchor = bpy.data.objects.new("scumble.shear", None)
    bpy.context.scene.collection.objects.link(anchor)
    thing.parent = anchor
    thing.matrix_parent_inverse = expected
    thing.matrix_basis = Matrix()


# ---- Cameras --------------------------------------------------------------------------------------------------------


def fit_camera(camera, lens, aspect, extras):
    """Sensor fit, angle and shift as guidegen reads them: the vertical extent is kept, unless the file's proportions
    are wider than the picture's, which the importer ignores."""
    camera.shift_x = camera.shift_y = 0.0
    if extras:
        camera.sensor_fit = extras["sensor_fit"]
        camera.shift_x, camera.shift_y = extras["shift_x"], extras["shift_y"]
        extent, side = (extras["ortho_scale"] if camera.type == "ORTHO" else extras["angle"]), None
    elif camera.type == "ORTHO":
        side = abs(lens.orthographic.xmag) / abs(lens.orthographic.ymag)
        extent = 2.0 * abs(lens.orthographic.ymag)
        if side > aspect:
            extent *= side
    else:
        side = lens.perspective.aspect_ratio
        extent = lens.perspective.yfov
        if side and side > aspect:
            extent = 2.0 * math.atan(math.tan(extent / 2.0) * side)
    if not extras:
        camera.sensor_fit = "HORIZONTAL" if side and side > aspect else "VERTICAL"
    if camera.type == "ORTHO":
        camera.ortho_scale = extent
        return
    # `angle` belongs to the sensor's longer side; the fitted side must be the one that it measures.
    camera.lens_unit = "FOV"
    camera.sensor_width = camera.sensor_height = 36.0
    camera.angle = extent
