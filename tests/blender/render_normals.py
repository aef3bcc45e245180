"""Has Cycles render the data passes of a scene through each of its cameras: CAMERA-WIDTHxHEIGHT.exr, multilayer. In a
file of several scenes it does so with each: SCENE-CAMERA-WIDTHxHEIGHT.exr.

    blender -b -noaudio --factory-startup scene.blend -P tests/blender/render_normals.py -- --output FOLDER
                                                                               --view CAMERA:WIDTHxHEIGHT …

One sample in the middle of each pixel, and a filter too narrow to mix neighbours.
"""

import argparse
import sys
import traceback
from pathlib import Path

import bpy


def prepare(scene):
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.filter_width = 0.01
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0
    scene.render.film_transparent = True
    scene.render.use_compositing = scene.render.use_sequencer = False
    scene.render.resolution_percentage = 100
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    layer = scene.view_layers[0]
    layer.use_pass_normal = layer.use_pass_z = layer.use_pass_position = layer.use_pass_object_index = True


def main():
    parser = argparse.ArgumentParser(prog="render_normals.py", description="Renders data passes with Cycles.")
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--view", required=True, nargs="+")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    for scene in bpy.data.scenes:
        bpy.context.window.scene = scene
        prepare(scene)
        prefix = scene.name + "-" if len(bpy.data.scenes) > 1 else ""
        for view in arguments.view:
            camera, size = view.split(":")
            scene.camera = bpy.data.objects[camera]
            scene.render.resolution_x, scene.render.resolution_y = (int(side) for side in size.split("x"))
            scene.render.filepath = str(arguments.output / f"{prefix}{camera}-{size}.exr")
            bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    try:
        main()
    except Exception:
        traceback.print_exc()
        sys.exit(1)
