"""Gives every rendered object its own name, as export_scene.py does: part of render_guides.py.

Cryptomatte identifies an instance by its object's name alone, and objects of one name as one. So instances of all kinds
(collections, vertices, faces, particles, geometry nodes) become objects at their places, called "Instancer/Object", and
their instancers stop making them; objects that share their name with another are renamed.
"""

import re
from dataclasses import dataclass

import bpy

from blend_common import release
from export_copies import name_instancer_map
from export_flat import RAYS, every_instance, is_generated, is_made_of_itself, new_mesh, seen_by_camera
from export_maps import add_instancer_map, instancer_readers, reads_instancer
from export_viewport import show_as_rendered

LONGEST_NAME = 63  # bytes that Blender keeps of a name
SCATTERED = {"OBJECT", "COLLECTION"}  # the rendered form of particles
# Paths of animated properties that disarm and hide set.
SET_HERE = re.compile(r"^(hide_render|instance_type|modifiers\[.*\]\.show_(render|viewport))$")


@dataclass
class Copy:
    """The data for an instance's replacement: the original object's, or a mesh of its own."""
    name: str
    original: object
    mesh: object
    matrix: object
    rays: dict
    holdout: bool


def name_apart(scene, view_layer, unsupported):
    bpy.context.window.view_layer = view_layer
    show_as_rendered(scene, view_layer)
    depsgraph = view_layer.depsgraph
    depsgraph.update()
    standing, copies, instancers, made, too_long = [], [], [], {}, 0
    readers = instancer_readers(depsgraph, unsupported)
    for instance, name in every_instance(depsgraph):
        thing = instance.object
        if not instance.is_instance or is_made_of_itself(instance):
            if thing.type != "CAMERA":  # blend_common.camera_names
                standing.append((thing.original, name))
            continue
        if len(name.encode()) > LONGEST_NAME:
            too_long += 1
            name = name.encode()[:LONGEST_NAME].decode(errors="ignore")
        parent = instance.parent.original
        mesh = made_mesh(instance, made, depsgraph, readers)
        copies.append(Copy(name, thing.original, mesh, instance.matrix_world.copy(),
                           rays_of(thing.original, parent, view_layer),
                           thing.original.is_holdout or parent.holdout_get(view_layer=view_layer)))
        for instancer in (parent, thing.original):  # instancers may be instances
            if instancer not in instancers:
                instancers.append(instancer)
    if too_long:
        unsupported.add(f"{too_long} instances have names of more than {LONGEST_NAME} bytes, which Cycles' object pass "
                        "cuts")
    rename(standing)
    for material in bpy.data.materials:
        if material.use_nodes and material.node_tree:
            name_instancer_map(material.node_tree)
    if not copies:
        return
    shown = {thing for thing, _ in standing}
    for instancer in instancers:
        disarm(instancer)
    for thing in scene.objects:
        # Neither instancers that only show their instances, nor objects that were shown as instances alone.
        if thing.type not in {"CAMERA", "EMPTY"} and thing not in shown:
            hide(thing)
    anchor = bpy.data.objects.new("scumble.anchor", None)
    scene.collection.objects.link(anchor)
    for copy in copies:
        place(scene, anchor, copy)


def rename(standing):
    for thing, name in standing:
        if thing.name != name:
            if thing.library is not None:
                thing = thing.make_local()  # names of linked things cannot be changed
            thing.name = name


def made_mesh(instance, made, depsgraph, readers):
    """The mesh of an instance that only geometry nodes define, or that has the instancer's UV; None where it is that of
    its object."""
    reads_uv = reads_instancer(instance, readers)
    if not reads_uv and not is_generated(instance, depsgraph):
        return None
    key = (instance.object.data.as_pointer(), *(instance.uv if reads_uv else ()))
    if key not in made:
        made[key] = new_mesh(instance, depsgraph)
        if reads_uv:
            add_instancer_map(made[key], instance.uv)
    return made[key]


# ---- Instancers -----------------------------------------------------------------------------------------------------


def disarm(thing):
    """Leaves the thing itself and takes its instances away."""
    release(thing, SET_HERE)
    thing.instance_type = "NONE"
    for modifier in thing.modifiers:
        if modifier.type == "PARTICLE_SYSTEM" and modifier.particle_system.settings.render_type in SCATTERED:
            modifier.show_render = modifier.show_viewport = False
    if any(modifier.type == "NODES" and modifier.show_render for modifier in thing.modifiers):
        thing.modifiers.new("scumble.own", "NODES").node_group = own_geometry()


def hide(thing):
    release(thing, SET_HERE)
    thing.hide_render = True


def geometry_nodes(name):
    """A node group that takes and gives geometry."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    if hasattr(tree, "interface"):  # from Blender 4.0 on
        for way in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    return tree


def own_geometry():
    """Geometry nodes that let everything but instances through."""
    name = "scumble.own"
    if name in bpy.data.node_groups:
        return bpy.data.node_groups[name]
    tree = geometry_nodes(name)
    source, target = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    parts, joined = tree.nodes.new("GeometryNodeSeparateComponents"), tree.nodes.new("GeometryNodeJoinGeometry")
    tree.links.new(source.outputs[0], parts.inputs[0])
    for part in parts.outputs:
        if part.name != "Instances":
            tree.links.new(part, joined.inputs[0])
    tree.links.new(joined.outputs[0], target.inputs[0])
    return tree


def rays_of(thing, parent, view_layer):
    """Which rays see an instance: those that see both, unless its collection is for indirect light only."""
    rays = {ray: getattr(thing, ray) and getattr(parent, ray) for ray in ("visible_camera", *RAYS)}
    rays["visible_camera"] = seen_by_camera(thing, parent, view_layer)
    return rays


def place(scene, anchor, wanted):
    if wanted.mesh is None:
        copy = wanted.original.copy()
    else:
        copy = bpy.data.objects.new(wanted.name, wanted.mesh)
        copy.pass_index = wanted.original.pass_index
    copy.name = wanted.name
    copy.is_holdout = wanted.holdout
    for ray, seen in wanted.rays.items():
        setattr(copy, ray, seen)
    copy.animation_data_clear()
    copy.constraints.clear()
    copy.parent, copy.parent_type = anchor, "OBJECT"
    copy.matrix_parent_inverse = wanted.matrix  # any matrix, with shear
    for name_, zero in (("location", (0, 0, 0)), ("rotation_euler", (0, 0, 0)), ("scale", (1, 1, 1)),
                        ("delta_location", (0, 0, 0)), ("delta_rotation_euler", (0, 0, 0)), ("delta_scale", (1, 1, 1))):
        setattr(copy, name_, zero)
    copy.rotation_mode = "XYZ"
    copy.hide_render = copy.hide_viewport = False
    scene.collection.objects.link(copy)
