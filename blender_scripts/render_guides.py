"""Renders a scene with Cycles: the cross-check of our guides.

    blender -b -noaudio --factory-startup -Y -P render_guides.py -- SCENE OUTPUT.exr --size WIDTHxHEIGHT
            [--camera NAME] [--frame N] [--scene NAME] [--view-layer NAME] [--samples 4,16,64] [--max-bounces N]
            [--materials authored|pure]

SCENE is a .blend, a .glb or a .gltf. OUTPUT.exr is a multilayer EXR of data: Normal, Depth, Position, DiffCol,
GlossCol, Emit and Cryptomatte, one sample at the pixel's centre. Beside it is OUTPUT.camera: the camera as text, for
`scumble transfer --camera` and `scumble crosscheck`.

With --samples there are three renders of the light for each number N of the list, named after OUTPUT without its
ending:

    OUTPUT.all.N.exr    every path of at most --max-bounces bounces
    OUTPUT.ldde.N.exr   the same without the specular lobes of each path's second surface: DiffCol·DiffInd is L.*DDE
    OUTPUT.ld12e.N.exr  as ldde, of one bounce: DiffCol·(DiffDir + DiffInd) is LD{1,2}E

--materials pure replaces every Principled shader by a Diffuse or a Glossy one. docs/crosscheck.md explains the settings
of Cycles.

Lines on stderr: "scumble: rendering …", "scumble: unsupported: …" for what is not rendered as guidegen means it, and
"scumble: error: …". Exit codes: 0, 2 usage, 3 when the scene cannot be rendered, 5 when this Blender is not supported.
"""

import argparse
import os
import re
import shutil
import sys
import traceback
from pathlib import Path

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import blend_check  # noqa: E402  (Blender does not put a script's own folder on the path)
import blend_common  # noqa: E402
import guide_camera  # noqa: E402
import guide_import  # noqa: E402
import guide_instances  # noqa: E402
import guide_materials  # noqa: E402
from blend_common import Unsupported, check_version, fail, say  # noqa: E402

DATA_PASSES = {"normal", "z", "position", "diffuse_color", "glossy_color", "emit", "cryptomatte_object",
               "cryptomatte_material"}
LIGHT_PASSES = {"combined", "emit"} | {f"{lobe}_{part}" for lobe in ("diffuse", "glossy")
                                       for part in ("direct", "indirect", "color")}
TERMINATOR_OFFSETS = [f"shadow_terminator_{kind}offset" for kind in ("", "normal_", "geometry_", "shading_")]
# Paths of animated properties that set_up_output, set_up_cycles, set_up_layer and render_to set.
SET_HERE = {"scenes": re.compile(r"^(render\.(?!use_simplify$|simplify_)|cycles\.|view_layers\[)"),
            "cameras": re.compile(r"^dof\.use_dof$"),
            "lights": re.compile(r"^cycles\.use_multiple_importance_sampling$"),
            "objects": re.compile(r"^(cycles\.)?shadow_terminator_\w*offset$")}
GREASE_PENCIL = {"GPENCIL", "GREASEPENCIL"}  # until Blender 4.2, from 4.3 on
BOUNCES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "volume_bounces")


def parse_arguments():
    parser = argparse.ArgumentParser(prog="render_guides.py", description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene")
    parser.add_argument("output", type=Path)
    parser.add_argument("--size", required=True, type=size, metavar="WIDTHxHEIGHT")
    parser.add_argument("--camera", default="", metavar="NAME", help="left out: the scene's own")
    parser.add_argument("--frame", type=int, metavar="N", help="left out: the one that the .blend was saved at")
    parser.add_argument("--scene", dest="scene_name", metavar="NAME", help="left out: the one that was open when saved")
    parser.add_argument("--view-layer", metavar="NAME", help="left out: the first one that is rendered")
    parser.add_argument("--samples", type=counts, default=[], metavar="LIST",
                        help="renders the light too, e.g. 4,16,64")
    parser.add_argument("--max-bounces", type=bounces, default=8, metavar="N", help="0: direct light alone")
    parser.add_argument("--materials", choices=("authored", "pure"), default="authored")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])


def size(text):
    width, height = (int(side) for side in text.split("x"))
    if not (1 <= width <= 65536 and 1 <= height <= 65536):
        raise ValueError
    return width, height


def counts(text):
    numbers = [int(number) for number in text.split(",")]
    if min(numbers) < 1 or max(numbers) > 1 << 24:
        raise ValueError
    return numbers


def bounces(text):
    if not 0 <= int(text) <= 1024:
        raise ValueError
    return int(text)


def open_scene(options, unsupported):
    if options.scene.lower().endswith(".blend"):
        bpy.ops.wm.open_mainfile(filepath=options.scene, load_ui=False, use_scripts=False)
        scene = blend_common.choose_scene(options.scene_name)
        bpy.context.window.scene = scene
        set_size(scene.render, options.size)
        scene.frame_set(scene.frame_current if options.frame is None else options.frame)
        layer = blend_common.choose_layer(scene, options.view_layer)
        blend_check.check_file(layer, unsupported)
        guide_instances.name_apart(scene, layer, unsupported)
        for kind, paths in SET_HERE.items():  # last: what is hidden takes the frame's values when it is shown
            for thing in getattr(bpy.data, kind):
                blend_common.release(thing, paths)
    else:
        blend_common.note_version(unsupported)
        guide_import.load(options.scene, options.size, unsupported)
        set_size(bpy.context.scene.render, options.size)
    return bpy.context.scene


def set_size(render, pixels):
    render.resolution_x, render.resolution_y, render.resolution_percentage = *pixels, 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1


def set_up_output(scene):
    render = scene.render
    render.engine = "CYCLES"
    render.film_transparent = True
    render.use_border = render.use_compositing = render.use_sequencer = render.use_multiview = False
    render.use_freestyle = render.use_stamp = False
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "ZIP"
    render.use_file_extension = False
    render.use_persistent_data = True  # the same scene is rendered several times


def set_up_cycles(scene):
    """Nothing approximate, nothing clamped, nothing that only one of the two programs has."""
    render, cycles = scene.render, scene.cycles
    render.use_motion_blur = False
    cycles.texture_limit_render, cycles.use_camera_cull, cycles.use_distance_cull = "OFF", False, False  # of Simplify
    cycles.device = "CPU"
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    cycles.film_exposure = 1.0
    cycles.seed, cycles.use_animated_seed, cycles.sample_offset = 0, False, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_fast_gi = cycles.use_guiding = False
    cycles.time_limit = 0.0
    cycles.sampling_pattern = "PROGRESSIVE_MULTI_JITTER" if bpy.app.version < (3, 5) else "TABULATED_SOBOL"
    if hasattr(cycles, "use_light_tree"):
        cycles.use_light_tree = False  # 3.4 has none: each light gets its share of the samples
    cycles.scrambling_distance, cycles.auto_scrambling_distance = 1.0, False  # pixels' noise must not hang together
    cycles.use_layer_samples = "IGNORE"
    cycles.direct_light_sampling_type = "MULTIPLE_IMPORTANCE_SAMPLING"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0.0
    cycles.min_light_bounces = cycles.min_transparent_bounces = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.blur_glossy = 1.0  # guidegen makes lobes after a wide reflection rougher by the same rule
    for camera in bpy.data.cameras:
        camera.dof.use_dof = False
    for lamp in bpy.data.lights:
        lamp.cycles.use_multiple_importance_sampling = True  # without it no mirror shows the light
    for thing in bpy.data.objects:
        for holder in (thing, thing.cycles):  # the object itself in the latest versions
            for name in TERMINATOR_OFFSETS:
                if hasattr(holder, name):
                    setattr(holder, name, 0.0)


def set_up_layer(scene, name):
    """The layer that is exported, alone."""
    chosen = blend_common.choose_layer(scene, name)
    for layer in scene.view_layers:
        layer.use = layer == chosen
    chosen.material_override = None
    chosen.samples = 0
    chosen.pass_alpha_threshold = 0.5
    chosen.pass_cryptomatte_depth = 2
    return chosen


def hide_grease_pencil():
    """Blender draws it over Cycles' picture, and into its pass of depths."""
    for thing in bpy.data.objects:
        if thing.type in GREASE_PENCIL:
            blend_common.release(thing, re.compile(r"^hide_render$"))
            thing.hide_render = True


def choose_passes(layer, wanted):
    for prop in layer.bl_rna.properties:
        if prop.identifier.startswith("use_pass_") and prop.identifier != "use_pass_cryptomatte_accurate":
            setattr(layer, prop.identifier, prop.identifier[len("use_pass_"):] in wanted)


def render_to(scene, path, samples, most_bounces):
    for name in BOUNCES:
        setattr(scene.cycles, name, most_bounces)
    scene.cycles.samples = samples
    scene.render.filepath = str(path)
    path.unlink(missing_ok=True)
    bpy.ops.render.render(write_still=True)
    if not path.is_file():
        raise OSError(f"Blender wrote no {path}")


def render_light(scene, options):
    """A render that would be another one's again is that one's file: at one bounce there is no more light than ld12e
    has, and without a bounce, or where nothing is specular, no path has a second specular surface."""
    stem, most = options.output.with_suffix(""), options.max_bounces

    def path_of(kind, samples):
        return stem.with_name(f"{stem.name}.{kind}.{samples}.exr")

    def render(kind, samples, bounces, same_as):
        if same_as:
            shutil.copyfile(path_of(same_as, samples), path_of(kind, samples))
            return
        say(f"rendering {kind}, {samples} sample" + ("s" if samples > 1 else ""))
        render_to(scene, path_of(kind, samples), samples, bounces)

    for samples in options.samples:
        render("all", samples, most, None)
    filtered = guide_materials.blacken_second_surface() and most > 0
    for samples in options.samples:
        render("ldde", samples, most, None if filtered else "all")
        render("ld12e", samples, min(most, 1), None if most > 1 else "ldde")


def main():
    options = parse_arguments()
    check_version()
    options.output = Path(os.path.abspath(options.output))
    unsupported = Unsupported()
    scene = open_scene(options, unsupported)
    guide_camera.choose(scene, options.camera, unsupported)
    if options.materials == "pure":
        guide_materials.purify()
    set_up_output(scene)
    set_up_cycles(scene)
    layer = set_up_layer(scene, options.view_layer)
    hide_grease_pencil()
    unsupported.say()
    guide_camera.write(scene, options.output.with_suffix(".camera"))
    choose_passes(layer, DATA_PASSES)
    say("rendering data, 1 sample")
    render_to(scene, options.output, 1, 0)
    if options.samples:
        choose_passes(layer, LIGHT_PASSES)
        render_light(scene, options)


if __name__ == "__main__":
    try:
        main()
    except Exception as problem:  # Blender itself would print the traceback and exit with 0
        traceback.print_exc()
        fail(str(problem).strip().removeprefix("Error: ") or type(problem).__name__)
