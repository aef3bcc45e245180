"""Normal maps and bumps: of several strengths, on dense, coarse, subdivided and flat meshes, stretched and mirrored
ones, beside another material, in several UV maps, one over the other, and seen from behind: part of make_matrix.py."""

import math

import bpy
import numpy as np
from mathutils import Euler


def data_image(name, rgb, space="Non-Color"):
    """Packed, its first row the lowest."""
    result = bpy.data.images.new(name, rgb.shape[1], rgb.shape[0], alpha=False, is_data=space == "Non-Color")
    result.colorspace_settings.name = space
    result.pixels.foreach_set(np.dstack([rgb, np.ones(rgb.shape[:2])]).astype(np.float32).ravel())
    result.pack()
    return result


def relief(size, waves):
    """Heights from 0 to 1 that repeat at the picture's sides, and their normals as a map has them."""
    y, x = np.mgrid[0:size, 0:size] * (2 * math.pi / size)
    height = 0.5 + 0.25 * np.sin(waves * x + np.sin(y)) + 0.25 * np.cos(waves * y)
    slope_x = 0.25 * waves * np.cos(waves * x + np.sin(y))
    slope_y = 0.25 * (np.cos(waves * x + np.sin(y)) * np.cos(y) - waves * np.sin(waves * y))
    normal = np.stack([-slope_x, -slope_y, np.full_like(x, 1.5)], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.repeat(height[..., None], 3, -1), normal * 0.5 + 0.5


def texture(tree, image, uv_map="", scale=None):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    if uv_map or scale:
        place = tree.nodes.new("ShaderNodeUVMap")
        place.uv_map = uv_map
        tree.links.new(place.outputs["UV"], node.inputs["Vector"])
    if scale:
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = (*scale, 1.0)
        tree.links.new(place.outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    return node.outputs["Color"]


def surface_normal(surface):
    shader = next(node for node in surface.node_tree.nodes if "Normal" in node.inputs and "Color" in node.inputs)
    return shader.inputs["Normal"]


def add_map(surface, image, strength=1.0, space="TANGENT", **places):
    tree = surface.node_tree
    node = tree.nodes.new("ShaderNodeNormalMap")
    node.space, node.uv_map = space, places.get("uv_map", "")
    node.inputs["Strength"].default_value = strength
    tree.links.new(texture(tree, image, **places), node.inputs["Color"])
    tree.links.new(node.outputs["Normal"], surface_normal(surface))
    return surface


def add_bump(surface, image, strength=1.0, distance=0.1, invert=False, **places):
    """Over what feeds the normal already."""
    tree, socket = surface.node_tree, surface_normal(surface)
    node = tree.nodes.new("ShaderNodeBump")
    node.invert = invert
    node.inputs["Strength"].default_value, node.inputs["Distance"].default_value = strength, distance
    tree.links.new(texture(tree, image, **places), node.inputs["Height"])
    if socket.is_linked:
        tree.links.new(socket.links[0].from_socket, node.inputs["Normal"])
    tree.links.new(node.outputs["Normal"], socket)
    return surface


def ring_of(kit, name, sides, material, location):
    """An upright prism shaded smooth; its texture runs round once, and is mirrored from the middle on."""
    turn = np.linspace(0, 2 * math.pi, sides, endpoint=False)
    points = np.stack([np.stack([np.cos(turn), np.sin(turn), np.full(sides, z)], -1) for z in (-1.0, 1.0)])
    thing = kit.grid(name, points * (0.45, 0.45, 0.6), material, wrap_columns=True, location=location)
    for corner in thing.data.uv_layers.active.data:
        corner.uv[0] = 1.0 - abs(2.0 * corner.uv[0] - 1.0)
    return thing


def build(kit):
    """`kit` has the shapes and materials of make_matrix.py."""
    height, normals = relief(64, 2)
    flat, fine = relief(128, 5)
    waves, image = data_image("Waves", normals), data_image("Height", height)
    fine_map, painted = data_image("Fine", fine), data_image("Painted", flat, "sRGB")

    def make(*color):
        return kit.material("diffuse", color)

    kit.quad("Floor", (-2.5, -2.5, 0), (5, 0, 0), (0, 4.5, 0), add_map(make(0.8, 0.8, 0.7), fine_map, 1.7))
    back = add_bump(make(0.7, 0.7, 0.8), image, distance=0.15, scale=(2.0, 1.5))
    kit.quad("Back", (-2.5, 2, 0), (5, 0, 0), (0, 0, 3), back)
    side = add_bump(add_map(make(0.8, 0.4, 0.3), waves, 0.5), painted, 0.7, 0.2, invert=True)
    kit.quad("Side", (-2.5, -2.5, 0), (0, 4.5, 0), (0, 0, 3), side)
    kit.ball("Ball", (-1.0, 0.5, 0.85), 0.85, add_map(make(0.7, 0.7, 0.3), waves, scale=(3.0, 2.0)))
    drum = ring_of(kit, "Drum", 7, add_map(make(0.4, 0.7, 0.4), fine_map, 0.4), (0.9, 0.9, 0.9))
    drum.scale, drum.rotation_euler = (1.0, 0.6, 1.4), Euler((0.3, 0.2, 0.5))
    twin = drum.copy()
    twin.data = drum.data.copy()
    twin.location, twin.scale = (1.85, 0.6, 0.8), (-0.8, 0.8, 1.1)
    bpy.context.scene.collection.objects.link(twin)
    twin.data.materials[0] = add_bump(kit.material("glossy", (0.9, 0.8, 0.5), 0.3), image, 0.8, 0.08)
    ring = kit.torus("Ring", (0.25, -1.0, 0.22), 0.5, 0.22, add_map(make(0.8, 0.8, 0.8), waves, uv_map="Second"))
    second = ring.data.uv_layers.new(name="Second")
    for corner, first in zip(second.data, ring.data.uv_layers[0].data):
        corner.uv = (3.0 * first.uv[1], -2.0 * first.uv[0])
    kit.quad("Leaf", (1.2, -1.4, 0.1), (0, 0, 0.9), (0.9, 0.3, 0), add_bump(make(0.3, 0.7, 0.3), image), 2)
    ring.data.materials.append(add_bump(make(0.4, 0.5, 0.8), painted, 0.5, 0.05))
    ring.data.materials.append(add_map(make(0.8, 0.5, 0.4), fine_map, 0.6, uv_map="Second"))
    for number, face in enumerate(ring.data.polygons):
        face.material_index = number // 5 % 3
    bpy.ops.mesh.primitive_monkey_add(size=0.9, location=(0.2, 0.4, 1.9), rotation=(0.2, 0.0, 0.3))
    head = bpy.context.object
    head.data.materials.append(add_map(make(0.7, 0.6, 0.5), waves, scale=(4.0, 4.0)))
    head.data.polygons.foreach_set("use_smooth", [True] * len(head.data.polygons))
    head.modifiers.new("Subdivision", "SUBSURF").render_levels = 2
    kit.ball("Small", (-0.6, -1.4, 0.3), 0.3, add_map(make(0.6, 0.6, 0.6), waves, 0.8, space="OBJECT"))
