"""Makes the scenes of crosscheck_blender_test.cpp: room.blend, scatter.blend, crooked.blend.

    blender -b -noaudio --factory-startup -P tests/blender/make_crosscheck.py -- FOLDER
"""

import sys
import traceback
from pathlib import Path

import math
import bmesh
import bpy
from mathutils import Euler, Vector


def material(name, kind, color, roughness=0.0):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new(kind)
    shader.inputs["Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    if kind == "ShaderNodeBsdfGlossy":
        shader.distribution = "GGX"
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def mesh(name, build, location, made, smooth=False):
    data = bpy.data.meshes.new(name)
    shape = bmesh.new()
    build(shape)
    for face in shape.faces:
        face.smooth = smooth
    shape.to_mesh(data)
    shape.free()
    data.materials.append(made)
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    return thing


def room():
    """A box that moves, a sphere of metal, a point light."""
    scene = bpy.context.scene
    floor = material("Floor", "ShaderNodeBsdfDiffuse", (0.7, 0.6, 0.5))
    red = material("Red", "ShaderNodeBsdfDiffuse", (0.8, 0.2, 0.1))
    metal = material("Metal", "ShaderNodeBsdfGlossy", (0.9, 0.8, 0.6), 0.5)
    mesh("Floor", lambda b: bmesh.ops.create_grid(b, x_segments=1, y_segments=1, size=3.0), (0, 0, 0), floor)
    mesh("Ball", lambda b: bmesh.ops.create_uvsphere(b, u_segments=96, v_segments=48, radius=0.7), (-0.8, 0, 0.7),
         metal, True)
    box = mesh("Box", lambda b: bmesh.ops.create_cube(b, size=1.0), (0.8, 0.2, 0.5), red)
    for frame, x in ((1, 0.8), (5, 1.4)):
        box.location.x = x
        box.keyframe_insert("location", frame=frame)
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy, lamp.shadow_soft_size = 300.0, 0.3
    link(bpy.data.objects.new("Lamp", lamp)).location = (1.5, -2.0, 3.0)
    scene.camera = camera("Camera")
    scene.frame_set(1)


def camera(name, x=0.0):
    thing = link(bpy.data.objects.new(name, bpy.data.cameras.new(name)))
    thing.location = (x, -5.0, 2.4)
    thing.rotation_euler = Euler((1.2, 0.0, 0.0))
    return thing


def link(thing, collection=None):
    (collection or bpy.context.scene.collection).objects.link(thing)
    return thing


def collection_of(name, *things):
    """A collection of its own, beside the scene's."""
    made = bpy.data.collections.new(name)
    for thing in things:
        bpy.context.scene.collection.objects.unlink(thing)
        made.objects.link(thing)
    return made


def cubes_on_points(name, instance, generated):
    """Geometry nodes that put an object, or a cube that they make up themselves, on each of a mesh's corners, and keep
    the mesh."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    tree.inputs.new("NodeSocketGeometry", "Geometry")
    tree.outputs.new("NodeSocketGeometry", "Geometry")
    source, target = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    points, joined = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeJoinGeometry")
    if generated is None:
        node = tree.nodes.new("GeometryNodeObjectInfo")
        node.inputs["Object"].default_value, node.inputs["As Instance"].default_value = instance, True
        tree.links.new(node.outputs["Geometry"], points.inputs["Instance"])
    else:
        node, paint = tree.nodes.new("GeometryNodeMeshCube"), tree.nodes.new("GeometryNodeSetMaterial")
        node.inputs["Size"].default_value = (0.15, 0.15, 0.15)
        paint.inputs["Material"].default_value = generated
        tree.links.new(node.outputs["Mesh"], paint.inputs["Geometry"])
        tree.links.new(paint.outputs["Geometry"], points.inputs["Instance"])
    tree.links.new(source.outputs[0], points.inputs["Points"])
    for part in (points.outputs[0], source.outputs[0]):
        tree.links.new(part, joined.inputs[0])
    tree.links.new(joined.outputs[0], target.inputs[0])
    return tree


def plane(size):
    return lambda b: bmesh.ops.create_grid(b, x_segments=2, y_segments=2, size=size)


def box(size):
    return lambda b: bmesh.ops.create_cube(b, size=size)


def scatter():
    """Every kind of instance, a linked object with the name of a local one, an object for indirect light only, and two
    cameras of which none is active."""
    red, grey = (material(name, "ShaderNodeBsdfDiffuse", color)
                 for name, color in (("Red", (0.8, 0.2, 0.1)), ("Grey", (0.5, 0.5, 0.5))))
    same = mesh("Same", box(0.5), (0, 0, 0), red)
    library = output("library.blend")
    bpy.data.libraries.write(library, {same})
    same.location = (-1.6, -1.2, 0.3)
    with bpy.data.libraries.load(library, link=True) as (_, wanted):
        wanted.objects = ["Same"]
    link(wanted.objects[0])
    mesh("Floor", plane(3.0), (0, 0, -0.3), grey)
    pebble = mesh("Pebble", box(0.12), (2.2, -1.2, 0.0), red)

    made_up = mesh("MadeUp", plane(0.4), (-1.6, 0, 0.2), grey)
    made_up.modifiers.new("Nodes", "NODES").node_group = cubes_on_points("MadeUp", None, red)
    placed = mesh("Placed", plane(0.4), (0, 0, 0.2), grey)
    placed.modifiers.new("Nodes", "NODES").node_group = cubes_on_points("Placed", pebble, None)
    group = collection_of("Group", placed)
    for number in range(2):
        instancer = link(bpy.data.objects.new(f"Group{number}", None))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", group
        instancer.location, instancer.scale = (1.4 * number - 0.4, 0.6, 0.3), (1.0, 1.0 + number, 1.0)
    corners = mesh("Corners", plane(0.4), (1.6, -0.6, 0.2), grey)
    mesh("Leaf", box(0.15), (0, 0, 0), red).parent = corners
    corners.instance_type, corners.show_instancer_for_render = "VERTS", False
    bristles = mesh("Bristles", plane(0.5), (0, -1.2, 0.2), grey)
    bristles.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = bristles.particle_systems[0].settings
    settings.type, settings.count, settings.render_type, settings.instance_object = "HAIR", 9, "OBJECT", pebble
    settings.emit_from, settings.use_emit_random = "VERT", False  # apart: faces that coincide have no one name
    settings.use_advanced_hair, settings.particle_size = True, 1.0

    unseen = collection_of("Unseen", mesh("Unseen", box(0.8), (0.6, -2.0, 0.6), red))
    bpy.context.scene.collection.children.link(unseen)
    bpy.context.view_layer.layer_collection.children["Unseen"].indirect_only = True
    camera("Zero", 1.0)
    camera("Aside")
    bpy.context.scene.camera = None


def crooked():
    """A camera on a mirrored rig, a holdout, a texture that is lost, and a material override."""
    rig = link(bpy.data.objects.new("Rig", None))
    rig.scale = (-1, 1, 1)
    bpy.context.scene.camera = camera("Camera", 0.3)
    bpy.context.scene.camera.parent = rig
    lost = material("Lost", "ShaderNodeBsdfDiffuse", (1, 1, 1))
    texture = lost.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("Gone", 4, 4)
    texture.image.source, texture.image.filepath = "FILE", "//gone.png"
    lost.node_tree.links.new(texture.outputs["Color"], lost.node_tree.nodes["Diffuse BSDF"].inputs["Color"])
    mesh("Floor", plane(2.0), (0, 0, 0), lost)
    held = collection_of("Held", mesh("Hole", box(0.5), (0.8, 0, 0.4), lost))
    bpy.context.scene.collection.children.link(held)
    bpy.context.view_layer.layer_collection.children["Held"].holdout = True
    bpy.context.view_layer.material_override = material("Clay", "ShaderNodeBsdfDiffuse", (0.5, 0.5, 0.5))


def shapes():
    """Every type of object that is evaluated to a mesh, and every way in which Blender makes normals."""
    grey = material("Grey", "ShaderNodeBsdfDiffuse", (0.5, 0.5, 0.5))
    places = [(1.5 * (i % 5) - 3.0, 0.0, 1.5 * (i // 5)) for i in range(15)]

    def put(thing):
        if thing.data.materials is not None and not thing.data.materials:
            thing.data.materials.append(grey)
        thing.location = places.pop(0)
        thing.rotation_euler = Euler((0.3, 0.2, 0.4))
        return thing

    def data_object(name, data):
        return put(link(bpy.data.objects.new(name, data)))

    balls = bpy.data.metaballs.new("Balls")
    balls.resolution, balls.render_resolution = 0.4, 0.15
    for x, radius in ((-0.25, 0.6), (0.3, 0.5)):
        element = balls.elements.new()
        element.co, element.radius = (x, 0, 0), radius
    data_object("Balls", balls)

    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.size, text.extrude, text.bevel_depth, text.bevel_resolution = "S8", 1.1, 0.1, 0.04, 3
    text.align_x = text.align_y = "CENTER"
    data_object("Text", text)

    tube = bpy.data.curves.new("Tube", "CURVE")
    tube.dimensions, tube.bevel_depth, tube.bevel_resolution, tube.use_fill_caps = "3D", 0.15, 2, True
    tube.resolution_u, tube.render_resolution_u = 3, 6
    spline = tube.splines.new("BEZIER")
    spline.bezier_points.add(2)
    for point, at in zip(spline.bezier_points, ((-0.5, 0, -0.2), (0, 0, 0.4), (0.5, 0.2, -0.2))):
        point.co, point.handle_left_type, point.handle_right_type = at, "AUTO", "AUTO"
    data_object("Tube", tube)

    sign = bpy.data.curves.new("Sign", "CURVE")
    sign.dimensions, sign.extrude, sign.fill_mode = "2D", 0.2, "BOTH"
    spline = sign.splines.new("NURBS")
    spline.points.add(5)
    for number, point in enumerate(spline.points):
        turn = number * math.pi / 3
        point.co = (0.6 * math.cos(turn), 0.6 * math.sin(turn), 0, 1)
    spline.use_cyclic_u, spline.order_u = True, 3
    data_object("Sign", sign)

    sheet = bpy.data.curves.new("Sheet", "SURFACE")
    sheet.dimensions = "3D"
    data = data_object("Sheet", sheet)
    for row in range(4):
        spline = sheet.splines.new("NURBS")
        spline.points.add(3)
        for number, point in enumerate(spline.points):
            point.co = (0.4 * number - 0.6, 0.4 * row - 0.6, 0.5 * ((row + number) % 2), 1)
            point.select = True
    bpy.context.view_layer.objects.active = data
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.curve.make_segment()
    bpy.ops.object.mode_set(mode="OBJECT")
    for spline in sheet.splines:
        spline.use_endpoint_u = spline.use_endpoint_v = True

    # Smooth and flat faces of one mesh: bent quads, which Cycles cuts in two.
    def bent(shape):
        bmesh.ops.create_uvsphere(shape, u_segments=12, v_segments=8, radius=0.6)
        for number, vertex in enumerate(shape.verts):
            vertex.co *= 1.0 + 0.15 * ((number * 7) % 5 - 2) / 2
    for name, smooth in (("Bent", False), ("Soft", True)):
        put(mesh(name, bent, (0, 0, 0), grey, smooth))

    # Auto smooth, with sharp edges and with normals of its own.
    def can(shape):
        bmesh.ops.create_cone(shape, cap_ends=True, segments=12, radius1=0.6, radius2=0.5, depth=0.9)
    for name in ("Auto", "Own", "Hard"):
        thing = put(mesh(name, can, (0, 0, 0), grey, True))
        thing.data.use_auto_smooth, thing.data.auto_smooth_angle = True, 0.7
        if name == "Own":
            thing.data.normals_split_custom_set_from_vertices(
                [(v.co + Vector((0, 0, 0.5 * math.sin(9 * v.co.x)))).normalized() for v in thing.data.vertices])
        if name == "Hard":
            bevel = thing.modifiers.new("Bevel", "BEVEL")
            bevel.width, bevel.segments, bevel.harden_normals = 0.12, 2, True
            thing.modifiers.new("Weighted", "WEIGHTED_NORMAL").keep_sharp = True

    # Modifiers that only the render has, or only the viewport.
    thing = put(mesh("Rendered", box(0.9), (0, 0, 0), grey, True))
    subdivision = thing.modifiers.new("Subdivision", "SUBSURF")
    subdivision.show_viewport, subdivision.levels, subdivision.render_levels = False, 0, 2
    hidden = thing.modifiers.new("Hidden", "SIMPLE_DEFORM")
    hidden.show_render, hidden.angle = False, 2.0
    thing = put(mesh("Thick", lambda b: bmesh.ops.create_grid(b, x_segments=4, y_segments=4, size=0.5), (0, 0, 0), grey,
                     True))
    thing.modifiers.new("Solid", "SOLIDIFY").thickness = 0.2
    wave = thing.modifiers.new("Cast", "CAST")
    wave.factor = 0.5

    # Curves and metaballs with several users, one of them stretched.
    second = put(link(bpy.data.objects.new("Tube2", tube)))
    second.scale = (1.0, 0.6, 1.4)
    scene = bpy.context.scene
    scene.camera = link(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 7.8
    scene.camera.location, scene.camera.rotation_euler = (0, -10, 1.5), Euler((math.pi / 2, 0, 0))


def output(name):
    return str(Path(sys.argv[sys.argv.index("--") + 1]) / name)


def main():
    for build in (shapes,):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        build()
        bpy.ops.wm.save_as_mainfile(filepath=output(build.__name__ + ".blend"))


if __name__ == "__main__":
    try:
        main()
    except Exception:  # Blender itself would print the traceback and exit with 0
        traceback.print_exc()
        sys.exit(1)
