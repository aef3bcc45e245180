"""Lamps and the world of a glTF scene as guidegen understands them: part of render_guides.py."""

import math

import bpy

from export_lamps import AREA_SCALE, SPOTS_HAVE_COSINE
from guide_import_materials import ours
from guide_materials import math as math_node

LUMENS_PER_WATT = 683.0


def replace_lamp(old, name, extras, backward):
    """The lamp that export_scene.py described; area lamps come as empties. `backward` is against its direction."""
    lamp = bpy.data.lights.new(name, extras["type"])
    most = max(max(extras["color"]), 1.0)
    lamp.color = [value / most for value in extras["color"]]
    lamp.energy = extras["energy"] * most
    if extras["type"] in {"POINT", "SPOT"}:
        lamp.shadow_soft_size = extras["radius"]
    if extras["type"] == "SPOT":
        lamp.spot_size, lamp.spot_blend = extras["spot_size"], extras["spot_blend"]
        if extras.get("cosine", True) != SPOTS_HAVE_COSINE:
            tree, cosine = cosine_from_axis(lamp, backward)
            emit(tree, math_node(tree, "DIVIDE" if SPOTS_HAVE_COSINE else "MULTIPLY", 1.0, cosine))
    elif extras["type"] == "SUN":
        lamp.angle = extras["angle"]
    elif extras["type"] == "AREA":
        lamp.energy /= AREA_SCALE
        lamp.shape = extras["shape"]
        lamp.size, lamp.size_y = extras["size"], extras["size_y"]
        if extras["shape"] in {"SQUARE", "DISK"} and abs(lamp.size - lamp.size_y) > 1e-7 * lamp.size:
            lamp.shape = {"SQUARE": "RECTANGLE", "DISK": "ELLIPSE"}[extras["shape"]]  # a stretched object's
    thing = bpy.data.objects.new(name, lamp)
    bpy.context.scene.collection.objects.link(thing)
    if old is not None:
        bpy.data.objects.remove(old)
    return thing


def use_punctual(lamp, light, backward):
    """Lights of KHR_lights_punctual have no extent. Their cones have no cosine and another edge than Cycles' spots, so
    a spot becomes a point lamp whose nodes make that cone."""
    intensity = light.get("intensity", 1.0)
    lamp.energy = intensity / LUMENS_PER_WATT * (1.0 if light["type"] == "directional" else 4.0 * math.pi)
    if light["type"] == "directional":
        lamp.angle = 0.0
        return
    lamp.shadow_soft_size = 0.0
    if light["type"] != "spot":
        return
    cone = light.get("spot", {})
    inner = math.cos(cone.get("innerConeAngle", 0.0))
    outer = math.cos(cone.get("outerConeAngle", math.pi / 4))
    lamp.type = "POINT"
    tree, cosine = cosine_from_axis(lamp, backward)
    scale = 1.0 / max(0.001, inner - outer)
    linear = math_node(tree, "MULTIPLY_ADD", cosine, scale)
    linear.node.inputs[2].default_value = -outer * scale
    linear.node.use_clamp = True
    emit(tree, math_node(tree, "MULTIPLY", linear, linear))


def cosine_from_axis(lamp, backward):
    """The lamp's emptied node tree, and a socket in it: the cosine between the lamp's direction and what it lights."""
    lamp.use_nodes = True
    tree = lamp.node_tree
    tree.nodes.clear()
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    dot = tree.nodes.new("ShaderNodeVectorMath")
    dot.operation = "DOT_PRODUCT"
    tree.links.new(geometry.outputs["Incoming"], dot.inputs[0])
    dot.inputs[1].default_value = -backward  # Incoming points from the lamp to what it lights
    return tree, dot.outputs["Value"]


def emit(tree, strength):
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(strength, emission.inputs["Strength"])
    output = tree.nodes.new("ShaderNodeOutputLight")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])


def complete_world(gltf, scene):
    extras = ours(gltf.data.scenes[gltf.data.scene or 0].extras) if gltf.data.scenes else {}
    if "world" not in extras:
        return
    world = scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*extras["world"], 1.0)
    background.inputs["Strength"].default_value = 1.0
