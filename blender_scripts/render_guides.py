"""Renders the data passes of a scene with Cycles: the cross-check of our guides.

    blender -b -noaudio --factory-startup -P render_guides.py -- SCENE OUTPUT.exr --size WIDTHxHEIGHT [--camera NAME]

SCENE is a .blend, a .glb or a .gltf. Beside OUTPUT.exr, a multilayer EXR with Normal, Depth, Position, DiffCol and IndexOB, stands
OUTPUT.camera: text that says how the picture was seen and which object each index is, for `scumble transfer --camera` and
`scumble crosscheck`. One sample at the pixel's centre (Blackman-Harris, the narrowest width), no light: data is exact,
and never averaged across an edge.
"""

import argparse
import os
import sys

import bpy
from mathutils import Matrix

# Blender's axes (+Z up) to glTF's (+Y up): x, z, -y.
GLTF_FROM_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))


def fail(message):
    print("scumble: error: " + message, file=sys.stderr)
    sys.exit(1)


def parse_arguments():
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="render_guides.py", description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("output")
    parser.add_argument("--size", required=True, metavar="WIDTHxHEIGHT")
    parser.add_argument("--camera", default="")
    return parser.parse_args(arguments)


def open_scene(path):
    if path.endswith(".blend"):
        bpy.ops.wm.open_mainfile(filepath=path)
        return
    # Debian's numpy has dropped an alias that the importer of 3.4 still uses.
    import numpy
    if not hasattr(numpy, "bool"):
        numpy.bool = bool
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)


def choose_camera(scene, name):
    cameras = sorted(o.name for o in scene.objects if o.type == "CAMERA")
    if name:
        if name not in cameras:
            fail("there is no camera %s; there are %s" % (name, ", ".join(cameras) or "none"))
        scene.camera = scene.objects[name]
    elif scene.camera is None:
        if not cameras:
            fail("the scene has no camera")
        scene.camera = scene.objects[cameras[0]]


def set_up_render(scene, size, output):
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = size[0], size[1], 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1
    render.film_transparent = True
    render.use_border = False
    render.use_compositing = render.use_sequencer = False
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "ZIP"
    render.filepath = output
    render.use_file_extension = False
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    cycles.max_bounces = 0
    layer = scene.view_layers[0]
    for other in list(scene.view_layers)[1:]:
        other.use = False
    layer.use_pass_normal = layer.use_pass_z = layer.use_pass_position = layer.use_pass_object_index = True
    layer.use_pass_diffuse_color = True


def number_objects(scene):
    """Gives every object an index of its own; returns the names by index."""
    names = {}
    for index, obj in enumerate(sorted(scene.objects, key=lambda o: o.name), start=1):
        obj.pass_index = index
        if obj.type == "MESH":
            names[index] = obj.name
    return names


def matrix_text(matrix):
    """Column by column, every digit."""
    return " ".join(repr(matrix[row][column]) for column in range(4) for row in range(4))


def write_camera(scene, path, names):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = scene.camera.evaluated_get(depsgraph)
    rigid = Matrix.LocRotScale(*camera.matrix_world.decompose()[:2], None)
    world_from_view = GLTF_FROM_BLENDER @ rigid
    projection = camera.calc_matrix_camera(depsgraph, x=scene.render.resolution_x, y=scene.render.resolution_y)
    with open(path, "w", encoding="utf-8") as file:
        file.write("camera %s\n" % scene.camera.name)
        file.write("viewFromWorld %s\n" % matrix_text(world_from_view.inverted()))
        file.write("clipFromView %s\n" % matrix_text(projection))
        for index, name in sorted(names.items()):
            file.write("object %d %s\n" % (index, name))


def main():
    options = parse_arguments()
    try:
        size = [int(side) for side in options.size.split("x")]
    except ValueError:
        fail("--size %s: expected WIDTHxHEIGHT" % options.size)
    open_scene(options.scene)
    scene = bpy.context.scene
    choose_camera(scene, options.camera)
    set_up_render(scene, size, os.path.abspath(options.output))
    names = number_objects(scene)
    write_camera(scene, os.path.splitext(options.output)[0] + ".camera", names)
    bpy.ops.render.render(write_still=True)
    if not os.path.exists(options.output):
        fail("Blender wrote no %s" % options.output)


main()
