"""The undeformed shape, to which paint is fixed: part of export_scene.py.

Armatures, shape keys and the like are applied as for a render, so the exporter's mesh has no rest pose any more. The
mesh is made once more without modifiers that only move vertices. If the number of vertices is equal, each exported one
gets its place at rest as the attribute `_SCUMBLE_REST`, in the axes of glTF.
"""

import numpy as np

ATTRIBUTE = "_scumble_rest"  # the exporter makes it upper case; export_glb.py takes away the _ that 3.4 puts before
# Attributes of newer Blenders that are no longer kept beside them: materials, flat faces, sharp edges, normals.
SHAPE = {"material_index", "sharp_face", "sharp_edge", "custom_normal"}
DEFORMERS = {"ARMATURE", "CAST", "CLOTH", "CORRECTIVE_SMOOTH", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM",
             "LAPLACIANSMOOTH", "LATTICE", "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE", "SHRINKWRAP",
             "SIMPLE_DEFORM", "SMOOTH", "SOFT_BODY", "SURFACE_DEFORM", "VOLUME_DISPLACE", "WARP", "WAVE"}


def is_deformed(thing):
    if thing.type != "MESH" or thing.data is None:
        return False
    return thing.data.shape_keys is not None or any(modifier.type in DEFORMERS and modifier.show_viewport
                                                    for modifier in thing.modifiers)


def relax(thing):
    """Returns the functions that restore the deformation."""
    switched = [modifier for modifier in thing.modifiers if modifier.type in DEFORMERS and modifier.show_viewport]
    for modifier in switched:
        modifier.show_viewport = False
    pinned, active = thing.show_only_shape_key, thing.active_shape_key_index
    if thing.data.shape_keys:
        thing.active_shape_key_index, thing.show_only_shape_key = 0, True

    def bring_back():
        for modifier in switched:
            modifier.show_viewport = True
        thing.active_shape_key_index, thing.show_only_shape_key = active, pinned
    return bring_back


def drop_other_attributes(mesh, ours):
    """The exporter is to write ours, and would write every other one as well. The materials of faces are one, too,
    which it reads and does not write."""
    kept = {layer.name for layer in mesh.uv_layers} | ours | SHAPE
    for name in [attribute.name for attribute in mesh.attributes if not getattr(attribute, "is_required", False)]:
        if name in kept or name.startswith("."):
            continue
        try:
            mesh.attributes.remove(mesh.attributes[name])
        except RuntimeError:
            pass  # one of Blender's own, which the exporter supports


def write_rest(mesh, corners, thing, depsgraph):
    """`corners` is the number that the mesh had before export_normals.py cut polygons, which keeps the vertices."""
    relaxed = thing.evaluated_get(depsgraph)
    shape = relaxed.to_mesh()
    if len(shape.vertices) == len(mesh.vertices) and len(shape.loops) == corners:
        places = np.empty(3 * len(shape.vertices), np.float32)
        shape.vertices.foreach_get("co", places)
        places = places.reshape(-1, 3)
        turned = np.stack([places[:, 0], places[:, 2], -places[:, 1]], axis=1)
        attribute = mesh.attributes.new(ATTRIBUTE, "FLOAT_VECTOR", "POINT")
        attribute.data.foreach_set("vector", turned.ravel())
    relaxed.to_mesh_clear()


def add_rest_positions(flat, view_layer):
    """Returns whether there are any. The meshes are the export's own copies; objects are left as they were."""
    shown = {placed.mesh.name: placed for placed in flat.meshes if placed.is_own_shape}
    wanted = [placed for placed in shown.values() if is_deformed(placed.source)]
    if not wanted:
        return False
    bring_back = [relax(thing) for thing in {placed.source.name_full: placed.source for placed in wanted}.values()]
    view_layer.update()
    for placed in wanted:
        write_rest(placed.mesh, flat.corners[placed.mesh.name], placed.source, view_layer.depsgraph)
    for undo in bring_back:
        undo()
    view_layer.update()
    return True
