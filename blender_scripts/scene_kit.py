"""Shapes, materials, lights, export and previews for make_scenes.py.

Everything is built from numbers, without operators that depend on the user interface, so that two runs give the same
bytes. Blender's world: metres, +Z up; the cameras look along +Y. The exporter turns this into glTF's +Y up.
"""

import json
import math
import struct
from pathlib import Path

import bmesh
import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

UP = Vector((0.0, 0.0, 1.0))


def clear():
    """Empties the file, the start-up scene's collections included."""
    bpy.ops.wm.read_factory_settings(use_empty=True)


# ---- Materials ------------------------------------------------------------------------------------------------------


def material(name, color, roughness=0.6, image=None):
    """A Principled material, the only kind that the glTF exporter keeps. `color` is linear Rec.709."""
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    shader = result.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = 0.0
    result.diffuse_color = (*color, 1.0)
    if image is not None:
        texture = result.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        result.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    return result


def image(name, rgb):
    """Packs an array of shape (height, width, 3), sRGB-encoded in [0, 1], row 0 at the bottom as Blender has it."""
    height, width, _ = rgb.shape
    result = bpy.data.images.new(name, width, height, alpha=False)
    result.pixels.foreach_set(np.dstack([rgb, np.ones((height, width))]).astype(np.float32).ravel())
    result.pack()
    return result


def checker(name, size, cells, first, second):
    y, x = np.mgrid[0:size, 0:size] * cells // size
    return image(name, np.where(((x + y) % 2)[..., None], np.array(second), np.array(first)))


def marble(name, size, light, dark):
    """Veins: a sine of position, bent by octaves of sines whose periods divide the picture, so that it tiles."""
    y, x = np.mgrid[0:size, 0:size] * (2 * math.pi / size)
    bend = sum(np.sin(k * x + a) * np.cos(k * y + b) / k for k, a, b in ((1, 0.3, 1.9), (2, 2.1, 0.4), (5, 4.0, 2.7)))
    vein = np.abs(np.sin(x + 2 * y + 1.7 * bend)) ** 0.6
    return image(name, np.array(dark) + vein[..., None] * (np.array(light) - np.array(dark)))


# ---- Curves ---------------------------------------------------------------------------------------------------------


def spline(points, count):
    """`count` points on the Catmull-Rom spline through `points`, of any dimension, ends included."""
    knots = np.array(points, dtype=float)
    knots = np.vstack([2 * knots[0] - knots[1], knots, 2 * knots[-1] - knots[-2]])
    at = np.linspace(0, len(points) - 1, count)
    segment = np.minimum(at.astype(int), len(points) - 2)
    t = (at - segment)[:, None]
    p0, p1, p2, p3 = (knots[segment + i] for i in range(4))
    return 0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t**2 + (3 * p1 - p0 - 3 * p2 + p3) * t**3)


def round_cap(count, length):
    """Factors for `length` points that rise from 0 like a quarter circle over `count` points, and fall alike."""
    i = np.arange(length)
    near = np.minimum(np.minimum(i, length - 1 - i) / count, 1.0)
    return np.sqrt(1 - (1 - near) ** 2)


# ---- Surfaces -------------------------------------------------------------------------------------------------------


class Shape:
    """Grids of points that become one mesh object. Coinciding points are merged, so poles need no care."""

    def __init__(self):
        self.mesh = bmesh.new()
        self.uv = self.mesh.loops.layers.uv.new("UVMap")

    def grid(self, points, wrap_columns=False, wrap_rows=False, flip=False):
        """Adds a grid of shape (rows, columns, 3). Wrapping joins the last row or column to the first."""
        points = np.asarray(points, dtype=float)
        rows, columns, _ = points.shape
        vertices = [[self.mesh.verts.new(p) for p in row] for row in points]
        last_row, last_column = rows - (not wrap_rows), columns - (not wrap_columns)
        for r in range(last_row):
            for c in range(last_column):
                corners = [(r, c), (r, c + 1), (r + 1, c + 1), (r + 1, c)]
                if flip:
                    corners.reverse()
                face = self.mesh.faces.new([vertices[i % rows][j % columns] for i, j in corners])
                for loop, (i, j) in zip(face.loops, corners):
                    loop[self.uv].uv = (j / last_column, i / last_row)
        return self

    def lathe(self, profile, segments=64, wobble=None):
        """Turns (radius, height) pairs about Z. `wobble(angle, height)` scales the radius."""
        angle = np.linspace(0, 2 * math.pi, segments, endpoint=False)
        radius, height = np.array(profile, dtype=float).T
        scale = np.array([[wobble(a, z) if wobble else 1.0 for a in angle] for z in height])
        ring = radius[:, None] * scale
        return self.grid(np.dstack([ring * np.cos(angle), ring * np.sin(angle),
                                    np.repeat(height[:, None], segments, 1)]), wrap_columns=True)

    def tube(self, path, radii, segments=16, widen=None, closed=False):
        """Sweeps a circle along `path`, without twist. `widen` is the section's width over its height, per point."""
        path = np.asarray(path, dtype=float)
        radii = np.broadcast_to(radii, len(path))
        widen = np.broadcast_to(1.0 if widen is None else widen, len(path))
        following = np.roll(path, -1, 0) - np.roll(path, 1, 0) if closed else np.gradient(path, axis=0)
        angle = np.linspace(0, 2 * math.pi, segments, endpoint=False)
        side = Vector(following[0]).orthogonal() if abs(following[0][2]) > 0.9 * np.linalg.norm(following[0]) \
            else Vector(following[0]).cross(UP)
        rings = []
        for point, along, radius, width in zip(path, following, radii, widen):
            along = Vector(along).normalized()
            side = (side - along * side.dot(along)).normalized()
            up = np.array(side.cross(along))
            rings.append(point + radius * (width * np.cos(angle)[:, None] * np.array(side) +
                                           np.sin(angle)[:, None] * up))
        return self.grid(rings, wrap_columns=True, wrap_rows=closed)

    def ball(self, center, radii, rows=24, columns=32, bump=None):
        """An ellipsoid. `bump(direction)` scales the distance from the centre."""
        directions = np.array([[(math.sin(t) * math.cos(p), math.sin(t) * math.sin(p), -math.cos(t))
                                for p in np.linspace(0, 2 * math.pi, columns, endpoint=False)]
                               for t in np.linspace(0, math.pi, rows)])
        scale = np.apply_along_axis(bump, 2, directions)[..., None] if bump else 1.0
        return self.grid(np.array(center) + directions * scale * np.array(radii), wrap_columns=True)

    def box(self, size, center=(0, 0, 0)):
        transform = Matrix.Translation(center) @ Matrix.Diagonal((*size, 1.0))
        bmesh.ops.create_cube(self.mesh, size=1.0, matrix=transform)
        return self

    def place(self, name, surface_material, at=(0, 0, 0), turn=(0, 0, 0), scale=1.0, smooth=True, closed=True,
              keep_uv=False, bevel=0.0):
        """Makes the object. `turn` is XYZ Euler angles in degrees. Closed surfaces are turned to face outward; flat
        ones may be bevelled, with normals that stay flat on the large faces."""
        bmesh.ops.remove_doubles(self.mesh, verts=self.mesh.verts, dist=1e-6)
        bmesh.ops.dissolve_degenerate(self.mesh, edges=self.mesh.edges, dist=1e-7)
        if closed:
            bmesh.ops.recalc_face_normals(self.mesh, faces=self.mesh.faces)
        for face in self.mesh.faces:
            face.smooth = smooth
        if not keep_uv:
            self.mesh.loops.layers.uv.remove(self.uv)
        data = bpy.data.meshes.new(name)
        self.mesh.to_mesh(data)
        self.mesh.free()
        data.materials.append(surface_material)
        result = bpy.data.objects.new(name, data)
        bpy.context.scene.collection.objects.link(result)
        result.location = at
        result.rotation_euler = Euler([math.radians(a) for a in turn])
        result.scale = (scale, scale, scale)
        if bevel:
            soften_edges(result, bevel)
        return result


def soften_edges(target, width):
    for polygon in target.data.polygons:
        polygon.use_smooth = True
    if hasattr(target.data, "use_auto_smooth"):  # no longer needed for the modifier's normals from Blender 4.1 on
        target.data.use_auto_smooth = True
        target.data.auto_smooth_angle = math.radians(60)
    modifier = target.modifiers.new("Bevel", "BEVEL")
    modifier.width = width
    modifier.segments = 4
    modifier.limit_method = "ANGLE"
    target.modifiers.new("WeightedNormal", "WEIGHTED_NORMAL").keep_sharp = True


def lowest(target):
    """The smallest world height of an object's vertices, its modifiers and rotation applied."""
    graph = bpy.context.evaluated_depsgraph_get()
    evaluated = target.evaluated_get(graph)
    return min((evaluated.matrix_world @ vertex.co).z for vertex in evaluated.data.vertices)


# ---- Camera and lights ----------------------------------------------------------------------------------------------


def look(kind, name, data, at, target):
    result = bpy.data.objects.new(name, data)
    result.location = at
    result.rotation_euler = (Vector(target) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(result)
    if kind == "camera":
        bpy.context.scene.camera = result
    return result


def camera(name, at, target, lens):
    data = bpy.data.cameras.new(name)
    data.lens = lens  # mm on a film 36 mm wide
    data.clip_start, data.clip_end = 0.1, 100.0
    return look("camera", name, data, at, target)


def lamp(name, kind, at, target, energy, color=(1.0, 1.0, 1.0), cone_degrees=50.0):
    """`kind` is SUN (energy in W/m²), POINT or SPOT (W). glTF has no area lights."""
    data = bpy.data.lights.new(name, kind)
    data.energy = energy
    data.color = color
    if kind == "SPOT":
        data.spot_size = math.radians(cone_degrees)
        data.spot_blend = 0.4
    return look("lamp", name, data, at, target)


# ---- Movement -------------------------------------------------------------------------------------------------------


def key(thing, path, value_at, frames):
    """Sets `thing.path` to value_at(0 … 1) at every frame of a range; the last one has 1."""
    first, last = frames[0], frames[-1]
    for frame in frames:
        setattr(thing, path, value_at((frame - first) / (last - first)))
        thing.keyframe_insert(path, frame=frame)


def skeleton(name, at, lengths):
    """An upright chain of bones, one above the other: Bone0, Bone1, …"""
    result = bpy.data.objects.new(name, bpy.data.armatures.new(name))
    bpy.context.scene.collection.objects.link(result)
    result.location = at
    bpy.context.view_layer.objects.active = result
    bpy.ops.object.mode_set(mode="EDIT")
    last, height = None, 0.0
    for i, length in enumerate(lengths):
        bone = result.data.edit_bones.new(f"Bone{i}")
        bone.head, bone.tail = (0, 0, height), (0, 0, height + length)
        bone.parent, bone.use_connect = last, last is not None
        last, height = bone, height + length
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in result.pose.bones:
        bone.rotation_mode = "XYZ"
    return result


def bind(thing, bones, weights_at):
    """Hangs a mesh object on a skeleton. `weights_at(vertex position)` has a weight for each bone."""
    thing.parent = bones
    thing.modifiers.new("Armature", "ARMATURE").object = bones
    groups = [thing.vertex_groups.new(name=bone.name) for bone in bones.data.bones]
    for vertex in thing.data.vertices:
        for group, weight in zip(groups, weights_at(vertex.co)):
            if weight > 0:
                group.add([vertex.index], weight, "REPLACE")


# ---- Files ----------------------------------------------------------------------------------------------------------


def options_by_version():
    """No vertex colours, and the actions in use as one animation."""
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    colors = {"export_colors": False} if "export_colors" in known else {"export_vertex_color": "NONE"}
    merged = ({"export_animation_mode": "ACTIVE_ACTIONS"} if "export_animation_mode" in known
              else {"export_nla_strips": False})
    return {**colors, **merged}


def export(path, moving=False):
    """Writes the scene as .glb, the same bytes every time. In a moving one modifiers are not applied, because the
    exporter would drop the shape keys."""
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 1920, 1080
    bpy.context.view_layer.update()
    bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB", export_apply=not moving, export_yup=True,
                              export_cameras=True, export_lights=True, export_animations=moving,
                              export_skins=moving, export_morph=moving, export_tangents=False,
                              export_copyright="CC0-1.0", **options_by_version())
    sharp = {thing.data.name for thing in bpy.data.objects
             if any(modifier.type == "WEIGHTED_NORMAL" for modifier in thing.modifiers)}
    make_repeatable(Path(path), sharp)


def make_repeatable(path, sharp_meshes):
    """Rewrites the variable parts: the name of the exporter's version, and the smooth normals, which Blender adds up on
    several threads in any order. The flat normals of `sharp_meshes` are kept."""
    data = path.read_bytes()
    length, = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20:20 + length])
    document["asset"]["generator"] = "scumble make_scenes.py"
    chunk_header = data[20 + length:28 + length]
    buffer = bytearray(data[28 + length:])

    def array(accessor, dtype, columns):
        view = document["bufferViews"][document["accessors"][accessor]["bufferView"]]
        count = document["accessors"][accessor]["count"] * columns
        return np.frombuffer(buffer, dtype, count, view.get("byteOffset", 0)).reshape(-1, columns)

    index_types = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32}
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"] if mesh["name"] not in sharp_meshes else []:
            attributes, indices = primitive["attributes"], primitive["indices"]
            triangles = array(indices, index_types[document["accessors"][indices]["componentType"]], 1).reshape(-1, 3)
            positions, normals = (array(attributes[name], np.float32, 3) for name in ("POSITION", "NORMAL"))
            normals[:] = smooth_normals(positions, triangles)
            for target in primitive.get("targets", []):
                moved = positions + array(target["POSITION"], np.float32, 3)
                array(target["NORMAL"], np.float32, 3)[:] = smooth_normals(moved, triangles) - normals

    text = json.dumps(document, separators=(",", ":"), sort_keys=True).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(data[:8] + struct.pack("<II", 28 + len(text) + len(buffer), len(text)) + data[16:20] + text +
                     chunk_header + buffer)


def smooth_normals(positions, triangles):
    """Per vertex the mean of its triangles' normals, weighted by angle. Vertices at one place share it, whatever their
    texture coordinates."""
    places, place_of_vertex = np.unique(positions.astype(np.float64) + 0.0, axis=0, return_inverse=True)
    corners = place_of_vertex.reshape(-1)[triangles]
    points = places[corners]
    face = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    face /= np.maximum(np.linalg.norm(face, axis=1, keepdims=True), 1e-30)
    total = np.zeros_like(places)
    for i in range(3):
        first = points[:, (i + 1) % 3] - points[:, i]
        second = points[:, (i + 2) % 3] - points[:, i]
        angle = np.arctan2(np.linalg.norm(np.cross(first, second), axis=1), np.sum(first * second, axis=1))
        for axis in range(3):
            total[:, axis] += np.bincount(corners[:, i], angle * face[:, axis], len(places))
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-30)
    return total[place_of_vertex.reshape(-1)].astype(np.float32)


def preview(path, samples=16):
    """A small Cycles picture of the scene, to judge the composition by."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 3
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 960, 540, 100
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("Preview")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.6
    scene.render.filepath = str(Path(path).resolve())
    bpy.ops.render.render(write_still=True)
