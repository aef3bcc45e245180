"""Instances with names of their own, as export_scene.py names them: part of render_guides.py."""

import bpy

from export_flat import MESH_TYPES, SILENT_TYPES, name_of, show_as_rendered

LONGEST_NAME = 63  # bytes that Blender keeps of a name


def name_apart(scene, view_layer, unsupported):
    """Cryptomatte knows an instance by its object's name alone. So every collection that is instanced is replaced by
    objects at its places that share data and materials with it and are called "Instancer/Object"."""
    if not any(thing.instance_type != "NONE" or thing.particle_systems for thing in scene.objects):
        return
    bpy.context.window.view_layer = view_layer
    show_as_rendered(scene, view_layer)
    depsgraph = view_layer.depsgraph
    depsgraph.update()
    taken, copies, instancers = {}, [], set()
    for instance in depsgraph.object_instances:
        thing = instance.object
        if (not instance.is_instance and not instance.show_self) or thing.type in SILENT_TYPES:
            continue
        if thing.type == "MESH" and thing.original.type in MESH_TYPES - {"MESH"}:
            continue
        name = name_of(instance, taken)  # counts on for whatever has a name there
        if not instance.is_instance:
            continue
        parent = instance.parent.original
        if parent.instance_type != "COLLECTION" or len(name.encode()) > LONGEST_NAME:
            unsupported.add(f"instance '{name}': is called '{thing.original.name}' in Cycles' object pass")
            continue
        copies.append((name, thing.original, instance.matrix_world.copy()))
        instancers.add(parent)
    if copies:
        anchor = bpy.data.objects.new("scumble.anchor", None)
        scene.collection.objects.link(anchor)
        for name, original, matrix in copies:
            place(scene, anchor, name, original, matrix)
    for instancer in instancers:
        instancer.instance_type = "NONE"


def place(scene, anchor, name, original, matrix):
    copy = original.copy()
    copy.name = name
    copy.animation_data_clear()
    copy.constraints.clear()
    copy.instance_type = "NONE"
    copy.parent, copy.parent_type = anchor, "OBJECT"
    copy.matrix_parent_inverse = matrix  # any matrix, with shear
    for name_, zero in (("location", (0, 0, 0)), ("rotation_euler", (0, 0, 0)), ("scale", (1, 1, 1)),
                        ("delta_location", (0, 0, 0)), ("delta_rotation_euler", (0, 0, 0)), ("delta_scale", (1, 1, 1))):
        setattr(copy, name_, zero)
    copy.rotation_mode = "XYZ"
    copy.hide_render = copy.hide_viewport = False
    scene.collection.objects.link(copy)
