"""What is looked through: cameras of every kind, borders, view layers."""

import bmesh
import bpy
from mathutils import Euler

from export_cases.parts import cube, link, new_material

PICTURES = [(160, 90), (90, 160), (100, 100)]  # in which cameras are looked through


def camera(name, location, rotation, **settings):
    thing = link(bpy.data.objects.new(name, bpy.data.cameras.new(name)))
    thing.location, thing.rotation_euler = location, Euler(rotation)
    for key, value in settings.items():
        setattr(thing.data, key, value)
    return thing


def cameras():
    cube("Cube")
    place, turn = (4, -5, 3), (1.1, 0.1, 0.7)
    camera("Auto", place, turn, lens=35)
    camera("Horizontal", place, turn, sensor_fit="HORIZONTAL", lens=40)
    camera("Vertical", place, turn, sensor_fit="VERTICAL", lens=40, sensor_height=20)
    camera("Shifted", place, turn, shift_x=0.3, shift_y=-0.2)
    camera("ShiftedVertical", place, turn, sensor_fit="VERTICAL", shift_x=-0.15, shift_y=0.25)
    camera("Ortho", place, turn, type="ORTHO", ortho_scale=5, shift_x=0.1, shift_y=0.2)
    camera("OrthoVertical", place, turn, type="ORTHO", ortho_scale=5, sensor_fit="VERTICAL")
    camera("Panorama", place, turn, type="PANO")
    bpy.context.scene.camera = bpy.data.objects["Shifted"]
    graph = bpy.context.evaluated_depsgraph_get()
    result = {}
    for thing in bpy.data.objects:
        if thing.type == "CAMERA" and thing.data.type != "PANO":
            views = {}
            for width, height in PICTURES:
                matrix = thing.calc_matrix_camera(graph, x=width, y=height)
                views[f"{width}x{height}"] = [list(row) for row in matrix]
            result[thing.name] = {"projection": views, "world": [list(row) for row in thing.matrix_world]}
    return result


def panorama():
    """The active camera is panoramic, another one is not."""
    cube("Cube")
    camera("Side", (4, -5, 3), (1.1, 0.1, 0.7))
    bpy.context.scene.camera = camera("Round", (4, -5, 3), (1.1, 0.1, 0.7), type="PANO")
    return None


def ball(name, location, scale, material, collection=None):
    data = bpy.data.meshes.new(name)
    shape = bmesh.new()
    bmesh.ops.create_uvsphere(shape, u_segments=24, v_segments=12, radius=1.0)
    for face in shape.faces:
        face.smooth = True
    shape.to_mesh(data)
    shape.free()
    data.materials.append(material)
    thing = link(bpy.data.objects.new(name, data), collection)
    thing.location, thing.scale = location, scale
    return thing


def rendered():
    """Round and flat things, mirrored, stretched, sheared, subdivided and instanced, before cameras of every kind.
    render_normals.py has Cycles render it."""
    grey = new_material("Grey", "ShaderNodeBsdfDiffuse")[0]
    ball("Ball", (0, 0, 1), (1, 1, 1), grey)
    ball("Egg", (2.4, 0.3, 1.2), (0.7, 0.9, 1.2), grey).rotation_euler = Euler((0.4, 0.3, 0.1))
    ball("Mirrored", (-2.4, 0.2, 1), (-0.8, 1, 1), grey).rotation_euler = Euler((0.5, 0.2, 0.9))
    floor = cube("Floor", (0, 0, -0.1), grey)
    floor.scale = (9, 7, 0.2)
    cube("Round", (0.4, -1.9, 0.5), grey).modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    bpy.data.objects["Round"].modifiers[0].levels = 1
    for polygon in bpy.data.objects["Round"].data.polygons:
        polygon.use_smooth = True
    group = bpy.data.collections.new("Group")
    ball("Pebble", (0, 0, 0.3), (0.4, 0.3, 0.3), grey, group)
    for number in range(4):
        instancer = link(bpy.data.objects.new(f"Heap{number}", None))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", group
        instancer.location = (-2.6 + 1.6 * number, 2.4, 0.1 * number)
        instancer.rotation_euler, instancer.scale = Euler((0, 0.2, number)), (1, 1 + 0.4 * number, 1)
    for number, thing in enumerate(thing for thing in bpy.data.objects if thing.type == "MESH"):
        thing.pass_index = number + 1
    place, turn = (4.5, -7, 4.2), (1.15, 0, 0.57)
    camera("Auto", place, turn, lens=35)
    camera("Shifted", place, turn, lens=40, shift_x=0.12, shift_y=-0.08, sensor_fit="HORIZONTAL")
    camera("Vertical", place, turn, lens=30, sensor_fit="VERTICAL", shift_y=0.05)
    camera("Ortho", place, turn, type="ORTHO", ortho_scale=8)
    bpy.context.scene.camera = bpy.data.objects["Auto"]
    return {thing.name: thing.pass_index for thing in bpy.data.objects if thing.type == "MESH"}


def bordered():
    """The scene of rendered(), twice: with a border in the frame, and cropped to it."""
    rendered()
    scene = bpy.context.scene
    scene.name = "Bordered"
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 500, 340, 50
    render.use_border = True
    render.border_min_x, render.border_max_x = 0.213, 0.777
    render.border_min_y, render.border_max_y = 0.127, 0.803
    bpy.ops.scene.new(type="LINK_COPY")
    cropped = bpy.context.scene
    cropped.name = "Cropped"
    cropped.render.use_crop_to_border = True
    bpy.context.window.scene = scene
    return None


def layers():
    """Three scenes; in the first one three view layers and a collection that is hidden from render, in the next one a
    shadow catcher."""
    scene = bpy.context.scene
    scene.name = "Shot"
    grey = new_material("Grey", "ShaderNodeBsdfDiffuse")[0]
    for name, things in (("Front", ["Near"]), ("Back", ["Far", "Farther"]), ("Car", ["Body", "Wheel", "Door"])):
        collection = bpy.data.collections.new(name)
        scene.collection.children.link(collection)
        for number, thing in enumerate(things):
            cube(thing, (2.0 * number, 0, 0), grey, collection)
    bpy.data.collections["Car"].hide_render = True
    cube("Ghost", (0, 3, 0), grey).hide_render = True
    first = scene.view_layers[0]
    first.name, first.use = "Spare", False
    for name, excluded in (("Fore", ["Back"]), ("Rear", ["Front"])):
        layer = scene.view_layers.new(name)
        for other in excluded:
            layer.layer_collection.children[other].exclude = True
    for other in ("Front", "Back"):
        first.layer_collection.children[other].exclude = True
    for name, thing in (("Other", "Alone"), ("Bare", None)):
        other = bpy.data.scenes.new(name)
        if thing:
            cube(thing, (0, 0, 0), grey, other.collection).is_shadow_catcher = True
    bpy.context.window.scene = scene
    return None
