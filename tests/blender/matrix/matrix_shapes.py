"""Every type of object that Blender evaluates to a mesh, and every way in which it makes normals, side by side in one
frame: part of make_matrix.py."""

import math

import bmesh
import bpy
import versions
from mathutils import Euler, Vector

COLUMNS, APART = 6, 1.5


def add(name, data, material):
    """Puts a new object in the next place of the frame, turned so that no face is seen along its plane."""
    scene = bpy.context.scene
    number = len(scene.collection.objects)
    thing = bpy.data.objects.new(name, data)
    if not data.materials:
        data.materials.append(material)
    thing.location = (APART * (number % COLUMNS - (COLUMNS - 1) / 2), 0.0, APART * (number // COLUMNS))
    thing.rotation_euler = Euler((0.9, 0.2, 0.4))
    scene.collection.objects.link(thing)
    return thing


def add_mesh(name, build, material, smooth):
    data, shape = bpy.data.meshes.new(name), bmesh.new()
    build(shape)
    for face in shape.faces:
        face.smooth = smooth
    shape.to_mesh(data)
    shape.free()
    return add(name, data, material)


def metaballs():
    data = bpy.data.metaballs.new("Balls")
    data.resolution, data.render_resolution = 0.4, 0.15
    for x, radius in ((-0.25, 0.6), (0.3, 0.5)):
        element = data.elements.new()
        element.co, element.radius = (x, 0, 0), radius
    return data


def text():
    data = bpy.data.curves.new("Text", "FONT")
    data.body, data.size, data.extrude, data.bevel_depth, data.bevel_resolution = "S8", 1.1, 0.1, 0.04, 3
    data.align_x = data.align_y = "CENTER"
    return data


def tube():
    data = bpy.data.curves.new("Tube", "CURVE")
    data.dimensions, data.bevel_depth, data.bevel_resolution, data.use_fill_caps = "3D", 0.15, 2, True
    data.resolution_u, data.render_resolution_u = 3, 6
    spline = data.splines.new("BEZIER")
    spline.bezier_points.add(2)
    for point, at in zip(spline.bezier_points, ((-0.5, 0, -0.2), (0, 0, 0.4), (0.5, 0.2, -0.2))):
        point.co, point.handle_left_type, point.handle_right_type = at, "AUTO", "AUTO"
    return data


def sign():
    """A flat curve that is filled, with an edge of some height."""
    data = bpy.data.curves.new("Sign", "CURVE")
    data.dimensions, data.extrude, data.fill_mode = "2D", 0.2, "BOTH"
    spline = data.splines.new("NURBS")
    spline.points.add(5)
    for number, point in enumerate(spline.points):
        turn = number * math.pi / 3
        point.co = (0.6 * math.cos(turn), 0.6 * math.sin(turn), 0, 1)
    spline.use_cyclic_u, spline.order_u = True, 3
    return data


def add_sheet(material):
    """Rows of points that Blender's own command joins to a surface."""
    data = bpy.data.curves.new("Sheet", "SURFACE")
    data.dimensions = "3D"
    thing = add("Sheet", data, material)
    for row in range(4):
        spline = data.splines.new("NURBS")
        spline.points.add(3)
        for number, point in enumerate(spline.points):
            point.co = (0.4 * number - 0.6, 0.4 * row - 0.6, 0.5 * ((row + number) % 2), 1)
            point.select = True
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.curve.make_segment()
    bpy.ops.object.mode_set(mode="OBJECT")
    for spline in data.splines:
        spline.use_endpoint_u = spline.use_endpoint_v = True


def bent(shape):
    """A ball of quads that are not plane."""
    bmesh.ops.create_uvsphere(shape, u_segments=12, v_segments=8, radius=0.6)
    for number, vertex in enumerate(shape.verts):
        vertex.co *= 1.0 + 0.15 * ((number * 7) % 5 - 2) / 2


def darts(shape):
    """Two concave quads, one in a plane and one bent, that renders cut from the second corner to the fourth."""
    for y, z in ((-0.35, 0.0), (0.35, 0.15)):
        corners = ((0.6, y - 0.3, 0.0), (0.0, y, z), (0.6, y + 0.3, 0.0), (-0.6, y, 0.0))
        shape.faces.new([shape.verts.new(corner) for corner in corners])


def folded(shape):
    """Quads folded by more than a right angle along one diagonal and along the other."""
    for first in (0, 1):
        corners = ((-0.5, 0.0, 0.0), (0.05, -0.4, 0.45), (0.5, 0.0, 0.0), (0.0, 0.25, 0.5))
        turned = corners[first:] + corners[:first]
        shape.faces.new([shape.verts.new((x, y + 0.8 * first - 0.4, z - 0.2)) for x, y, z in turned])


def can(shape):
    bmesh.ops.create_cone(shape, cap_ends=True, segments=12, radius1=0.6, radius2=0.5, depth=0.9)


def add_auto_smooth(name, material):
    thing = add_mesh(name, can, material, True)
    versions.smooth_by_angle(thing.data, 0.7)
    return thing


def add_with_modifiers(material):
    """Modifiers that only the render has, or only the viewport; and two that make or move faces."""
    thing = add_mesh("Rendered", lambda shape: bmesh.ops.create_cube(shape, size=0.9), material, True)
    subdivision = thing.modifiers.new("Subdivision", "SUBSURF")
    subdivision.show_viewport, subdivision.levels, subdivision.render_levels = False, 0, 2
    hidden = thing.modifiers.new("Hidden", "SIMPLE_DEFORM")
    hidden.show_render, hidden.angle = False, 2.0
    thing = add_mesh("Thick", lambda shape: bmesh.ops.create_grid(shape, x_segments=4, y_segments=4, size=0.5),
                     material, True)
    thing.modifiers.new("Solid", "SOLIDIFY").thickness = 0.2
    thing.modifiers.new("Cast", "CAST").factor = 0.5


def build(material):
    curve = tube()
    for name, data in (("Balls", metaballs()), ("Text", text()), ("Tube", curve), ("Sign", sign())):
        add(name, data, material)
    add_sheet(material)
    add_mesh("Bent", bent, material, False)
    add_mesh("Soft", bent, material, True)
    for face in add_mesh("Mixed", bent, material, True).data.polygons:
        face.use_smooth = face.index % 3 > 0
    add_auto_smooth("Auto", material)
    own = add_auto_smooth("Own", material).data
    own.normals_split_custom_set_from_vertices(
        [(vertex.co + Vector((0, 0, 0.5 * math.sin(9 * vertex.co.x)))).normalized() for vertex in own.vertices])
    hard = add_auto_smooth("Hard", material)
    bevel = hard.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments, bevel.harden_normals = 0.12, 2, True
    hard.modifiers.new("Weighted", "WEIGHTED_NORMAL").keep_sharp = True
    add_with_modifiers(material)
    # One curve in three objects, each of which Blender makes triangles of anew.
    add("Shared", curve, material).scale = (1.0, 0.6, 1.4)
    add("Twisted", curve, material).modifiers.new("Twist", "SIMPLE_DEFORM").angle = 1.5
    add_mesh("Darts", darts, material, False)
    add_mesh("Folded", folded, material, False)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 9.6
    camera.location, camera.rotation_euler = (0, -10, APART), Euler((math.pi / 2, 0, 0))
    bpy.context.scene.camera = camera
