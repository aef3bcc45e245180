"""Files that lack something; these write their files themselves."""

import struct

import bpy

from export_cases.parts import checker, clear, cube, link, new_material, save, textured


def library(folder, name, *objects):
    """A .blend file of cubes; returns its path. The scene at hand is gone afterwards."""
    clear()
    for thing in objects:
        cube(thing)
    save(folder, name)
    return folder / (name + ".blend")


def link_from(path, *names):
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.objects = list(names)
    for thing in wanted.objects:
        link(thing)


def broken(folder):
    """A lost texture, two that only look lost, a lost library, a library without its object, drivers, a script, and an
    override."""
    lost, poor = library(folder, "lost", "Lost", "LostToo"), library(folder, "poor", "Stays", "Goes")
    clear()
    link_from(lost, "Lost", "LostToo")
    link_from(poor, "Stays", "Goes")
    image = bpy.data.images.new("Gone", 4, 4)
    image.source, image.filepath = "FILE", "//textures/gone.png"
    material = textured("MissingTexture", "ShaderNodeBsdfDiffuse", image)
    cube("Textured", (0, 0, 0), material)
    cube("Packed", (2, 0, 0), textured("PackedTexture", "ShaderNodeBsdfDiffuse", checker()))
    made = bpy.data.images.new("Made", 4, 4)
    cube("Generated", (4, 0, 0), textured("GeneratedTexture", "ShaderNodeBsdfDiffuse", made))
    driven = cube("Driven", (1.5, 0, 3))
    driven.driver_add("location", 0).driver.expression = "unknown(frame)"
    driven.driver_add("location", 1).driver.expression = "also_unknown(frame)"
    driven.driver_add("location", 2).driver.expression = "frame * 0.0 + 7.0"
    text = bpy.data.texts.new("rig.py")
    text.use_module = True
    bpy.data.texts.new("notes")
    bpy.context.view_layer.material_override = new_material("Clay", "ShaderNodeBsdfDiffuse")[0]
    save(folder, "broken")
    lost.unlink()
    library(folder, "poor", "Stays")
    bpy.ops.wm.open_mainfile(filepath=str(folder / "broken.blend"))
    return {}


def patched(path, value, other):
    """Puts a number into a file that Blender's own properties do not take; `value` stands in it once at least."""
    old, new = struct.pack("<f", value), struct.pack("<f", other)
    content = path.read_bytes()
    if old not in content:
        raise ValueError(f"{path.name} does not hold {value}")
    path.write_bytes(content.replace(old, new))


def old(folder):
    """As files of Blender 2.4 to 2.7 are now: a material without nodes whose roughness is beyond 1, no camera. What
    moves was saved far from where it starts."""
    clear()
    material = bpy.data.materials.new("Ground")
    material.roughness, material.metallic = 0.718281, 0.618033
    thing = cube("Wanderer", material=material)
    for frame, x in ((1, 0.0), (9, 40.0)):
        thing.location.x = x
        thing.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(9)
    save(folder, "old")
    for value in (material.roughness, material.metallic):
        patched(folder / "old.blend", value, 1.542585)
    return {}
