"""Lamps of every kind, and a world."""

import math

import bpy
from mathutils import Euler

from export_cases.parts import cube, link


def lamp(name, kind, energy, location=(0, 0, 3), **settings):
    data = bpy.data.lights.new(name, kind)
    data.energy = energy
    for key, value in settings.items():
        setattr(data, key, value)
    thing = link(bpy.data.objects.new(name, data))
    thing.location = location
    return thing


def lamp_nodes(thing, strength, color=(1, 1, 1)):
    thing.data.use_nodes = True
    node = thing.data.node_tree.nodes["Emission"]
    node.inputs["Strength"].default_value = strength
    node.inputs["Color"].default_value = (*color, 1.0)
    return node


def lamps():
    cube("Cube")
    lamp("Point", "POINT", 100.0, (1, 2, 3), shadow_soft_size=0.25, color=(1.0, 0.5, 0.25))
    lamp("Spot", "SPOT", 60.0, shadow_soft_size=0.0, spot_size=math.radians(50), spot_blend=0.4)
    lamp("Sun", "SUN", 2.0, angle=math.radians(3)).rotation_euler = Euler((math.radians(90), 0, 0))
    lamp("Square", "AREA", 10.0, shape="SQUARE", size=2.0)
    lamp("Rectangle", "AREA", 10.0, shape="RECTANGLE", size=2.0, size_y=0.5)
    lamp("Disc", "AREA", 10.0, shape="DISK", size=2.0)
    lamp("Ellipse", "AREA", 10.0, shape="ELLIPSE", size=2.0, size_y=1.0)
    lamp("ScaledSquare", "AREA", 10.0, shape="SQUARE", size=1.0).scale = (2.0, 3.0, 7.0)
    lamp_nodes(lamp("NodeSun", "SUN", 2.0), 3.0, (0.5, 1.0, 1.0))
    lamp_nodes(lamp("NodePoint", "POINT", 10.0), 0.5)
    odd = lamp("OddPoint", "POINT", 10.0)
    body = odd.data
    node = lamp_nodes(odd, 1.0)
    texture = body.node_tree.nodes.new("ShaderNodeTexNoise")
    body.node_tree.links.new(texture.outputs["Color"], node.inputs["Color"])
    lamp("HiddenPoint", "POINT", 10.0).hide_render = True
    shy = lamp("Shy", "POINT", 10.0)
    shy.visible_glossy, shy.data.cycles.max_bounces = False, 0
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    world.cycles_visibility.diffuse = False
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.25, 0.5, 1.0, 1.0)
    background.inputs["Strength"].default_value = 2.0
    return {}
