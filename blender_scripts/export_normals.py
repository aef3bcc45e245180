"""Normals as Cycles has them, where Blender's exporter would write others: part of export_scene.py.

Without Auto Smooth, Cycles takes the evaluated mesh's own normals at vertices of smooth faces, and the triangle's at
flat ones. The exporter makes both anew from the faces of a copy. That differs for metaballs, whose normals come from
their field, and for flat polygons that are bent, of which each triangle has a normal of its own. With Auto Smooth, and
from Blender 4.1 on where a mesh has corner normals, both take those.
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


def polygons_to_cut(mesh, every):
    """The flat polygons whose triangles do not lie in one plane; with `every` all flat ones of more than three corners,
    so that it does not depend on the mesh's shape which are cut."""
    totals = numbers(mesh.polygons, "loop_total")
    flat = ~numbers(mesh.polygons, "use_smooth", bool) & (totals > 3)
    if every or not flat.any():
        return np.flatnonzero(flat)
    mesh.calc_loop_triangles()
    polygon = numbers(mesh.loop_triangles, "polygon_index")
    away = np.linalg.norm(vectors(mesh.loop_triangles, "normal") - vectors(mesh.polygons, "normal")[polygon], axis=1)
    return np.unique(polygon[flat[polygon] & (away > CLOSE)])


def cut_by_second(mesh):
    """By polygon: whether it is a quad that renders cut from its second corner to its fourth: one that is concave or
    folded so far that the other diagonal would turn a triangle over."""
    mesh.calc_loop_triangles()
    polygon = numbers(mesh.loop_triangles, "polygon_index")
    corners = np.empty(3 * len(polygon), np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    corners = corners.reshape(-1, 3) - numbers(mesh.polygons, "loop_start")[polygon][:, None]
    has_first_and_third = (corners == 0).any(axis=1) & (corners == 2).any(axis=1)
    both = np.ones(len(mesh.polygons), bool)
    both[polygon[~has_first_and_third]] = False
    return ~both & (numbers(mesh.polygons, "loop_total") == 4)


def cut(mesh, polygons):
    """Cuts polygons into triangles, along the diagonals that renders use. The vertices keep their order."""
    second = cut_by_second(mesh)[polygons]
    shape = bmesh.new()
    shape.from_mesh(mesh)
    shape.faces.ensure_lookup_table()
    faces = np.array([shape.faces[number] for number in polygons], object)
    for chosen, diagonal in ((~second, "FIXED"), (second, "ALTERNATE")):
        if chosen.any():
            bmesh.ops.triangulate(shape, faces=list(faces[chosen]), quad_method=diagonal, ngon_method="EAR_CLIP")
    shape.to_mesh(mesh)
    shape.free()


def of_metaballs(depsgraph):
    """The normals at the vertices of each metaball's evaluated mesh, by the object's full name. That mesh is an
    instance of its own, beside the object, whose copy has normals made anew."""
    found = {}
    for instance in depsgraph.object_instances:
        thing = instance.object
        if thing.type == "MESH" and thing.original.type == "META":
            found[thing.original.name_full] = vectors(thing.data.vertices, "normal")
    return found


def uses_corner_normals(mesh):
    """Whether Cycles does. Blender 4.1 has no Auto Smooth any more: sharp edges and custom normals always count. Flat
    faces beside smooth ones count for the exporter, but not for Cycles."""
    if hasattr(mesh, "use_auto_smooth"):
        return mesh.use_auto_smooth
    return mesh.normals_domain == "CORNER" and (mesh.has_custom_normals or
                                                numbers(mesh.edges, "use_edge_sharp", bool).any())


def match_cycles(mesh, at_vertices=None, changes_shape=False):
    """Gives the export's own copy of a mesh the normals of the evaluated one: `at_vertices`, or those that it has.
    Returns false where `at_vertices` are not those of its vertices, and are not used."""
    if not mesh.polygons or uses_corner_normals(mesh):
        return True
    fits = at_vertices is None or len(at_vertices) == len(mesh.vertices)
    if at_vertices is None or not fits:
        at_vertices = vectors(mesh.vertices, "normal")
    polygons = polygons_to_cut(mesh, changes_shape)
    if len(polygons) > 0:
        cut(mesh, polygons)
    take_normals(mesh, at_vertices)
    return fits


def take_normals(mesh, at_vertices):
    smooth = numbers(mesh.polygons, "use_smooth", bool)
    away = np.linalg.norm(vectors(mesh.vertices, "normal") - at_vertices, axis=1)
    if not smooth.any() or (away.max() <= CLOSE and getattr(mesh, "normals_domain", "POINT") == "POINT"):
        return
    totals = numbers(mesh.polygons, "loop_total")
    wanted = at_vertices[numbers(mesh.loops, "vertex_index")]
    is_flat = np.repeat(~smooth, totals)
    wanted[is_flat] = np.repeat(vectors(mesh.polygons, "normal"), totals, axis=0)[is_flat]
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, np.pi
    mesh.normals_split_custom_set(wanted)
