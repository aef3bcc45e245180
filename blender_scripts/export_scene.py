"""Exports a .blend scene as the renderer sees it to .glb, with what glTF lacks in `extras`, key "scumble".

    blender -b -noaudio --factory-startup -Y scene.blend -P blender_scripts/export_scene.py -- --output scene.glb
                                     [--frame N | --frames 1-24,30] [--scene NAME] [--view-layer NAME]

`scumble guidegen scene.blend` and `stylize scene.blend` run it by themselves. Modifiers, shape keys, armatures and
geometry nodes are applied as for a render; instances share their mesh; objects hidden from render are left out. The
active camera comes first. docs/blender.md explains the extras.

With --frames, `#` in the output's name stands for the frame's number, and the scene is opened anew for each frame. So
no frame depends on those before it, by remains of an export or by a simulation that was not baked.

Each loss is one line "scumble: unsupported: …" on stderr and one in the scene's extras; each choice among several,
which nobody asked for, is a line "scumble: note: …". Exit codes: 0, 3 when the scene cannot be exported, 5 when this
Blender's version is not supported. The reason is a line "scumble: error: …" on stderr.
"""

import argparse
import os
import re
import sys
import tempfile
import time
import traceback
from pathlib import Path

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import blend_check  # noqa: E402  (Blender does not put a script's own folder on the path)
import export_bends  # noqa: E402
import export_colors  # noqa: E402
import export_flat  # noqa: E402
import export_glb  # noqa: E402
import export_hair  # noqa: E402
import export_lamps  # noqa: E402
import export_materials  # noqa: E402
import export_rest  # noqa: E402
import export_stretch  # noqa: E402
import export_viewport  # noqa: E402
from blend_common import (Unsupported, action_curves, cameras_of, check_version, choose_layer,  # noqa: E402
                          choose_scene, fail, say)

OUR_ATTRIBUTES = {export_rest.ATTRIBUTE, export_bends.ATTRIBUTE, export_colors.ATTRIBUTE}


def without_colors():
    """The exporter's option for that; its name depends on the version. Ours are an attribute of their own."""
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    return {"export_colors": False} if "export_colors" in known else {"export_vertex_color": "NONE"}


def export(scene, view_layer, output, unsupported):
    """All decisions are made before the glTF exporter runs: it gets plain objects with short names of ours, so that its
    output can be identified and completed."""
    flat = export_flat.flatten(scene, view_layer, unsupported)
    if not flat.meshes:
        blend_check.check_emptiness(scene, view_layer, unsupported)
    has_rest = export_rest.add_rest_positions(flat, view_layer)
    materials = export_materials.simplify(flat.materials, flat.shown_maps, unsupported)
    has_heights = export_bends.add_exact_v(flat, materials)
    has_colors = export_colors.add_colors(flat, materials)
    export_colors.add_maps(flat, materials)
    has_attributes = has_rest or has_heights or has_colors
    if has_attributes:
        for mesh in {placed.mesh.name: placed.mesh for placed in flat.meshes}.values():
            export_rest.drop_other_attributes(mesh, OUR_ATTRIBUTES)
    world = export_lamps.world_radiance(scene, view_layer, unsupported)
    lamps = [export_lamps.describe_lamp(lamp, unsupported) for lamp in flat.lamps]
    border = export_lamps.describe_border(scene, unsupported)
    cameras = [{**export_lamps.describe_camera(camera, scene), **border} for camera in flat.cameras]
    export_flat.fill_export_scene(flat, materials, unsupported)
    with tempfile.TemporaryDirectory(prefix="scumble-") as folder:
        raw = Path(folder) / "raw.glb"
        bpy.ops.export_scene.gltf(
            filepath=str(raw), export_format="GLB", use_active_scene=True, export_yup=True, export_apply=False,
            export_cameras=False, export_lights=False, export_animations=False, export_skins=False, export_morph=False,
            export_tangents=False, export_extras=False, export_attributes=has_attributes,
            export_image_format="AUTO", **without_colors())
        document, binary = export_glb.read(raw)
    curves = export_hair.curve_settings(scene)
    binary = export_glb.complete(document, binary, flat, materials, lamps, cameras, curves)
    binary = export_stretch.bake(document, binary, document.get("nodes", []), unsupported)
    document["scenes"][document["scene"]]["name"] = scene.name
    document["scenes"][document["scene"]]["extras"] = {"scumble": {
        "world": world, "blender": bpy.app.version_string, "frame": scene.frame_current,
        "unsupported": unsupported.lines}}
    if flat.lost_camera:
        document["scenes"][document["scene"]]["extras"]["scumble"]["lost_camera"] = flat.lost_camera
    export_glb.write(output, document, binary)


def parse_frames(text):
    """1-24, 3,5-10, 12-24x2 and 10-1x-1, as the command line passes them on."""
    frames = []
    for part in text.split(","):
        match = re.fullmatch(r"(-?\d+)(?:-(-?\d+)(?:x(-?\d+))?)?", part)
        if not match or match[3] == "0":
            raise argparse.ArgumentTypeError(f"'{part}' is no range of frames like 1-24 or 12-24x2")
        first, last = int(match[1]), int(match[2] or match[1])
        step = abs(int(match[3] or 1))
        frames += range(first, last + 1, step) if first <= last else range(first, last - 1, -step)
    return frames


def numbered(path, frame):
    """Blender's rule: the run of # becomes the number, filled up with zeros."""
    def digits(run):
        return ("-" if frame < 0 else "") + str(abs(frame)).zfill(len(run[0]))
    return path.with_name(re.sub("#+", digits, path.name))


def wait_for_reader(written, ahead, parent):
    """Until fewer than `ahead` of the files are still there, or the reader is gone."""
    while sum(path.exists() for path in written[-ahead:]) >= ahead:
        if os.getppid() != parent:
            fail("the program that reads the frames has ended")
        time.sleep(0.02)


def open_again():
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath, use_scripts=False)


def show_frame(scene, view_layer, frame):
    """Animation reaches the file's own data only from the window's layer, and only once that has been evaluated."""
    bpy.context.window.scene, bpy.context.window.view_layer = scene, view_layer
    export_viewport.bring_in(cameras_of(scene, Unsupported()), scene, view_layer)
    view_layer.update()
    scene.frame_set(frame)


def export_frame(arguments, frame, output, unsupported):
    scene = choose_scene(arguments.scene)
    view_layer = choose_layer(scene, arguments.view_layer)
    show_frame(scene, view_layer, frame if frame is not None else scene.frame_current)
    blend_check.check_file(view_layer, unsupported)
    export(scene, view_layer, output, unsupported)


def is_surely_lit(scene):
    """Whether some light is in the render of every frame, by its own settings."""
    def blinks(thing):
        return any(curve.data_path == "hide_render" for curve in action_curves(thing))
    return any(thing.type == "LIGHT" and not thing.hide_render and not blinks(thing) for thing in scene.objects)


def note_choices(arguments):
    scene = choose_scene(arguments.scene)
    if arguments.scene is None and len(bpy.data.scenes) > 1:
        say(f"note: scene '{scene.name}', which was open when the file was saved, of "
            + ", ".join(f"'{other.name}'" for other in bpy.data.scenes) + ": --scene takes another")
    rendered = [layer.name for layer in scene.view_layers if layer.use]
    if arguments.view_layer is None and len(rendered) > 1:
        say(f"note: view layer '{rendered[0]}', the first of those that are rendered, "
            + ", ".join(f"'{name}'" for name in rendered) + ": --view-layer takes another")


def export_start(arguments):
    """What is the same in all frames: their rate and range, the files that the scene reads, and where we must decide
    from where the scene is seen or lit, the scene at its first frame. False where there was nothing to export."""
    scene = choose_scene(arguments.scene)
    if arguments.fps_file:
        fps, base = scene.render.fps, scene.render.fps_base
        rate = f"{fps}/{base:.6g}" if base > 1 else f"{fps / base:.6g}"
        arguments.fps_file.write_text(f"{rate} {scene.frame_start} {scene.frame_end} {scene.frame_current}")
    if arguments.files_file:
        files = bpy.utils.blend_paths(absolute=True, packed=False, local=False)
        arguments.files_file.write_bytes(b"\n".join(os.fsencode(file) for file in files))
    cameras = cameras_of(scene, Unsupported())
    if not arguments.start_file or (cameras and is_surely_lit(scene) and not arguments.start_always):
        return False
    export_frame(arguments, scene.frame_start, arguments.start_file, Unsupported())
    return True


def export_range(arguments, opened):
    parent, written, said = os.getppid(), [], Unsupported()
    for number, frame in enumerate(arguments.frames):
        if arguments.ahead:
            wait_for_reader(written, arguments.ahead, parent)
        if number > 0 or not opened:
            open_again()
        unsupported = Unsupported()
        output = numbered(arguments.output, frame)
        export_frame(arguments, frame, output, unsupported)
        written.append(output)
        for line in unsupported.lines:
            said.add(line)
    return said


def main():
    parser = argparse.ArgumentParser(prog="export_scene.py", description="Exports a .blend scene for scumble.")
    parser.add_argument("--output", required=True, type=Path, help=".glb file to write; with --frames, # is the number")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--frame", type=int, help="frame of the scene; left out: the one it was saved at")
    which.add_argument("--frames", type=parse_frames, help="several frames, as 1-24 or 3,5-10 or 12-24x2")
    parser.add_argument("--ahead", type=int, default=0,
                        help="with --frames: wait while so many files are there; a reader deletes them. 0: never wait")
    parser.add_argument("--fps-file", type=Path,
                        help="write there the frames a second, the first frame, the last, and the one it was saved at")
    parser.add_argument("--files-file", type=Path,
                        help="write the libraries, pictures and other files there that the .blend reads, one a line")
    parser.add_argument("--start-file", type=Path,
                        help=".glb file for the scene at its first frame, where it has no camera or perhaps no lamp")
    parser.add_argument("--start-always", action="store_true", help="write --start-file in any case")
    parser.add_argument("--scene", help="scene by name; left out: the one that was open when the file was saved")
    parser.add_argument("--view-layer", help="view layer by name; left out: the first one that is rendered")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    if arguments.frames is not None and "#" not in arguments.output.name:
        parser.error("with --frames the output's name needs a #, where the frame's number goes")
    check_version(", or export to .glb by hand")
    unsupported = Unsupported()
    note_choices(arguments)
    opened = not export_start(arguments)
    if arguments.frames is not None:
        unsupported = export_range(arguments, opened)
    else:
        if not opened:
            open_again()
        export_frame(arguments, arguments.frame, arguments.output, unsupported)
    unsupported.say()


if __name__ == "__main__":
    try:
        main()
    except Exception as problem:  # Blender itself would print the traceback and exit with 0
        traceback.print_exc()
        fail(f"the export stopped at {type(problem).__name__}: {problem}")
