"""What files from elsewhere do that the other tests' scenes do not, for oddities_test.py.

    blender -b -noaudio --factory-startup -P tests/blender/make_oddities.py -- --output FOLDER

FOLDER gets odd.blend, images.blend and, at frame 10, placed.blend, seen from above in cells of 1 m; layered.blend,
whose second view layer moves; limits.blend with lamps and instancers; and blinking.blend and lost.blend with images.
"""

import argparse
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import odd_materials  # noqa: E402  (Blender does not put a script's own folder on the path)
import odd_objects  # noqa: E402
import odd_places  # noqa: E402
from export_cases import images  # noqa: E402

COLUMNS, ROWS = 8, 6


def save(folder, name):
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / (name + ".blend")), check_existing=False)


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    camera = bpy.data.objects.new("Above", bpy.data.cameras.new("Above"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", COLUMNS
    camera.location = ((COLUMNS - 1) / 2, (1 - ROWS) / 2, 20)
    return scene


def make_odd(folder):
    clear()
    odd_objects.asset()
    save(folder, "asset")
    scene = clear()
    world = bpy.data.worlds.new("World")
    scene.world, world.use_nodes = world, True
    tree = world.node_tree
    strength = tree.nodes.new("ShaderNodeRGB")
    strength.outputs[0].default_value = (0, 1, 0, 1)
    tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(strength.outputs[0], tree.nodes["Background"].inputs["Strength"])
    odd_materials.build()
    odd_objects.build(folder / "asset.blend")
    save(folder, "odd")


def make_layered(folder):
    """The window's layer excludes what moves from frame 1, at which the file is saved, to frame 10. Both
    layers exclude a camera that moves."""
    scene = clear()
    odd_materials.plane("First", 0, odd_materials.diffuse("red", (1, 0, 0)))
    moving = bpy.data.collections.new("Moving")
    scene.collection.children.link(moving)
    paint = odd_materials.diffuse("painted", (0, 1, 0))
    goes, comes = (odd_materials.plane(name, cell, paint, moving) for name, cell in (("Goes", 1), ("Comes", 2)))
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    moving.objects.link(sun)
    colour = paint.node_tree.nodes["Diffuse BSDF"].inputs["Color"]
    for frame, late in ((1, False), (10, True)):
        goes.hide_render, comes.hide_render, sun.data.energy = late, not late, 5 if late else 1
        colour.default_value = (0, 0, 1, 1) if late else (0, 1, 0, 1)
        for owner, path in ((goes, "hide_render"), (comes, "hide_render"), (sun.data, "energy"),
                            (colour, "default_value")):
            owner.keyframe_insert(path, frame=frame)
    away, excluded = bpy.data.objects.new("Away", bpy.data.cameras.new("Away")), bpy.data.collections.new("Excluded")
    scene.collection.children.link(excluded)
    excluded.objects.link(away)
    for frame in (1, 10):
        away.location.x = frame
        away.keyframe_insert("location", frame=frame)
    second = scene.view_layers.new("Second")
    scene.frame_set(10)
    scene.frame_set(1)
    bpy.context.view_layer.layer_collection.children["Moving"].exclude = True
    for layer in (bpy.context.view_layer, second):
        layer.layer_collection.children["Excluded"].exclude = True
    odd_materials.plane("Tilted", 3, odd_materials.tilted())
    odd_materials.holes()
    odd_materials.said()
    odd_objects.emitters()
    odd_objects.diced()
    odd_objects.filtered()
    scene.view_layers.new("Strands").use_solid = second.use_strand = False
    save(folder, "layered")


def make_placed(folder):
    clear()
    odd_places.rig()
    save(folder, "rig")
    scene = clear()
    odd_places.build(folder)
    scene.frame_set(1)
    save(folder, "placed")


def make_limits(folder):
    for name in ("paints/ink", "oil", "catcher"):
        (folder / "assets" / name).mkdir(parents=True)
    for name in ("paints/ink", "catcher"):
        (folder / "assets" / name / "style.toml").touch()
    clear()
    odd_places.asset()
    save(folder / "assets", "styled")
    clear()
    odd_places.build_limits(folder)
    save(folder, "limits")


def make_images(folder):
    for name, build in (("images", images.build), ("blinking", images.build_blinking), ("lost", images.build_lost)):
        clear()
        build(folder)
        save(folder, name)


def main():
    parser = argparse.ArgumentParser(prog="make_oddities.py", description="Makes the scenes of oddities_test.py.")
    parser.add_argument("--output", required=True, type=Path)
    folder = parser.parse_args(sys.argv[sys.argv.index("--") + 1:]).output
    np.seterr(all="raise")
    make_odd(folder)
    make_layered(folder)
    make_placed(folder)
    make_limits(folder)
    make_images(folder)


if __name__ == "__main__":
    try:
        main()
    except Exception:
        traceback.print_exc()
        sys.exit(1)
