"""The camera of a Cycles render, chosen and written down: part of render_guides.py."""

import bpy
from mathutils import Matrix, Vector

import blend_common
from blend_common import GLTF_FROM_BLENDER


def choose(scene, name, unsupported):
    """Makes the camera of that name the scene's; without a name the active one, or where there is none, the first that
    export_scene.py writes."""
    usable = blend_common.cameras_of(scene, unsupported)
    names = blend_common.camera_names(usable)
    cameras = {names[thing]: thing for thing in usable
               if blend_common.has_direction(names[thing], thing.matrix_world, unsupported)}
    if name and name not in cameras:
        raise LookupError(f"there is no camera '{name}'; there are: " + (", ".join(cameras) or "none"))
    if not cameras:
        raise LookupError("the scene has no perspective or orthographic camera: add one")
    if not name and scene.camera is not None and scene.camera not in cameras.values():
        raise LookupError(f"the active camera '{scene.camera.name}' {blend_common.why_lost(scene.camera)}: "
                          f"give --camera NAME of {', '.join(cameras)}")
    scene.camera = cameras[name] if name else next(iter(cameras.values()))
    for marker in scene.timeline_markers:
        marker.camera = None  # the render would take the camera of the frame's marker again
    bpy.context.view_layer.update()
    blend_common.note_crooked_camera(scene.camera.name, scene.camera.matrix_world, unsupported)


def rigid(matrix):
    """Rotation and translation only, as guidegen straightens cameras and lamps: backward stays, up as far as it can."""
    backward = matrix.col[2].to_3d().normalized()
    right = matrix.col[1].to_3d().cross(backward).normalized()
    up = backward.cross(right)
    columns = [Vector((*axis, 0.0)) for axis in (right, up, backward)] + [Vector((*matrix.col[3].to_3d(), 1.0))]
    return Matrix(columns).transposed()


def matrix_text(matrix):
    """Column by column, every digit."""
    return " ".join(repr(matrix[row][column]) for column in range(4) for row in range(4))


def write(scene, path):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = scene.camera.evaluated_get(depsgraph)
    world_from_view = GLTF_FROM_BLENDER @ rigid(camera.matrix_world)
    projection = camera.calc_matrix_camera(depsgraph, x=scene.render.resolution_x, y=scene.render.resolution_y)
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"camera {scene.camera.name}\n")
        file.write(f"viewFromWorld {matrix_text(world_from_view.inverted())}\n")
        file.write(f"clipFromView {matrix_text(projection)}\n")
