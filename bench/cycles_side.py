"""Cycles' side of cycles_bench.py, run by Blender:

    blender -b -noaudio --factory-startup -P cycles_side.py -- make SCENE.glb DELTA.blend SOFT.blend
    blender -b -noaudio --factory-startup -P cycles_side.py -- data|full|LDE SCENE OUTPUT.exr WIDTHxHEIGHT SAMPLES SEED

`make` gives a scene materials that both renderers interpret alike, pure Diffuse and Glossy shaders, and writes it
twice: with its own lights, and with lights that have an extent plus an area light.
"""

import math
import sys

import bpy

BOUNCES = 8
# The materials of the still life that shine most; everything else is Diffuse.
GLOSSY = ("Brass", "Wire", "Dish")


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


def make_pure(material):
    tree = material.node_tree
    principled = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    glossy = material.name in GLOSSY
    pure = tree.nodes.new("ShaderNodeBsdfGlossy" if glossy else "ShaderNodeBsdfDiffuse")
    color = principled.inputs["Base Color"]
    pure.inputs["Color"].default_value = color.default_value
    pure.inputs["Roughness"].default_value = principled.inputs["Roughness"].default_value if glossy else 0.0
    if glossy:
        pure.distribution = "GGX"
    for name in ("Color", "Normal"):
        source = color if name == "Color" else principled.inputs[name]
        for link in list(source.links):
            tree.links.new(link.from_socket, pure.inputs[name])
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(pure.outputs["BSDF"], output.inputs["Surface"])
    tree.nodes.remove(principled)


def make(source, delta, soft):
    open_scene(source)
    for material in bpy.data.materials:
        if material.use_nodes:
            make_pure(material)
    for lamp in bpy.data.lights:
        if lamp.type == "SUN":
            lamp.angle = 0.0
        else:
            lamp.shadow_soft_size = 0.0
    bpy.ops.wm.save_as_mainfile(filepath=delta)
    for lamp in bpy.data.lights:
        if lamp.type == "SUN":
            lamp.angle = math.radians(5.0)
        else:
            lamp.shadow_soft_size = 0.25
    panel = bpy.data.lights.new("Panel", "AREA")
    panel.shape, panel.size, panel.size_y, panel.energy = "RECTANGLE", 1.5, 1.0, 60.0
    lamp = bpy.data.objects.new("Panel", panel)
    lamp.location = (0.0, -0.5, 3.0)  # above, and shines straight down
    bpy.context.scene.collection.objects.link(lamp)
    bpy.ops.wm.save_as_mainfile(filepath=soft)


def render(mode, source, output, size, samples, seed):
    open_scene(source)
    scene = bpy.context.scene
    if scene.camera is None:
        scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
    settings = scene.render
    settings.engine = "CYCLES"
    settings.resolution_x, settings.resolution_y = (int(side) for side in size.split("x"))
    settings.resolution_percentage = 100
    settings.film_transparent = True
    settings.use_compositing = settings.use_sequencer = False
    settings.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.image_settings.color_depth = "32"
    settings.image_settings.exr_codec = "ZIP"
    settings.filepath, settings.use_file_extension = output, False
    cycles = scene.cycles
    cycles.samples, cycles.seed = int(samples), int(seed)
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0  # ours clamps nothing either
    bounces = BOUNCES if mode == "full" else 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    layer = scene.view_layers[0]
    if mode == "data":
        for lamp in [o for o in scene.objects if o.type == "LIGHT"]:
            bpy.data.objects.remove(lamp)
        layer.use_pass_normal = layer.use_pass_z = layer.use_pass_position = True
        layer.use_pass_object_index = layer.use_pass_material_index = layer.use_pass_diffuse_color = True
    if mode == "LDE":
        layer.use_pass_diffuse_direct = layer.use_pass_diffuse_color = True
    bpy.ops.render.render(write_still=True)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    (make if arguments[0] == "make" else render)(*(arguments[1:] if arguments[0] == "make" else arguments))


try:
    main()
except Exception as error:  # Blender itself would go on and exit with 0
    print("cycles_side: %s" % error, file=sys.stderr)
    sys.exit(1)
