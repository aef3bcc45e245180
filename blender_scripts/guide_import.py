"""A glTF scene in Blender, lit and seen as guidegen understands it: part of render_guides.py.

Blender's importer brings meshes, materials and punctual lights (cd · 4π / 683 watts, lux / 683). This completes it: what
export_scene.py wrote into `extras.scumble`, the cones of KHR_lights_punctual, the pictures' proportions that cameras are
made for, matrices with shear, alpha cut-offs and back faces that cameras do not see.
"""

import math
import sys

import bpy
from mathutils import Matrix, Quaternion, Vector

import guide_camera
from guide_materials import feed, math as math_node, take_over

LUMENS_PER_WATT = 683.0
IGNORED_MATERIALS = {"KHR_materials_unlit", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_sheen"}


class Import:
    """What the importer knew when the nodes were made."""
    gltf = None

    def gather_import_scene_after_nodes_hook(self, *arguments):
        Import.gltf = arguments[-1]


def load(path, size, unsupported):
    """`size` is the picture's, in pixels."""
    import numpy
    if not hasattr(numpy, "bool"):
        numpy.bool = bool  # Debian's numpy has dropped an alias that the importer of 3.4 still uses
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon = sys.modules["io_scene_gltf2"]
    addon.glTF2ImportUserExtension = Import
    try:
        bpy.ops.import_scene.gltf(filepath=path, import_shading="NORMALS", merge_vertices=False)
    finally:
        del addon.glTF2ImportUserExtension
    gltf = Import.gltf
    if gltf is None:
        raise ValueError("Blender imported nothing")
    for thing in bpy.data.objects:
        thing.animation_data_clear()  # guidegen sees nodes as they stand
    worlds = world_matrices(gltf.data)
    cameras = []
    for index, world in worlds.items():
        complete_node(gltf, index, world, size[0] / size[1], cameras, unsupported)
    scene = bpy.context.scene
    scene.camera = cameras[0] if cameras else None
    complete_world(gltf, scene)
    for material in gltf.data.materials or []:
        complete_material(material, unsupported)


# ---- Nodes ----------------------------------------------------------------------------------------------------------


def ours(extras):
    """What stands in extras.scumble, or nothing."""
    found = extras.get("scumble") if isinstance(extras, dict) else None
    return found if isinstance(found, dict) else {}


def local_matrix(node):
    if node.matrix:
        return Matrix([node.matrix[row::4] for row in range(4)])
    x, y, z, w = node.rotation or (0.0, 0.0, 0.0, 1.0)
    return Matrix.LocRotScale(Vector(node.translation or (0.0, 0.0, 0.0)), Quaternion((w, x, y, z)).normalized(),
                              Vector(node.scale or (1.0, 1.0, 1.0)))


def world_matrices(document):
    """glTF's world matrix by node, depth first, in the file's order."""
    chosen = document.scenes[document.scene or 0].nodes if document.scenes else None
    if chosen is None:
        children = {child for node in document.nodes or [] for child in node.children or []}
        chosen = [index for index in range(len(document.nodes or [])) if index not in children]
    worlds = {}
    pending = [(index, Matrix()) for index in reversed(chosen)]
    while pending:
        index, parent = pending.pop()
        node = document.nodes[index]
        worlds[index] = parent @ local_matrix(node)
        pending += [(child, worlds[index]) for child in reversed(node.children or [])]
    return worlds


def objects_of(gltf, index):
    """The Blender objects of a node by type; a node with two roles has a child for the second."""
    found = {}
    vnodes = [gltf.vnodes.get(index)] + [v for v in gltf.vnodes.values() if index in (v.camera_node_idx, v.light_node_idx)]
    for vnode in vnodes:
        thing = getattr(vnode, "blender_object", None)
        if thing is not None:
            found.setdefault(thing.type, thing)
    return found


def complete_node(gltf, index, world, aspect, cameras, unsupported):
    node = gltf.data.nodes[index]
    things = objects_of(gltf, index)
    extras = ours(node.extras)
    place = guide_camera.GLTF_FROM_BLENDER.transposed() @ world
    if "MESH" in things:
        place_mesh(things["MESH"], place @ guide_camera.GLTF_FROM_BLENDER, unsupported)
    if "CAMERA" in things:
        put(things["CAMERA"], guide_camera.rigid(place))
        fit_camera(things["CAMERA"].data, gltf.data.cameras[node.camera], aspect, extras.get("camera"))
        cameras.append(things["CAMERA"])
    lamp = things.get("LIGHT")
    if "lamp" in extras:
        lamp = replace_lamp(lamp, node.name or "Lamp", extras["lamp"])
    elif lamp is not None:
        light = gltf.data.extensions["KHR_lights_punctual"]["lights"][node.extensions["KHR_lights_punctual"]["light"]]
        lamp.data = lamp.data.copy()
        use_punctual(lamp.data, light, guide_camera.rigid(place).col[2].to_3d())
    if lamp is not None:
        put(lamp, guide_camera.rigid(place))


def put(thing, matrix):
    thing.parent = None
    thing.matrix_world = matrix


def place_mesh(thing, expected, unsupported):
    """The importer takes matrices apart into place, turn and scale, which loses shear: a parent brings it back."""
    bpy.context.view_layer.update()
    size = max(abs(value) for row in expected for value in row)
    difference = max(abs(a - b) for ours_, theirs in zip(expected, thing.matrix_world) for a, b in zip(ours_, theirs))
    if difference <= 1e-5 * size:
        return
    if any(modifier.type == "ARMATURE" for modifier in thing.modifiers):
        unsupported.add(f"object '{thing.name}': is moved by a skeleton, which guidegen ignores")
        return
    anchor = bpy.data.objects.new("scumble.shear", None)
    bpy.context.scene.collection.objects.link(anchor)
    thing.parent = anchor
    thing.matrix_parent_inverse = expected
    thing.matrix_basis = Matrix()


# ---- Cameras --------------------------------------------------------------------------------------------------------


def fit_camera(camera, lens, aspect, extras):
    """Sensor fit, angle and shift as guidegen reads them: the vertical extent is kept, unless the file's proportions are
    wider than the picture's; the importer does not know the latter."""
    camera.shift_x = camera.shift_y = 0.0
    if extras:
        camera.sensor_fit = extras["sensor_fit"]
        camera.shift_x, camera.shift_y = extras["shift_x"], extras["shift_y"]
        extent, side = (extras["ortho_scale"] if camera.type == "ORTHO" else extras["angle"]), None
    elif camera.type == "ORTHO":
        side = abs(lens.orthographic.xmag) / abs(lens.orthographic.ymag)
        extent = 2.0 * abs(lens.orthographic.ymag)
        if side > aspect:
            extent *= side
    else:
        side = lens.perspective.aspect_ratio
        extent = lens.perspective.yfov
        if side and side > aspect:
            extent = 2.0 * math.atan(math.tan(extent / 2.0) * side)
    if not extras:
        camera.sensor_fit = "HORIZONTAL" if side and side > aspect else "VERTICAL"
    if camera.type == "ORTHO":
        camera.ortho_scale = extent
        return
    # `angle` heeds the sensor's longer side; the fitted side must be the one that it measures.
    camera.lens_unit = "FOV"
    camera.sensor_width = camera.sensor_height = 36.0
    camera.angle = extent


# ---- Lamps and world ------------------------------------------------------------------------------------------------


def replace_lamp(old, name, extras):
    """The lamp that export_scene.py described; area lamps come as empties."""
    lamp = bpy.data.lights.new(name, extras["type"])
    most = max(max(extras["color"]), 1.0)
    lamp.color = [value / most for value in extras["color"]]
    lamp.energy = extras["energy"] * most
    if extras["type"] in {"POINT", "SPOT"}:
        lamp.shadow_soft_size = extras["radius"]
    if extras["type"] == "SPOT":
        lamp.spot_size, lamp.spot_blend = extras["spot_size"], extras["spot_blend"]
    elif extras["type"] == "SUN":
        lamp.angle = extras["angle"]
    elif extras["type"] == "AREA":
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
    """Lights of KHR_lights_punctual have no extent. Their cones have no cosine and another edge than Cycles' spots, so a
    spot becomes a point lamp whose nodes make that cone."""
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
    lamp.use_nodes = True
    tree = lamp.node_tree
    tree.nodes.clear()
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    dot = tree.nodes.new("ShaderNodeVectorMath")
    dot.operation = "DOT_PRODUCT"
    tree.links.new(geometry.outputs["Incoming"], dot.inputs[0])
    dot.inputs[1].default_value = -backward  # Incoming points from the lamp to what it lights
    scale = 1.0 / max(0.001, inner - outer)
    linear = math_node(tree, "MULTIPLY_ADD", dot.outputs["Value"], scale)
    linear.node.inputs[2].default_value = -outer * scale
    linear.node.use_clamp = True
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(math_node(tree, "MULTIPLY", linear, linear), emission.inputs["Strength"])
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


# ---- Materials ------------------------------------------------------------------------------------------------------


def complete_material(source, unsupported):
    for extension in sorted(IGNORED_MATERIALS & set(source.extensions or {})):
        unsupported.add(f"material '{source.name}': {extension} is shaded otherwise by Blender than here")
    for name in source.blender_material.values():
        material = bpy.data.materials[name]
        tree = material.node_tree
        mend_emission(tree)
        principled = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
        bsdf = ours(source.extras).get("bsdf")
        if principled is not None and isinstance(bsdf, dict):
            apply_bsdf(tree, principled, bsdf)
        if not source.double_sided:
            hide_back(tree)


def mend_emission(tree):
    """The importer of 3.4 links its factor's node by the wrong output."""
    for node in tree.nodes:
        if node.type == "MIX" and node.label == "Emissive Factor":
            for link in list(node.outputs[0].links):
                tree.links.new(node.outputs[2], link.to_socket)


def tint(tree, socket, color):
    """Base colour: texture and vertex colours as imported, times the colour."""
    if not socket.is_linked:
        socket.default_value = (*color, 1.0)
        return
    source = socket.links[0].from_socket
    if source.node.label == "Color Factor":
        source.node.inputs[7].default_value = (*color, 1.0)
        return
    factor = tree.nodes.new("ShaderNodeMixRGB")
    factor.blend_type = "MULTIPLY"
    factor.inputs["Fac"].default_value = 1.0
    tree.links.new(source, factor.inputs["Color1"])
    factor.inputs["Color2"].default_value = (*color, 1.0)
    tree.links.new(factor.outputs[0], socket)


def apply_bsdf(tree, principled, bsdf):
    tint(tree, principled.inputs["Base Color"], bsdf["color"])
    if bsdf["type"] == "PRINCIPLED":
        for key, name in (("roughness", "Roughness"), ("metallic", "Metallic")):
            if bsdf.get(key) is not None and not principled.inputs[name].is_linked:
                principled.inputs[name].default_value = bsdf[key]
        if bsdf.get("emission") is not None and not principled.inputs["Emission"].is_linked:
            principled.inputs["Emission"].default_value = (*bsdf["emission"], 1.0)
            principled.inputs["Emission Strength"].default_value = 1.0
        return
    kind = {"DIFFUSE": "ShaderNodeBsdfDiffuse", "GLOSSY": "ShaderNodeBsdfGlossy", "EMISSION": "ShaderNodeEmission"}
    shader = tree.nodes.new(kind[bsdf["type"]])
    feed(tree, shader.inputs["Color"], principled.inputs["Base Color"])
    if bsdf["type"] == "EMISSION":
        shader.inputs["Strength"].default_value = bsdf["strength"]
    else:
        if bsdf["type"] == "GLOSSY":
            shader.distribution = "GGX"
        shader.inputs["Roughness"].default_value = bsdf["roughness"] if bsdf["type"] == "GLOSSY" else 0.0
        if principled.inputs["Normal"].is_linked:
            feed(tree, shader.inputs["Normal"], principled.inputs["Normal"])
    take_over(tree, principled.outputs[0], shader.outputs[0])
    tree.nodes.remove(principled)


def hide_back(tree):
    """A surface that glTF calls one-sided has no back to the camera; other rays meet both of its sides."""
    output = next((node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"), None)
    if output is None or not output.inputs["Surface"].is_linked:
        return
    surface = output.inputs["Surface"].links[0].from_socket
    side = tree.nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"]
    seen = tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"]
    choice = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(math_node(tree, "MULTIPLY", side, seen), choice.inputs[0])
    tree.links.new(surface, choice.inputs[1])
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], choice.inputs[2])
    tree.links.new(choice.outputs[0], output.inputs["Surface"])
