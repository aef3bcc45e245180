"""Objects that the viewport shows otherwise than a render, and curves with geometry nodes: part of make_oddities.py."""

import bpy
import versions
from odd_materials import diffuse, plane


def drive(owner, path):
    """By the camera's x scale, which is 1; no script is needed."""
    driver = owner.driver_add(path).driver
    driver.type = "SUM"
    target = driver.variables.new().targets[0]
    target.id, target.data_path = bpy.context.scene.camera, "scale[0]"


def strip(thing):
    """Moves the object's animation into a strip."""
    action = thing.animation_data.action
    thing.animation_data.nla_tracks.new().strips.new("Strip", 1, action)
    thing.animation_data.action = None


def array(thing):
    modifier = thing.modifiers.new("Array", "ARRAY")
    modifier.count, modifier.relative_offset_displace = 3, (0, 0, 0)
    modifier.use_constant_offset, modifier.constant_offset_displace = True, (0.1, 0, 0.1)
    return modifier


def line(name, cell, points, bevel=0.0):
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions, data.bevel_depth = "3D", bevel
    spline = data.splines.new("POLY")
    spline.points.add(points - 1)
    for number, point in enumerate(spline.points):
        point.co = (0.8 * number / (points - 1) - 0.4, 0.2 * (number % 2), 0, 1)
    thing = bpy.data.objects.new(name, data)
    thing.location = (cell % 8, -(cell // 8), 0)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def nodes(thing, build):
    """`build` makes an output of a tree and an input of geometry."""
    tree = versions.geometry_nodes(thing.name)
    source, target = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(build(tree, source.outputs[0]), target.inputs[0])
    thing.modifiers.new("Nodes", "NODES").node_group = tree


def pebbles(stone):
    def build(tree, geometry):
        info, scatter = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("GeometryNodeInstanceOnPoints")
        info.inputs["Object"].default_value = stone
        scatter.inputs["Scale"].default_value = (0.1, 0.1, 0.1)
        tree.links.new(geometry, scatter.inputs["Points"])
        tree.links.new(info.outputs["Geometry"], scatter.inputs["Instance"])
        return scatter.outputs[0]
    return build


def tube(material):
    def build(tree, geometry):
        circle, sweep = tree.nodes.new("GeometryNodeCurvePrimitiveCircle"), tree.nodes.new("GeometryNodeCurveToMesh")
        circle.inputs["Radius"].default_value = 0.1
        paint = tree.nodes.new("GeometryNodeSetMaterial")
        paint.inputs["Material"].default_value = material
        tree.links.new(geometry, sweep.inputs["Curve"])
        tree.links.new(circle.outputs[0], sweep.inputs["Profile Curve"])
        tree.links.new(sweep.outputs[0], paint.inputs["Geometry"])
        return paint.outputs[0]
    return build


def in_renders_alone(tree, geometry):
    asked, delete = tree.nodes.new("GeometryNodeIsViewport"), tree.nodes.new("GeometryNodeDeleteGeometry")
    tree.links.new(geometry, delete.inputs["Geometry"])
    tree.links.new(asked.outputs[0], delete.inputs["Selection"])
    return delete.outputs[0]


def viewport(red):
    drive(plane("DrivenAway", 24, red), "hide_viewport")
    kept = plane("StripAway", 25, red)
    kept.hide_viewport = True
    kept.keyframe_insert("hide_viewport", frame=1)
    strip(kept)
    rows = array(plane("KeyedArray", 26, red))
    rows.show_viewport = False
    rows.keyframe_insert("show_viewport", frame=1)
    smooth = plane("DrivenLevels", 27, red).modifiers.new("Smooth", "SUBSURF")
    smooth.render_levels = 2
    drive(smooth, "levels")
    data = bpy.data.meshes.new("Screw")
    data.from_pydata([(0.2, 0, 0), (0.4, 0, 0)], [(0, 1)], [])
    data.materials.append(red)
    screw = bpy.data.objects.new("Screw", data)
    screw.location = (4, -3, 0)
    bpy.context.scene.collection.objects.link(screw)
    turn = screw.modifiers.new("Screw", "SCREW")
    turn.steps, turn.render_steps = 4, 24
    nodes(plane("RenderAlone", 29, red), in_renders_alone)


def curves(red):
    stone = plane("Stone", 39, diffuse("stone", (0, 0, 1)))
    stone.hide_render = True
    nodes(line("Path", 20, 5), pebbles(stone))
    nodes(line("Tube", 21, 3), tube(diffuse("tube", (0, 1, 0))))
    line("Wire", 22, 3, bevel=0.05).data.materials.append(red)
    text = bpy.data.objects.new("Word", bpy.data.curves.new("Word", "FONT"))
    text.data.body, text.data.size, text.location = "I", 0.8, (7, -2, 0)
    bpy.context.scene.collection.objects.link(text)


def asset():
    """A body that moved after its hidden child was last evaluated."""
    group = bpy.data.collections.new("Asset")
    bpy.context.scene.collection.children.link(group)
    body = plane("Body", 0, diffuse("body", (0, 1, 0)), group)
    child = plane("Child", 0, diffuse("child", (1, 0, 1)), group)
    child.parent, child.location, child.scale = body, (0, 0.2, 0.1), (0.3, 0.3, 1)
    bpy.context.view_layer.update()
    child.modifiers.new("Smooth", "SUBSURF").render_levels = 2
    child.modifiers[0].levels = 0
    child.hide_viewport = True
    bpy.context.view_layer.update()
    body.location = (3, -4, 0)
    bpy.context.view_layer.update()


def stale(path):
    with bpy.data.libraries.load(str(path), link=True, relative=True) as (_, wanted):
        wanted.collections = ["Asset"]
    group = bpy.data.collections["Asset"]
    bpy.context.scene.collection.children.link(group)
    instancer = bpy.data.objects.new("Instancer", None)
    instancer.instance_type, instancer.instance_collection = "COLLECTION", group
    instancer.location = (-2, 0, 0)
    bpy.context.scene.collection.objects.link(instancer)


def emitters():
    """They send leaves up, 1 m in a second; those of Brief are gone after 4 frames."""
    leaf = plane("Leaf", 39)
    leaf.hide_render = True
    for name, cell, systems, lifetime in (("Emitter", 4, 1, 50), ("Brief", 5, 2, 4)):
        source = plane(name, cell)
        for number in range(systems):
            source.modifiers.new("Particles", "PARTICLE_SYSTEM")
            settings = source.particle_systems[number].settings
            settings.count, settings.frame_end, settings.lifetime = 10, 10, lifetime
            settings.render_type, settings.instance_object, settings.particle_size = "OBJECT", leaf, 0.1
            settings.effector_weights.gravity = 0


def diced():
    """Two planes with adaptive subdivision, which counts where the modifier is the last one alone."""
    bpy.context.scene.cycles.feature_set = "EXPERIMENTAL"
    for name, cell in (("Diced", 6), ("Plain", 7)):
        thing = plane(name, cell)
        smooth = thing.modifiers.new("Smooth", "SUBSURF")
        smooth.levels, smooth.render_levels = 0, 1
        thing.cycles.use_adaptive_subdivision = True
    thing.modifiers.new("Triangulate", "TRIANGULATE")


def filtered():
    """Hair, and two lamps of which the camera sees one."""
    furry = plane("Furry", 8)
    furry.modifiers.new("Particles", "PARTICLE_SYSTEM")
    furry.particle_systems[0].settings.type = "HAIR"
    furry.particle_systems[0].settings.count = 5
    for name in ("Panel", "Unseen"):
        lamp = bpy.data.objects.new(name, bpy.data.lights.new(name, "AREA"))
        lamp.visible_camera = name == "Panel"
        bpy.context.scene.collection.objects.link(lamp)


def build(asset_path):
    red = diffuse("red", (1, 0, 0))
    viewport(red)
    curves(red)
    stale(asset_path)
