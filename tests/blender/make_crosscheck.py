"""Makes the scenes of crosscheck_test.cpp: room, scatter, crooked, keyed, keyed_scatter and simplified.blend.

    blender -b -noaudio --factory-startup -P tests/blender/make_crosscheck.py -- FOLDER
"""

import sys
import traceback
from pathlib import Path

import bmesh
import bpy
from mathutils import Euler

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import versions  # noqa: E402  (Blender does not put a script's own folder on the path)


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
    tree = versions.geometry_nodes(name)
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


def draw_lines():
    """Grease pencil before the camera, whose visibility is animated."""
    known = {item.identifier for item in bpy.types.Object.bl_rna.properties["type"].enum_items}
    if "GREASEPENCIL" in known and hasattr(bpy.ops.object, "grease_pencil_add") and bpy.app.version >= (4, 3):
        bpy.ops.object.grease_pencil_add(type="MONKEY", location=(0, 0, 0.7))
    else:
        bpy.ops.object.gpencil_add(type="MONKEY", location=(0, 0, 0.7))
    lines = bpy.context.object
    lines.scale = (2, 2, 2)
    lines.keyframe_insert("hide_render", frame=1)


def keyed():
    """Two cameras bound to markers, animation and a driver of settings that the reference sets itself, and grease
    pencil."""
    draw_lines()
    scene = bpy.context.scene
    grey = material("Grey", "ShaderNodeBsdfDiffuse", (0.5, 0.5, 0.5))
    mesh("Ball", lambda b: bmesh.ops.create_uvsphere(b, u_segments=48, v_segments=24, radius=1.0), (0, 0, 0.7), grey,
         True)
    scene.camera, other = camera("First"), camera("Second", 0.8)
    for frame, bound in ((1, scene.camera), (10, other)):
        scene.timeline_markers.new(bound.name, frame=frame).camera = bound
    lens = other.data.dof
    lens.use_dof, lens.aperture_fstop, lens.focus_distance = True, 0.1, 2.0
    lens.keyframe_insert("use_dof", frame=1)
    scene.render.film_transparent = False
    scene.render.keyframe_insert("film_transparent", frame=1)
    scene.driver_add("cycles.filter_width").driver.expression = "3.0"


def keyed_scatter():
    """Instancers and instances whose visibility has keys, and one that the keys hide. The values in the file are
    others than those of the keys."""
    red, grey = (material(name, "ShaderNodeBsdfDiffuse", color)
                 for name, color in (("Red", (0.8, 0.2, 0.1)), ("Grey", (0.5, 0.5, 0.5))))
    mesh("Floor", plane(3.0), (0, 0, -0.3), grey)
    corners = mesh("Corners", plane(0.4), (1.6, -0.6, 0.2), grey)
    leaf = mesh("Leaf", box(0.15), (0, 0, 0), red)
    leaf.parent, corners.instance_type = corners, "VERTS"
    pebble = mesh("Pebble", box(0.12), (2.2, -1.2, 0.0), red)
    bristles = mesh("Bristles", plane(0.5), (0, -1.2, 0.2), grey)
    particles = bristles.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = bristles.particle_systems[0].settings
    settings.type, settings.count, settings.render_type, settings.instance_object = "HAIR", 9, "OBJECT", pebble
    settings.emit_from, settings.use_emit_random = "VERT", False
    settings.use_advanced_hair, settings.particle_size = True, 1.0
    group = collection_of("Group", mesh("Placed", box(0.4), (0, 0, 0.2), red))
    shown, hidden = (link(bpy.data.objects.new(name, None)) for name in ("Shown", "Hidden"))
    for number, instancer in enumerate((shown, hidden)):
        instancer.instance_type, instancer.instance_collection = "COLLECTION", group
        instancer.location = (1.4 * number - 1.4, 0.6, 0.3)
    for owner, name, value in ((corners, "hide_render", False), (corners, "show_instancer_for_render", False),
                               (corners, "instance_type", "VERTS"), (leaf, "hide_render", False),
                               (particles, "show_render", True), (shown, "hide_render", False),
                               (shown, "instance_type", "COLLECTION"), (hidden, "hide_render", True)):
        setattr(owner, name, value)
        owner.keyframe_insert(name, frame=1)
    corners.show_instancer_for_render, hidden.hide_render = True, False
    bpy.context.scene.camera = camera("Camera")


def simplified():
    """Simplify leaves one of three levels, by animation."""
    render = bpy.context.scene.render
    grey = material("Grey", "ShaderNodeBsdfDiffuse", (0.5, 0.5, 0.5))
    cube = mesh("Cube", box(2.0), (0, 0, 0.7), grey)
    bends = cube.modifiers.new("Subdivision", "SUBSURF")
    bends.levels, bends.render_levels = 0, 3
    render.use_simplify, render.simplify_subdivision, render.simplify_subdivision_render = True, 0, 1
    render.keyframe_insert("simplify_subdivision_render", frame=1)
    render.simplify_subdivision_render = 3
    bpy.context.scene.camera = camera("Camera")


def output(name):
    return str(Path(sys.argv[sys.argv.index("--") + 1]) / name)


def main():
    for build in (room, scatter, crooked, keyed, keyed_scatter, simplified):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        build()
        bpy.ops.wm.save_as_mainfile(filepath=output(build.__name__ + ".blend"))


if __name__ == "__main__":
    try:
        main()
    except Exception:  # Blender itself would print the traceback and exit with 0
        traceback.print_exc()
        sys.exit(1)
