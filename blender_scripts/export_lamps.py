"""Lights, cameras and the world's colour in numbers: part of export_scene.py."""

import math

import bpy
import numpy
from mathutils import Matrix

from export_materials import constant, previous

SPOTS_HAVE_COSINE = bpy.app.version < (3, 5)  # their light falls off with the cosine from the axis, too
# An area lamp of P watts has the radiance P/(4A) up to Blender 3.6, and P/(πA) from 4.0 on. The extras say the first.
AREA_SCALE = 4.0 / math.pi if bpy.app.version >= (4, 0) else 1.0
MOST_BOUNCES = 1024  # of a light: Cycles' default, which limits nothing


def emission_of(lamp, complain):
    """Colour and strength that a light's nodes multiply into it; ones where it has none."""
    if not lamp.use_nodes or not lamp.node_tree:
        return (1.0, 1.0, 1.0), 1.0
    output = lamp.node_tree.get_output_node("CYCLES")
    surface = previous(output.inputs["Surface"]) if output else None
    if surface is None:
        return (0.0, 0.0, 0.0), 1.0
    if surface.node.type != "EMISSION":
        complain(f"node '{surface.node.name}' ({surface.node.type}) is ignored")
        return (1.0, 1.0, 1.0), 1.0
    color, strength = (constant(surface.node.inputs[name]) for name in ("Color", "Strength"))
    if color is None:
        node = previous(surface.node.inputs["Color"]).node
        complain(f"node '{node.name}' ({node.type}) feeds its colour, which is white instead")
        color = (1.0, 1.0, 1.0)
    if strength is None:
        node = previous(surface.node.inputs["Strength"]).node
        complain(f"node '{node.name}' ({node.type}) feeds its strength, which is 1 instead")
        strength = 1.0
    return color, strength


def has_soft_falloff(lamp):
    """Lamps with a radius are discs up to Blender 3.6, spheres in 4.0, and either from 4.1 on."""
    return getattr(lamp, "use_soft_falloff", bpy.app.version[:2] != (4, 0))


def straighten(placed, complain):
    """Gives a lamp whose matrix flattens or shears one of square axes, with the direction that Cycles takes: the third
    axis, of an area light the one across its first two. Returns whether it shines at all there."""
    x, y, z = (placed.matrix.col[axis].to_3d().normalized() for axis in range(3))
    if all(axis.length > 0.5 for axis in (x, y, z)) and max(abs(x @ y), abs(y @ z), abs(z @ x)) < 1e-5:
        return True
    kind, shines = placed.source.data.type, True
    backward = z
    if kind == "AREA":
        backward = x.cross(y)
        shines = backward.length > 1e-6
        if shines and z.length < 0.5:
            complain("is flattened along its axis, and shines to both sides in Cycles: it shines forward alone")
        elif shines:
            complain("is sheared, as a child of what is scaled unevenly, and Cycles shades it otherwise: take that "
                     "scale away")
        if backward @ z < 0.0:
            backward.negate()
    elif kind != "POINT":
        shines = z.length > 0.5
    if backward.length < 1e-6:
        backward = Matrix.Identity(3).col[2]
    backward.normalize()
    right = x - (x @ backward) * backward if kind == "AREA" else y.cross(backward)
    if right.length < 1e-6:
        right = backward.orthogonal()
    right.normalize()
    place = placed.matrix.translation
    placed.matrix = Matrix((right, backward.cross(right), backward)).transposed().to_4x4()
    placed.matrix.translation = place
    return shines


def describe_lamp(placed, unsupported):
    """The extras of one light, whose matrix is straightened. An area light's size includes its object's scale, as in
    Cycles; other kinds ignore it."""
    lamp = placed.source.data

    def complain(what):
        unsupported.add(f"lamp '{placed.source.name}': {what}")

    color, strength = emission_of(lamp, complain)
    extras = {"type": lamp.type, "color": [max(a * b, 0.0) for a, b in zip(lamp.color, color)],
              "energy": max(lamp.energy * strength, 0.0)}
    if lamp.energy * strength < 0.0 or any(a * b < 0.0 for a, b in zip(lamp.color, color)):
        complain("takes light away, which is ignored")
    if lamp.type in {"POINT", "SPOT"}:
        extras["radius"] = lamp.shadow_soft_size
    if lamp.type == "SPOT":
        extras["spot_size"] = lamp.spot_size
        extras["spot_blend"] = lamp.spot_blend
        extras["cosine"] = SPOTS_HAVE_COSINE
    elif lamp.type == "SUN":
        extras["angle"] = lamp.angle
    elif lamp.type == "AREA":
        width, height = (placed.matrix.col[axis].to_3d().length for axis in (0, 1))
        extras["energy"] *= AREA_SCALE
        extras["shape"] = lamp.shape
        extras["size"] = lamp.size * width
        extras["size_y"] = (lamp.size_y if lamp.shape in {"RECTANGLE", "ELLIPSE"} else lamp.size) * height
        if lamp.spread < math.pi - 1e-4:
            complain(f"its spread of {math.degrees(lamp.spread):.4g}° is taken for 180°")
        if lamp.cycles.is_portal:
            complain("is a portal, which gives no light")
            extras["energy"] = 0.0
    if lamp.type in {"POINT", "SPOT"} and extras["radius"] > 0.0 and not has_soft_falloff(lamp):
        complain("is a sphere without Soft Falloff, and is taken for a disc")
    if not getattr(lamp.cycles, "cast_shadow", lamp.use_shadow):  # the lamp's own from Blender 4.2 on
        complain("casts no shadows, which is ignored")
    for kind in ("diffuse", "glossy"):
        if not getattr(placed.source, "visible_" + kind):
            complain(f"does not shine on {kind} surfaces, which is ignored")
    if lamp.cycles.max_bounces < MOST_BOUNCES:
        complain(f"its light ends after {lamp.cycles.max_bounces} bounces, which is ignored")
    if not straighten(placed, complain):
        extras["energy"] = 0.0
    return extras


def describe_border(scene, unsupported):
    """The border of the render, for the extras of each camera: left, bottom, right and top as fractions of its frame.
    Blender renders whole pixels. With a crop the picture is what lies in the border, so its sides are put where those
    pixels begin and end at the file's own resolution: a picture of Blender's own size then has Blender's own pixels.
    Nothing where there is no border."""
    render = scene.render
    if not render.use_border:
        return {}
    sides = [render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y]
    frame = [side * render.resolution_percentage // 100 for side in (render.resolution_x, render.resolution_y)] * 2
    pixels = [int(numpy.float32(at) * numpy.float32(size)) for at, size in zip(sides, frame)]  # Blender's own rounding
    width, height = pixels[2] - pixels[0], pixels[3] - pixels[1]
    if width < 1 or height < 1:
        unsupported.add("the render's border (Output > Format > Render Region) holds no pixel: Blender renders "
                        "nothing, the whole frame is drawn instead")
        return {}
    if render.use_crop_to_border:
        sides = [at / size for at, size in zip(pixels, frame)]
    return {"border": sides, "crop": render.use_crop_to_border, "border_size": f"{width}x{height}"}


def describe_camera(placed, scene):
    """The extras of one camera. `angle` and `ortho_scale` measure the side that the sensor fits; `aspect` is the
    render's width / height. Shifts are fractions of the fitted side."""
    camera = placed.source.data
    render = scene.render
    return {"type": camera.type, "shift_x": camera.shift_x, "shift_y": camera.shift_y, "sensor_fit": camera.sensor_fit,
            "angle": camera.angle, "angle_x": camera.angle_x, "ortho_scale": camera.ortho_scale,
            "clip_start": camera.clip_start, "clip_end": camera.clip_end,
            "aspect": render.resolution_x * render.pixel_aspect_x / (render.resolution_y * render.pixel_aspect_y)}


def world_radiance(scene, view_layer, unsupported):
    """Colour times strength of the world's background."""
    world = scene.world
    if world is None or not view_layer.use_sky:
        return [0.0, 0.0, 0.0]
    for kind in ("diffuse", "glossy"):
        if not getattr(world.cycles_visibility, kind):
            unsupported.add(f"world '{world.name}': does not shine on {kind} surfaces, which is ignored")
    if not world.use_nodes or not world.node_tree:
        return list(world.color)
    output = world.node_tree.get_output_node("CYCLES")
    surface = previous(output.inputs["Surface"]) if output else None
    if output and previous(output.inputs["Volume"]) is not None:
        unsupported.add(f"world '{world.name}': its volume is ignored")
    if surface is None:
        return [0.0, 0.0, 0.0]
    if surface.node.type not in {"BACKGROUND", "EMISSION"}:
        unsupported.add(f"world '{world.name}': node '{surface.node.name}' ({surface.node.type}); it is black instead")
        return [0.0, 0.0, 0.0]
    color, strength = (constant(surface.node.inputs[name]) for name in ("Color", "Strength"))
    if color is None or strength is None:
        fed = previous(surface.node.inputs["Color" if color is None else "Strength"]).node
        unsupported.add(f"world '{world.name}': node '{fed.name}' ({fed.type}); it is black instead")
        return [0.0, 0.0, 0.0]
    return [max(strength * c, 0.0) for c in color]
