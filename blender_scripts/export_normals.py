"""Normals as Cycles has them, where Blender's exporter would write others: part of export_scene.py.

Without Auto Smooth, Cycles takes the evaluated mesh's own normals at vertices of smooth faces, and the triangle's at flat
ones. The exporter makes both anew from the faces of a copy. That differs for metaballs, whose normals come from their
field, and for flat polygons that are bent, of which each triangle has a normal of its own. With Auto Smooth both take the
mesh's corner normals.
"""

import bmesh
import numpy as np

CLOSE = 1e-5  # of unit normals; below it they are equal but for rounding


def vectors(things, name):
    values = np.empty(3 * len(things), np.float32)
    things.foreach_get(name, values)
    return values.reshape(-1, 3)


def numbers(things, name, kind=np.int32):
    values = np.empty(len(things), kind)
    things.foreach_get(name, values)
    return values


def bent_polygons(mesh):
    """The flat polygons whose triangles do not lie in one plane."""
    flat = ~numbers(mesh.polygons, "use_smooth", bool)
    if not flat.any() or numbers(mesh.polygons, "loop_total").max() < 4:
        return np.empty(0, np.int32)
    mesh.calc_loop_triangles()
    polygon = numbers(mesh.loop_triangles, "polygon_index")
    away = np.linalg.norm(vectors(mesh.loop_triangles, "normal") - vectors(mesh.polygons, "normal")[polygon], axis=1)
    return np.unique(polygon[flat[polygon] & (away > CLOSE)])


def cut(mesh, polygons):
    """Cuts polygons into triangles, along the diagonals that renders use."""
    shape = bmesh.new()
    shape.from_mesh(mesh)
    shape.faces.ensure_lookup_table()
    bmesh.ops.triangulate(shape, faces=[shape.faces[number] for number in polygons], quad_method="FIXED",
                          ngon_method="EAR_CLIP")
    shape.to_mesh(mesh)
    shape.free()


def of_metaballs(depsgraph):
    """The normals at the vertices of each metaball's evaluated mesh, by the object's full name. That mesh is an instance
    of its own, beside the object, whose copy has normals made anew."""
    found = {}
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type == "MESH" and thing.original.type == "META":
            found[thing.original.name_full] = vectors(thing.data.vertices, "normal")
    return found


def match_cycles(mesh, at_vertices=None):
    """Gives the export's own copy of a mesh the normals of the evaluated one: `at_vertices`, or those that it has."""
    if mesh.use_auto_smooth or not mesh.polygons:
        return
    if at_vertices is None or len(at_vertices) != len(mesh.vertices):
        at_vertices = vectors(mesh.vertices, "normal")
    polygons = bent_polygons(mesh)
    if len(polygons) > 0:
        cut(mesh, polygons)
    smooth = numbers(mesh.polygons, "use_smooth", bool)
    away = np.linalg.norm(vectors(mesh.vertices, "normal") - at_vertices, axis=1)
    if not smooth.any() or away.max() <= CLOSE:
        return
    totals = numbers(mesh.polygons, "loop_total")
    wanted = at_vertices[numbers(mesh.loops, "vertex_index")]
    is_flat = np.repeat(~smooth, totals)
    wanted[is_flat] = np.repeat(vectors(mesh.polygons, "normal"), totals, axis=0)[is_flat]
    mesh.use_auto_smooth, mesh.auto_smooth_angle = True, np.pi
    mesh.normals_split_custom_set(wanted)
