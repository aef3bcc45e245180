"""Renders one sphere in many materials and lights with Cycles, and exports each for our own tracer: the Blender half of
bench/compare_materials.py, which runs it.

    blender -b -noaudio --factory-startup -P bench/material_spheres.py -- --cases CASES.json --output FOLDER

CASES.json is a list of {"name", "light", "bsdf", "color", "roughness", "metallic", "size", "samples"}. Each gives
FOLDER/NAME.exr, Cycles' passes, and FOLDER/NAME.glb by blender_scripts/export_scene.py, exactly as `scumble guidegen`
exports a .blend.
"""

import argparse
import json
import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "blender_scripts"))
import export_scene  # noqa: E402
from export_nodes import principled_input  # noqa: E402

AZIMUTH, ELEVATION = -40.0, 40.0  # the key light's, core/image/direction.h
LAMP_DISTANCE, LAMP_SIDE = 4.0, 2.0  # m


def key_direction():
    """Towards the key light, in Blender's axes, for a camera that looks along +Y."""
    a, e = math.radians(AZIMUTH), math.radians(ELEVATION)
    x, y, z = math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a)
    return Vector((x, -z, y))


def link(name, data, location=(0, 0, 0)):
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    return thing


def make_material(case):
    material = bpy.data.materials.new("paint")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    kind = {"principled": "ShaderNodeBsdfPrincipled", "diffuse": "ShaderNodeBsdfDiffuse",
            "glossy": "ShaderNodeBsdfGlossy"}[case["bsdf"]]
    shader = nodes.new(kind)
    color = (*case["color"], 1.0)
    if case["bsdf"] == "principled":
        shader.distribution = "GGX"
        shader.inputs["Base Color"].default_value = color
        shader.inputs["Metallic"].default_value = case["metallic"]
        shader.inputs["Roughness"].default_value = case["roughness"]
        principled_input(shader, "Specular").default_value = 0.5
        shader.inputs["IOR"].default_value = 1.5  # Cycles 4 takes F0 from it
    else:
        shader.inputs["Color"].default_value = color
        shader.inputs["Roughness"].default_value = case["roughness"] if case["bsdf"] == "glossy" else 0.0
    if case["bsdf"] == "glossy":
        shader.distribution = "GGX"
    links.new(shader.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def make_light(case):
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (1, 1, 1, 1)
    background.inputs["Strength"].default_value = 1.0 if case["light"] == "world" else 0.0
    bpy.context.scene.world = world
    if case["light"] == "world":
        return
    direction = key_direction()
    data = bpy.data.lights.new("key", {"sun": "SUN", "area": "AREA"}[case["light"]])
    if case["light"] == "sun":
        data.energy, data.angle = math.pi, 0.0
    else:
        data.shape, data.size = "SQUARE", LAMP_SIDE
        data.energy = 4.0 * math.pi * LAMP_DISTANCE ** 2  # π W/m² at the sphere's centre, nearly
    thing = link("key", data, direction * LAMP_DISTANCE)
    thing.rotation_euler = direction.to_track_quat("Z", "Y").to_euler()


def build(case):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=160, ring_count=80, radius=1.0)
    sphere = bpy.context.object
    sphere.data.polygons.foreach_set("use_smooth", [True] * len(sphere.data.polygons))
    sphere.data.materials.append(make_material(case))
    make_light(case)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 2.05
    thing = link("camera", camera, (0, -5, 0))
    thing.rotation_euler = (math.pi / 2, 0, 0)
    bpy.context.scene.camera = thing


def render(case, output):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = case["size"]
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(output)
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = case["samples"], False, False
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01  # at the pixel's centre, as our guides
    cycles.light_sampling_threshold = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    layer = scene.view_layers[0]
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_color = layer.use_pass_diffuse_indirect = True
    layer.use_pass_glossy_direct = layer.use_pass_glossy_color = layer.use_pass_glossy_indirect = True
    bpy.ops.render.render(write_still=True)


def main():
    parser = argparse.ArgumentParser(prog="material_spheres.py")
    parser.add_argument("--cases", required=True, type=Path)
    parser.add_argument("--output", required=True, type=Path)
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    for case in json.loads(arguments.cases.read_text()):
        build(case)
        render(case, arguments.output / (case["name"] + ".exr"))
        unsupported = export_scene.Unsupported()
        export_scene.export(bpy.context.scene, bpy.context.view_layer, arguments.output / (case["name"] + ".glb"),
                            unsupported)
        if unsupported.lines:
            sys.exit("scumble: error: " + case["name"] + ": " + "; ".join(unsupported.lines))


try:
    main()
except Exception as problem:  # Blender itself would print the traceback and exit with 0
    import traceback
    traceback.print_exc()
    sys.exit(f"scumble: error: the renders stopped at {type(problem).__name__}: {problem}")
