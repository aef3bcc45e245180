"""Renders a small scene like a user who wants guides from it: passes switched on, all other settings unchanged.

    blender -b -noaudio --factory-startup -P tests/blender/render_plain.py -- --output FOLDER --shot NAME …

Writes FOLDER/NAME.exr, multilayer, and FOLDER/NAME.camera with the camera that Blender had. A shot's name lists its
special settings: one of the cameras (landscape, portrait, shifted, ortho, far), the film (opaque, clear), the filter
(filtered, sharp), lens, dof, slightdof or nopos, and lit (a hard sun, and the passes of its light), catcher (lit, and
the floor is a shadow catcher) or painted (everything has one colour and one point of a texture):
"shifted-opaque-filtered".
"""

import argparse
import sys
import traceback
from pathlib import Path

import bpy
from mathutils import Euler, Matrix

GLTF_FROM_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))


def build(words):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    offset = 2000.0 if "far" in words else 0.0
    material = bpy.data.materials.new('Red "paint"')
    material.diffuse_color = (0.4, 0.2, 0.1, 1.0)
    for name, place, add in (
            ("Floor", (0, 0, -0.1), lambda: bpy.ops.mesh.primitive_cube_add(scale=(4, 3, 0.1))),
            ("Ball", (0.4, 0.2, 1), lambda: bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)),
            ('The "ring"', (-1.6, -0.3, 0.6), lambda: bpy.ops.mesh.primitive_torus_add(major_radius=0.9))):
        add()
        thing = bpy.context.object
        thing.name, thing.location = name, (place[0] + offset, place[1] - offset, place[2])
        thing.data.materials.append(material)
        for polygon in thing.data.polygons:
            polygon.use_smooth = name != "Floor"
        for corner in thing.data.uv_layers.active.data if "painted" in words else ():
            corner.uv = (0.3, 0.7)
    data = bpy.data.cameras.new("Eye")
    eye = bpy.data.objects.new("Eye", data)
    scene.collection.objects.link(eye)
    eye.location, eye.rotation_euler = (4.5 + offset, -7 - offset, 4.2), Euler((1.1, 0.07, 0.57))
    data.lens = 40
    if "shifted" in words:
        data.shift_x, data.shift_y = 0.12, -0.08
    if "ortho" in words:
        data.type, data.ortho_scale = "ORTHO", 8
    if "lens" in words:
        data.type = "PANO"
        getattr(data, "cycles", data).panorama_type = "FISHEYE_EQUISOLID"  # Blender 4.3 has it in the camera itself
    if "dof" in words or "slightdof" in words:
        data.dof.use_dof = True
        data.dof.focus_distance, data.dof.aperture_fstop = (4.0, 0.1) if "dof" in words else (8.0, 0.2)
    scene.camera = eye
    if "lit" in words or "catcher" in words:
        sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        scene.collection.objects.link(sun)
        sun.data.energy, sun.data.angle, sun.data.color = 2.0, 0.0, (1.0, 0.5, 0.25)
        sun.rotation_euler = Euler((0.6, 0.3, 0.0))
        bpy.data.objects["Floor"].is_shadow_catcher = "catcher" in words
    return scene


def set_up(scene, words, path):
    render = scene.render
    render.engine = "CYCLES"
    width, height = (120, 200) if "portrait" in words else (240, 135)
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.film_transparent = "clear" in words
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    render.filepath = path
    scene.cycles.samples, scene.cycles.use_denoising = 8, False
    if "sharp" in words:
        scene.cycles.filter_width = 0.01
    layer = scene.view_layers[0]
    layer.use_pass_normal = layer.use_pass_z = layer.use_pass_cryptomatte_object = True
    layer.use_pass_position = "nopos" not in words
    layer.use_pass_diffuse_direct = layer.use_pass_shadow = "lit" in words
    layer.use_pass_diffuse_color = layer.use_pass_uv = "painted" in words
    layer.cycles.use_pass_shadow_catcher = "catcher" in words
    layer.use_pass_cryptomatte_material = layer.use_pass_object_index = "sharp" in words


def write_camera(scene, path):
    graph = bpy.context.evaluated_depsgraph_get()
    camera = scene.camera.evaluated_get(graph)
    view = (GLTF_FROM_BLENDER @ camera.matrix_world).inverted()
    clip = camera.calc_matrix_camera(graph, x=scene.render.resolution_x, y=scene.render.resolution_y)
    text = [" ".join(repr(m[row][column]) for column in range(4) for row in range(4)) for m in (view, clip)]
    path.write_text("camera Eye\nviewFromWorld %s\nclipFromView %s\n" % tuple(text))


def main():
    parser = argparse.ArgumentParser(prog="render_plain.py", description="Renders as one would by hand.")
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--shot", required=True, nargs="+")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    for shot in arguments.shot:
        scene = build(shot.split("-"))
        set_up(scene, shot.split("-"), str(arguments.output / (shot + ".exr")))
        bpy.ops.render.render(write_still=True)
        if "lens" not in shot:
            write_camera(scene, arguments.output / (shot + ".camera"))


if __name__ == "__main__":
    try:
        main()
    except Exception:
        traceback.print_exc()
        sys.exit(1)
