"""Makes the .blend files of export_test.cpp, and expected.json with Blender's own numbers.

    blender -b -noaudio --factory-startup -P tests/blender/make_cases.py -- --output FOLDER
"""

import argparse
import json
import math
import struct
import sys
import traceback
from pathlib import Path

import bmesh
import bpy
from mathutils import Euler, Matrix, Vector

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import versions  # noqa: E402  (Blender does not put a script's own folder on the path)

PICTURES = [(160, 90), (90, 160), (100, 100)]  # in which cameras are looked through


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.engine = "CYCLES"


def link(thing, collection=None):
    (collection or bpy.context.scene.collection).objects.link(thing)
    return thing


def cube(name, location=(0, 0, 0), material=None, collection=None, data=None):
    if data is None:
        data = bpy.data.meshes.new(name)
        shape = bmesh.new()
        shape.loops.layers.uv.new("UVMap")
        bmesh.ops.create_cube(shape, size=1.0, calc_uvs=True)
        shape.to_mesh(data)
        shape.free()
        if material:
            data.materials.append(material)
    thing = link(bpy.data.objects.new(name, data), collection)
    thing.location = location
    return thing


def save(folder, name):
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / (name + ".blend")), check_existing=False)


# ---- Lights ---------------------------------------------------------------------------------------------------------


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


# ---- Materials ------------------------------------------------------------------------------------------------------


def new_material(name, node_type, **inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    node = tree.nodes.new(node_type)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for key, value in inputs.items():
        versions.input_of(node, key.replace("_", " ")).default_value = value
    return material, node


def checker():
    """Left half red, right half green, its upper half dark."""
    image = bpy.data.images.new("Checker", 4, 4)
    rows = []
    for y in range(4):
        for x in range(4):
            light = 1.0 if y < 2 else 0.5
            rows += [light if x < 2 else 0.0, 0.0 if x < 2 else light, 0.0, 1.0]
    image.pixels = rows
    image.pack()
    return image


def textured(name, node_type, image, socket="Color", mapping=False):
    material, node = new_material(name, node_type)
    tree = material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    texture.interpolation = "Closest"
    tree.links.new(texture.outputs["Color"], node.inputs[socket])
    if mapping:
        place, source = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
        place.inputs["Scale"].default_value = (2, 2, 1)
        tree.links.new(source.outputs["UV"], place.inputs["Vector"])
        tree.links.new(place.outputs["Vector"], texture.inputs["Vector"])
    return material


def mixed(name):
    material, node = new_material(name, "ShaderNodeMixShader")
    material.diffuse_color = (0.1, 0.2, 0.3, 1.0)
    return material


def bent(name, *nodes):
    """A Diffuse surface whose Normal is fed by a chain of nodes, the last one first: (type, what feeds it, settings).
    What feeds it is an image or the type of a node."""
    surface, shader = new_material(name, "ShaderNodeBsdfDiffuse")
    tree, socket = surface.node_tree, shader.inputs["Normal"]
    for kind, feed, settings in nodes:
        node = tree.nodes.new("ShaderNode" + kind)
        for key, value in settings.items():
            if key[0].isupper():
                node.inputs[key].default_value = value
            else:
                setattr(node, key, value)
        tree.links.new(node.outputs["Normal" if "Normal" in node.outputs else 0], socket)
        if isinstance(feed, str):
            source = tree.nodes.new("ShaderNode" + feed)
        elif feed is not None:
            source = tree.nodes.new("ShaderNodeTexImage")
            source.image = feed
        if feed is not None:
            tree.links.new(source.outputs["Color"], node.inputs["Height" if kind == "Bump" else "Color"])
        socket = node.inputs.get("Normal")
    return surface


def bent_materials(colors):
    numbers = bpy.data.images.new("Numbers", 4, 4, is_data=True)
    numbers.pixels.foreach_set([0.5, 0.25, 1.0, 1.0] * 16)
    numbers.pack()
    by_map = ("NormalMap", numbers, {"Strength": 0.5})
    every = [
        bent("BumpOnMap", ("Bump", numbers, {"Strength": 0.75, "Distance": 0.5, "invert": True}), by_map),
        bent("PaintedBump", ("Bump", colors, {}), ("NewGeometry", None, {})),
        bent("ObjectMap", ("NormalMap", numbers, {"space": "OBJECT"})),
        bent("NoBend", ("Bump", None, {}), ("NormalMap", None, {})),
        bent("NoiseOnMap", ("Bump", "TexNoise", {}), by_map),
        bent("TwoBumps", ("Bump", numbers, {}), ("Bump", colors, {})),
        bent("WorldMap", ("NormalMap", numbers, {"space": "WORLD"})),
        bent("PaintedMap", ("NormalMap", colors, {})),
        bent("Bevelled", ("Bevel", None, {})),
    ]
    tree = every[1].node_tree  # half the height, upside down: a factor of −½ and two constants
    for operation, inputs in (("MULTIPLY", (None, 0.5)), ("SUBTRACT", (1.0, None))):
        math = tree.nodes.new("ShaderNodeMath")
        math.operation = operation
        height = tree.nodes["Bump"].inputs["Height"]
        for socket, value in zip(math.inputs, inputs):
            if value is None:
                tree.links.new(height.links[0].from_socket, socket)
            else:
                socket.default_value = value
        tree.links.new(math.outputs[0], height)
    principled = textured("PrincipledBump", "ShaderNodeBsdfPrincipled", colors, "Base Color")
    tree = principled.node_tree
    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(tree.nodes["Image Texture"].outputs["Color"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], tree.nodes["Principled BSDF"].inputs["Normal"])
    return every + [principled]


def materials():
    image = checker()
    every = [
        new_material("Diffuse", "ShaderNodeBsdfDiffuse", Color=(0.2, 0.4, 0.8, 1))[0],
        new_material("Glossy", "ShaderNodeBsdfGlossy", Color=(0.9, 0.7, 0.3, 1), Roughness=0.3)[0],
        new_material("Sharp", "ShaderNodeBsdfGlossy", Color=(1, 1, 1, 1), Roughness=0.3)[0],
        new_material("Emission", "ShaderNodeEmission", Color=(1.0, 0.5, 0.25, 1), Strength=4.0)[0],
        new_material("Principled", "ShaderNodeBsdfPrincipled", Base_Color=(0.3, 0.6, 0.9, 1), Metallic=0.25,
                     Roughness=0.35, Emission=(0.5, 0.25, 0.0, 1), Emission_Strength=3.0)[0],
        new_material("Waxy", "ShaderNodeBsdfPrincipled", Subsurface=0.3)[0],
        textured("DiffuseTextured", "ShaderNodeBsdfDiffuse", image),
        textured("GlossyTextured", "ShaderNodeBsdfGlossy", image, mapping=True),
        textured("EmissionTextured", "ShaderNodeEmission", image),
        textured("PrincipledTextured", "ShaderNodeBsdfPrincipled", image, "Base Color"),
        new_material("Seen", "ShaderNodeBsdfDiffuse")[0],
        new_material("Noisy", "ShaderNodeBsdfDiffuse", Color=(0.5, 0.25, 0.75, 1))[0],
        mixed("Mixed"),
        bpy.data.materials.new("Plain"),
        new_material("Unlinked", "ShaderNodeBsdfDiffuse")[0],
        new_material("Rough", "ShaderNodeBsdfDiffuse", Roughness=0.6)[0],
        *bent_materials(image),
    ]
    by_name = {material.name: material for material in every}
    sharp = by_name["Sharp"].node_tree.nodes["Glossy BSDF"]
    if bpy.app.version < (4, 0):
        sharp.distribution = "SHARP"
    else:  # which has roughness 0 in its place
        sharp.inputs["Roughness"].default_value = 0.0
    by_name["EmissionTextured"].node_tree.nodes["Emission"].inputs["Strength"].default_value = 2.0
    by_name["Plain"].diffuse_color = (0.7, 0.6, 0.5, 1.0)
    by_name["Diffuse"].use_backface_culling = True
    by_name["Unlinked"].node_tree.links.clear()
    painted = by_name["Seen"].node_tree
    attribute = painted.nodes.new("ShaderNodeVertexColor")
    attribute.layer_name = "Paint"
    painted.links.new(attribute.outputs["Color"], painted.nodes["Diffuse BSDF"].inputs["Color"])
    noisy = by_name["Noisy"].node_tree
    noisy.links.new(noisy.nodes.new("ShaderNodeTexNoise").outputs["Color"], noisy.nodes["Diffuse BSDF"].inputs["Color"])
    for number, material in enumerate(every):
        cube("On" + material.name, (2.0 * number, 0, 0), material)
    two = bpy.data.objects["OnBumpOnMap"].data  # the exporter writes an attribute for it, and must keep both materials
    two.materials.append(by_name["Glossy"])
    two.polygons[0].material_index = 1
    for name in ("OnSeen", "OnDiffuse"):  # the same colours; only one material reads them
        data = bpy.data.objects[name].data
        for layer in ("Other", "Paint"):
            paint = data.color_attributes.new(layer, "FLOAT_COLOR", "POINT")
            for i in range(len(data.vertices)):
                paint.data[i].color = (0.25, 0.5, 0.75, 1.0) if layer == "Paint" else (1, 0, 0, 1)
    cube("OnNothing", (-2, 0, 0))
    by_name["Glossy"].pass_index = 7
    return {}


# ---- Objects --------------------------------------------------------------------------------------------------------


def objects():
    scene = bpy.context.scene
    plain = new_material("Grey", "ShaderNodeBsdfDiffuse")[0]
    plain["scumble_style"] = "rendered"
    one = cube("One", (0, 0, 0), plain)
    one.pass_index = 5
    one["scumble_style"] = "oil"
    cube("Two", (3, 0, 0), data=one.data)
    cube("Mirrored", (6, 0, 0), data=one.data).scale = (-1, 1, 1)
    stretched = cube("Stretched", (9, 0, 0), data=one.data)
    stretched.scale = (1, 2, 0.5)
    stretched.rotation_euler = Euler((0, 0, 0.7))
    sheared = cube("Sheared", (0.5, 0.5, 0.25), plain)
    sheared.parent = stretched
    sheared.rotation_euler = Euler((0.3, 0.5, 0.2))
    cube("Hidden", (0, 5, 0), plain).hide_render = True
    only_viewport = cube("ViewportHidden", (3, 5, 0), plain)
    only_viewport.hide_viewport = True
    unrendered = bpy.data.collections.new("Unrendered")
    scene.collection.children.link(unrendered)
    unrendered.hide_render = True
    cube("InHidden", (6, 5, 0), plain, unrendered)
    smooth = cube("Smooth", (0, 8, 0), plain)
    modifier = smooth.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 0, 2
    rows = cube("Rows", (3, 8, 0), plain).modifiers.new("Array", "ARRAY")
    rows.count = 3
    off = cube("Off", (12, 8, 0), plain).modifiers.new("Array", "ARRAY")
    off.show_render = False
    group = bpy.data.collections.new("Group")
    cube("Member", (0, 0, 1), plain, group)
    for name, x in (("First", 0.0), ("Second", 4.0)):
        instancer = link(bpy.data.objects.new(name, None))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", group
        instancer.location, instancer.rotation_euler = (x, 12, 0), Euler((0, 0, 0.5))
    mover = cube("Mover", (0, 16, 0), plain)
    for frame, x in ((1, 0.0), (11, 10.0)):
        mover.location.x = x
        mover.keyframe_insert("location", index=0, frame=frame)
    for curve in versions.action_curves(mover):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    shaped = cube("Shaped", (3, 16, 0), plain)
    shaped.shape_key_add(name="Basis")
    shaped.shape_key_add(name="Up").data[0].co.z -= 2.0
    shaped.data.shape_keys.key_blocks["Up"].value = 0.5
    text = link(bpy.data.objects.new("Words", bpy.data.curves.new("Words", "FONT")))
    text.data.body, text.location = "A", (6, 16, 0)
    more = link(bpy.data.objects.new("MoreWords", text.data))  # the same text, other triangles
    more.location = (12, 16, 0)
    more.modifiers.new("Array", "ARRAY").count = 2
    scatter = cube("Scatter", (0, 20, 0), plain)
    cube("Leaf", (0, 0, 0), plain).parent = scatter
    scatter.instance_type = "VERTS"
    scatter.show_instancer_for_render = False
    link(bpy.data.objects.new("Smoke", bpy.data.volumes.new("Smoke"))).location = (9, 16, 0)
    scene.frame_set(1)
    result = {"1": bounds()}
    scene.frame_set(6)
    result["6"] = bounds()
    scene.frame_set(1)
    return result


def twisted_grid(location, material):
    """2 m wide, of 256 flat quads, plane at frame 1: a shape key turns each vertex about the y axis by y radians."""
    data, shape = bpy.data.meshes.new("Twisted"), bmesh.new()
    bmesh.ops.create_grid(shape, x_segments=16, y_segments=16, size=1.0)
    shape.to_mesh(data)
    shape.free()
    data.materials.append(material)
    thing = link(bpy.data.objects.new("Twisted", data))
    thing.location = location
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="Twist")
    for vertex in key.data:
        vertex.co = (vertex.co.x * math.cos(vertex.co.y), vertex.co.y, vertex.co.x * math.sin(vertex.co.y))
    for frame, value in ((1, 0.0), (6, 0.5)):
        key.value = value
        key.keyframe_insert("value", frame=frame)


def deformed():
    """Bent by a modifier behind one that adds vertices, and by a shape key; both move from frame 1 to 6."""
    plain = new_material("Grey", "ShaderNodeBsdfDiffuse")[0]
    cube("Plain", (0, 0, 0), plain)
    bent = cube("Bent", (4, 0, 0), plain)
    bent.scale = (1, 1, 2)
    bent.modifiers.new("Array", "ARRAY").count = 3
    bend = bent.modifiers.new("Bend", "SIMPLE_DEFORM")
    bend.deform_method = "BEND"
    for frame, angle in ((1, 0.3), (6, 1.2)):
        bend.angle = angle
        bend.keyframe_insert("angle", frame=frame)
    shaped = cube("Shaped", (0, 4, 0), plain)
    shaped.shape_key_add(name="Basis")
    key = shaped.shape_key_add(name="Up")
    for vertex in key.data:
        vertex.co.z += 2.0 * vertex.co.x
    for frame, value in ((1, 0.0), (6, 0.75)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    shaped.data.attributes.new("other", "FLOAT", "CORNER")
    twisted_grid((0, 0, 6), plain)
    bpy.context.scene.frame_set(1)
    return None


def bounds():
    """Names, triangles, and corners of the boxes in Blender's world, as the render has them: evaluated with the
    render's modifiers set by hand, independently of the export."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    smooth, off = bpy.data.objects["Smooth"].modifiers[0], bpy.data.objects["Off"].modifiers[0]
    smooth.levels, off.show_viewport = 2, False
    bpy.data.objects["ViewportHidden"].hide_viewport = False
    layer.update()
    graph, result = bpy.context.evaluated_depsgraph_get(), {}
    for instance in graph.object_instances:
        name = instance.object.original.name
        if name in {"Hidden", "InHidden", "Strands"} or (name in {"Scatter", "Leaf"} and not instance.is_instance):
            continue
        if instance.object.type not in {"MESH", "FONT"} or (name.endswith("Words") and instance.is_instance):
            continue  # the text's mesh is listed again behind the text
        mesh = instance.object.to_mesh()
        points = [instance.matrix_world @ vertex.co for vertex in mesh.vertices]
        mesh.calc_loop_triangles()
        key = (instance.parent.original.name + "/" if instance.is_instance else "") + name
        entry = result.setdefault(key, {"triangles": 0, "low": [1e9] * 3, "high": [-1e9] * 3})
        entry["triangles"] += len(mesh.loop_triangles)
        for point in points:
            entry["low"] = [min(a, b) for a, b in zip(entry["low"], point)]
            entry["high"] = [max(a, b) for a, b in zip(entry["high"], point)]
        instance.object.to_mesh_clear()
    smooth.levels, off.show_viewport = 0, True
    bpy.data.objects["ViewportHidden"].hide_viewport = True
    layer.update()
    return result


# ---- Cameras --------------------------------------------------------------------------------------------------------


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


# ---- Visible to Cycles ----------------------------------------------------------------------------------------------


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


# ---- Files that lack something --------------------------------------------------------------------------------------


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


CASES = {"lamps": lamps, "materials": materials, "objects": objects, "deformed": deformed, "cameras": cameras,
         "rendered": rendered, "bordered": bordered, "layers": layers, "panorama": panorama}
FILES = {"broken": broken, "old": old}  # these write their files themselves


def main():
    parser = argparse.ArgumentParser(prog="make_cases.py", description="Makes the scenes of export_test.cpp.")
    parser.add_argument("--output", required=True, type=Path)
    folder = parser.parse_args(sys.argv[sys.argv.index("--") + 1:]).output
    expected = {}
    for name, build in CASES.items():
        clear()
        expected[name] = build()
        save(folder, name)
    for name, build in FILES.items():
        expected[name] = build(folder)
    (folder / "expected.json").write_text(json.dumps(expected))


if __name__ == "__main__":
    try:
        main()
    except Exception:
        traceback.print_exc()
        sys.exit(1)
