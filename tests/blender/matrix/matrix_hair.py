"""Hair in every way in which Blender makes it: part of make_matrix.py."""

import bmesh
import bpy
import versions


def emitter(name, place, materials):
    data, shape = bpy.data.meshes.new(name), bmesh.new()
    shape.loops.layers.uv.new("UVMap")
    bmesh.ops.create_uvsphere(shape, u_segments=24, v_segments=12, radius=0.5, calc_uvs=True)
    for face in shape.faces:
        face.smooth = True
    shape.to_mesh(data)
    shape.free()
    for material in materials:
        data.materials.append(material)
    thing = bpy.data.objects.new(name, data)
    thing.location = place
    bpy.context.scene.collection.objects.link(thing)
    return thing


def grow(thing, **values):
    system = thing.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system
    settings = system.settings
    settings.type, settings.count, settings.hair_length = "HAIR", 60, 0.7
    settings.hair_step, settings.render_step, settings.display_step = 5, 4, 2
    settings.brownian_factor, settings.tangent_factor = 0.03, 0.05
    settings.radius_scale, settings.root_radius, settings.tip_radius = 0.1, 1.0, 0.3
    settings.material = len(thing.material_slots)
    for key, value in values.items():
        setattr(settings, key, value)
    return system


def made_by_nodes(name, place, material):
    """An object of hair curves, all made by geometry nodes."""
    data = bpy.data.hair_curves.new(name)
    data.materials.append(material)
    thing = bpy.data.objects.new(name, data)
    thing.location = place
    bpy.context.scene.collection.objects.link(thing)
    nodes = versions.geometry_nodes(name)
    last = nodes.nodes.new("NodeGroupOutput")
    spiral, radius = nodes.nodes.new("GeometryNodeCurveSpiral"), nodes.nodes.new("GeometryNodeSetCurveRadius")
    paint = nodes.nodes.new("GeometryNodeSetMaterial")
    for key, value in (("Resolution", 12), ("Rotations", 2.0), ("Start Radius", 0.6), ("End Radius", 0.8),
                       ("Height", 0.7)):
        spiral.inputs[key].default_value = value
    radius.inputs["Radius"].default_value = 0.06
    paint.inputs["Material"].default_value = material
    link = nodes.links.new
    link(spiral.outputs[0], radius.inputs["Curve"])
    link(radius.outputs[0], paint.inputs["Geometry"])
    link(paint.outputs[0], last.inputs[0])
    thing.modifiers.new("Nodes", "NODES").node_group = nodes


def build(materials, shape):
    """`materials`: of the bodies, of the hair, and one with a texture."""
    bpy.context.scene.cycles_curves.shape = shape
    body, hair, textured = materials
    grow(emitter("Ball", (-1.2, 0.0, 0.6), [body, textured]))
    grow(emitter("Tufts", (0.0, 0.3, 0.6), [body, hair]), count=12, child_type="INTERPOLATED", rendered_child_count=6,
         clump_factor=0.3, **{versions.SHOWN_CHILDREN: 1})
    alone = emitter("Alone", (1.2, 0.0, 0.6), [hair])
    alone.scale = (0.8, 0.8, 0.8)
    alone.show_instancer_for_render = False
    grow(alone, shape=0.5, use_close_tip=True)
    made_by_nodes("Spiral", (0.0, -0.9, 0.0), hair)
