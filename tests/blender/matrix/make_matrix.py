"""Makes the .blend files of cycles_matrix_test.cpp: every kind of light over diffuse, glossy and textured surfaces, and
one scene for each other difficulty of a lighting pass.

    blender -b -noaudio --factory-startup -P tests/blender/matrix/make_matrix.py -- --output FOLDER [--only NAME,NAME]

FOLDER gets NAME.blend for each scene, and matrix.json: for each NAME its layers, the picture's size, the samples that
its noise needs, 0: light is not compared, and how often light is reflected after the first surface.
"""

import argparse
import json
import math
import sys
import traceback
from pathlib import Path

import bmesh
import bpy
import numpy as np
from mathutils import Euler, Vector

sys.dont_write_bytecode = True
for folder in Path(__file__).resolve().parents[:2]:
    sys.path.insert(0, str(folder))
import matrix_bends  # noqa: E402  (Blender does not put a script's own folder on the path)
import matrix_hair  # noqa: E402
import matrix_shapes  # noqa: E402

LANDSCAPE, PORTRAIT = "112x63", "63x112"
LARGER = "160x90"  # where the noise of the smaller one would leave it open whether the two agree


# ---- Shapes: dense enough that interpolation of normals does not matter, all with UV coordinates ---------------------


def grid(name, points, material, wrap_rows=False, wrap_columns=False, smooth=True, location=(0, 0, 0)):
    """A mesh of quads over points of shape (rows, columns, 3)."""
    rows, columns, _ = points.shape
    mesh = bmesh.new()
    uv = mesh.loops.layers.uv.new("UVMap")
    vertices = [[mesh.verts.new(p) for p in row] for row in points.tolist()]
    last_row, last_column = rows - (not wrap_rows), columns - (not wrap_columns)
    for r in range(last_row):
        for c in range(last_column):
            corners = [(r, c), (r, c + 1), (r + 1, c + 1), (r + 1, c)]
            face = mesh.faces.new([vertices[i % rows][j % columns] for i, j in corners])
            face.smooth = smooth
            for loop, (i, j) in zip(face.loops, corners):
                loop[uv].uv = (j / last_column, i / last_row)
    bmesh.ops.remove_doubles(mesh, verts=mesh.verts, dist=1e-6)
    data = bpy.data.meshes.new(name)
    mesh.to_mesh(data)
    mesh.free()
    data.materials.append(material)
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    return thing


def quad(name, origin, first, second, material, cells=1):
    origin, first, second = (np.array(v, dtype=float) for v in (origin, first, second))
    s, t = np.meshgrid(np.linspace(0, 1, cells + 1), np.linspace(0, 1, cells + 1))
    return grid(name, origin + s[..., None] * first + t[..., None] * second, material, smooth=False)


def ball(name, location, radius, material):
    turn = np.linspace(0, 2 * math.pi, 96, endpoint=False)
    rise = np.linspace(-math.pi / 2, math.pi / 2, 49)
    points = np.stack([np.outer(np.cos(rise), np.cos(turn)), np.outer(np.cos(rise), np.sin(turn)),
                       np.repeat(np.sin(rise)[:, None], 96, 1)], -1)
    return grid(name, radius * points, material, wrap_columns=True, location=location)


def torus(name, location, ring, tube, material):
    turn, around = (np.linspace(0, 2 * math.pi, count, endpoint=False) for count in (96, 48))
    reach = ring + tube * np.cos(around)[:, None]
    height = np.repeat(tube * np.sin(around)[:, None], 96, 1)
    points = np.stack([reach * np.cos(turn), reach * np.sin(turn), height], -1)
    return grid(name, points, material, wrap_rows=True, wrap_columns=True, location=location)


def box(name, location, size, material):
    thing = quad(name, (-size / 2, -size / 2, 0), (size, 0, 0), (0, size, 0), material)
    mesh = bmesh.new()
    mesh.from_mesh(thing.data)
    uv = mesh.loops.layers.uv.active
    lifted = bmesh.ops.extrude_face_region(mesh, geom=mesh.faces[:])
    bmesh.ops.translate(mesh, vec=(0, 0, size), verts=[v for v in lifted["geom"] if isinstance(v, bmesh.types.BMVert)])
    bmesh.ops.recalc_face_normals(mesh, faces=mesh.faces)
    for face in mesh.faces:
        for loop, corner in zip(face.loops, ((0, 0), (1, 0), (1, 1), (0, 1))):
            loop[uv].uv = corner
    mesh.to_mesh(thing.data)
    mesh.free()
    thing.location = location
    thing.rotation_euler = Euler((0, 0, math.radians(25)))
    return thing


def solid(name, build, location, material, turn=(0, 0, 0)):
    """What `build` makes in a bmesh, shaded smooth however coarse it is."""
    mesh = bmesh.new()
    build(mesh)
    for face in mesh.faces:
        face.smooth = True
    data = bpy.data.meshes.new(name)
    mesh.to_mesh(data)
    mesh.free()
    data.materials.append(material)
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.rotation_euler = location, Euler(turn)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def cone(sides, bottom, top, height, triangles=False):
    return lambda mesh: bmesh.ops.create_cone(mesh, cap_ends=True, cap_tris=triangles, segments=sides, radius1=bottom,
                                              radius2=top, depth=height)


def creature(mesh):
    """20,480 faces, whose folds are no wider than a few of them."""
    bmesh.ops.create_icosphere(mesh, subdivisions=6, radius=0.75)
    for vertex in mesh.verts:
        x, y, z = vertex.co
        folds = math.sin(23 * x + 2 * math.sin(9 * z)) * math.sin(19 * y + 1) * math.sin(21 * z + 3 * math.sin(7 * x))
        vertex.co *= 1.0 + 0.09 * folds + 0.12 * math.sin(4 * x) * math.sin(3 * y + 1)


# ---- Materials: pure shaders -----------------------------------------------------------------------------------------


def material(kind, color, roughness=0.0, image=None, strength=1.0):
    result = bpy.data.materials.new(f"{kind.title()}{len(bpy.data.materials)}")
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    node = {"diffuse": "ShaderNodeBsdfDiffuse", "glossy": "ShaderNodeBsdfGlossy", "emission": "ShaderNodeEmission",
            "principled": "ShaderNodeBsdfPrincipled"}[kind]
    shader = tree.nodes.new(node)
    socket = shader.inputs["Base Color" if kind == "principled" else "Color"]
    socket.default_value = (*color, 1.0)
    if image is not None:
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        tree.links.new(texture.outputs["Color"], socket)
    if kind == "emission":
        shader.inputs["Strength"].default_value = strength
    else:
        shader.inputs["Roughness"].default_value = roughness
    if kind == "glossy":
        shader.distribution = "GGX"
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return result


def picture(name):
    """Soft waves of colour, 64×64, packed; no sharp edges, which two programs would filter differently."""
    y, x = np.mgrid[0:64, 0:64] * (2 * math.pi / 64)
    rgb = np.stack([0.6 + 0.3 * np.sin(x), 0.55 + 0.3 * np.cos(2 * y), 0.5 + 0.3 * np.sin(x + y)], -1)
    result = bpy.data.images.new(name, 64, 64, alpha=False)
    result.pixels.foreach_set(np.dstack([rgb, np.ones((64, 64))]).astype(np.float32).ravel())
    result.pack()
    return result


def diffuse_set():
    return {"Floor": material("diffuse", (0.8, 0.78, 0.74)), "Back": material("diffuse", (0.75, 0.75, 0.8)),
            "Side": material("diffuse", (0.8, 0.2, 0.12)), "Ball": material("diffuse", (0.7, 0.7, 0.3)),
            "Box": material("diffuse", (0.25, 0.5, 0.8)), "Ring": material("diffuse", (0.8, 0.8, 0.8)),
            "Small": material("diffuse", (0.3, 0.75, 0.35))}


def diffuse_and_glossy_set(small=0.0):
    """Diffuse surfaces, glossy ones of roughness 0.1 to 0.7, and a mirror. The floor and the side, which light meets
    first, are diffuse: caustics of caustics would need thousands of samples on both sides."""
    return {**diffuse_set(), "Back": material("glossy", (0.7, 0.7, 0.8), 0.7),
            "Ball": material("glossy", (0.9, 0.8, 0.5), 0.1), "Ring": material("glossy", (0.8, 0.8, 0.8), 0.6),
            "Small": material("glossy", (0.9, 0.9, 0.9), small)}


def diffuse_and_glossy_set_for_points():
    """A mirror shows no light without extent; made rougher by the filter for glossy paths it makes fireflies of
    them."""
    return diffuse_and_glossy_set(0.3)


def textured_set():
    waves = picture("Waves")
    white = (1.0, 1.0, 1.0)
    return {"Floor": material("diffuse", white, image=waves), "Back": material("diffuse", white, image=waves),
            "Side": material("diffuse", (0.8, 0.2, 0.12)), "Ball": material("diffuse", white, image=waves),
            "Box": material("glossy", white, 0.4, waves), "Ring": material("glossy", white, 0.3, waves),
            "Small": material("glossy", white, 0.6, waves)}


# ---- The room, lights, cameras ---------------------------------------------------------------------------------------


def room(materials):
    quad("Floor", (-2.5, -2.5, 0), (5, 0, 0), (0, 4.5, 0), materials["Floor"])
    quad("Back", (-2.5, 2, 0), (5, 0, 0), (0, 0, 3), materials["Back"])
    quad("Side", (-2.5, -2.5, 0), (0, 4.5, 0), (0, 0, 3), materials["Side"])
    ball("Ball", (-1.0, 0.5, 0.85), 0.85, materials["Ball"])
    box("Box", (1.15, 0.7, 0), 1.2, materials["Box"])
    torus("Ring", (0.25, -1.0, 0.22), 0.5, 0.22, materials["Ring"])
    ball("Small", (1.5, -0.9, 0.4), 0.4, materials["Small"])


def aim(thing, place, target):
    thing.location = place
    thing.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()


def lamp(kind, energy, place, target=(0, 0, 0.6), color=(1, 1, 1), **settings):
    data = bpy.data.lights.new(kind.title(), kind)
    data.energy = energy
    data.color = color
    data.shadow_soft_size = 0.0
    for name, value in settings.items():
        setattr(data, name, value)
    thing = bpy.data.objects.new(data.name, data)
    bpy.context.scene.collection.objects.link(thing)
    aim(thing, place, target)
    return thing


def camera(place=(0.6, -6.2, 2.6), target=(0.0, 0.0, 0.85), **settings):
    data = bpy.data.cameras.new("Camera")
    data.lens = 38
    for name, value in settings.items():
        setattr(data, name, value)
    thing = bpy.data.objects.new("Camera", data)
    bpy.context.scene.collection.objects.link(thing)
    aim(thing, place, target)
    bpy.context.scene.camera = thing


KEY, HIGH = (1.6, -2.6, 3.4), (0.6, -0.8, 3.2)
LAMPS = {
    "point": lambda: lamp("POINT", 700, KEY),
    "point_soft": lambda: lamp("POINT", 700, KEY, shadow_soft_size=0.35),
    "spot": lambda: lamp("SPOT", 2500, KEY, spot_size=math.radians(70), spot_blend=0.6),
    "spot_soft": lambda: lamp("SPOT", 2500, KEY, spot_size=math.radians(80), spot_blend=0.3, shadow_soft_size=0.2),
    "sun": lambda: lamp("SUN", 4, KEY, angle=math.radians(8)),
    "area_square": lambda: lamp("AREA", 400, HIGH, shape="SQUARE", size=1.2),
    "area_rectangle": lambda: lamp("AREA", 400, HIGH, shape="RECTANGLE", size=2.0, size_y=0.5),
    "area_disc": lambda: lamp("AREA", 400, HIGH, shape="DISK", size=1.2),
    "area_ellipse": lambda: lamp("AREA", 400, KEY, shape="ELLIPSE", size=1.8, size_y=0.7),
}


def world(color, strength):
    result = bpy.context.scene.world = bpy.data.worlds.new("World")
    result.use_nodes = True
    background = next(node for node in result.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength


# ---- Scenes ----------------------------------------------------------------------------------------------------------


def panel(strength):
    """Away from the walls, and of small triangles: Cycles 3.4 is up to 0.5% too dark where a triangle is wider than its
    plane is far."""
    shine = material("emission", (1.0, 0.85, 0.6), strength=strength)
    quad("Panel", (-0.7, 0.7, 2.05), (1.6, 0, 0), (0, -0.35, 0.5), shine, 8)


def emissive():
    """A panel and a sphere that emit; both are visible."""
    room(diffuse_set())
    panel(12)
    ball("Lantern", (0.4, 0.2, 1.5), 0.25, material("emission", (0.4, 0.6, 1.0), strength=15))


def rough():
    """Diffuse roughness from a quarter to all of it, in direct light at every angle, in bounced light, and before a
    rough metal, whose highlights on diffuse surfaces Cycles blurs by the densities of the path."""
    materials = diffuse_set()
    for step, name in enumerate(("Side", "Back", "Floor", "Ball", "Ring", "Box")):
        node = materials[name].node_tree.nodes["Diffuse BSDF"]
        node.inputs["Roughness"].default_value = (0.25, 0.5, 1.0, 1.0, 0.75, 1.0)[step]
    materials["Small"] = material("glossy", (0.9, 0.9, 0.9), 0.5)
    room(materials)
    lamp("AREA", 400, HIGH, shape="SQUARE", size=1.2)


def coarse():
    """Shading normals that mirror the line of sight into the surface, which Cycles bends: low-poly shapes shaded
    smooth, caps as fans of triangles among them, and a dense folded one."""
    materials = diffuse_set()
    quad("Floor", (-2.5, -2.5, 0), (5, 0, 0), (0, 4.5, 0), materials["Floor"])
    quad("Back", (-2.5, 2, 0), (5, 0, 0), (0, 0, 3), materials["Back"])
    solid("Creature", creature, (-1.35, 0.3, 0.95), materials["Ball"])
    solid("Cylinder", cone(8, 0.5, 0.5, 1.3), (0.1, 0.5, 0.75), materials["Side"], (0.2, 0.1, 0.3))
    solid("Fan", cone(9, 0.7, 0.7, 0.3, True), (0.3, -1.1, 0.3), materials["Small"], (0.3, 0.2, 0.0))
    solid("Cone", cone(6, 0.6, 0.0, 1.4), (1.5, 0.6, 0.8), material("glossy", (0.9, 0.8, 0.5), 0.5), (0.1, -0.2, 0.4))
    rough_clay = material("diffuse", (0.8, 0.8, 0.8), 0.8)
    solid("Trunk", cone(5, 0.45, 0.3, 0.9), (1.6, -0.9, 0.5), rough_clay, (0.0, 0.3, 0.2))
    lamp("AREA", 300, HIGH, shape="SQUARE", size=1.2)
    world((0.6, 0.75, 1.0), 0.2)


def bent():
    matrix_bends.build(sys.modules[__name__])
    lamp("AREA", 400, HIGH, shape="SQUARE", size=1.2)
    world((0.6, 0.75, 1.0), 0.2)


def world_only():
    room(diffuse_set())
    world((0.6, 0.75, 1.0), 1.5)


def mixed():
    materials = diffuse_set()
    materials.update(Floor=material("glossy", (0.6, 0.6, 0.6), 0.7), Ball=material("glossy", (0.9, 0.8, 0.5), 0.15),
                     Small=material("glossy", (0.9, 0.9, 0.9), 0.0))
    room(materials)
    panel(8)
    lamp("AREA", 150, HIGH, shape="DISK", size=1.0)
    lamp("POINT", 250, KEY, color=(0.7, 0.85, 1.0), shadow_soft_size=0.3)
    world((0.5, 0.7, 1.0), 0.1)


def stretched():
    """Uneven and negative scale, of meshes with one user and with two."""
    room(diffuse_set())
    things = bpy.data.objects
    things["Ball"].scale = (0.9, 0.6, 1.1)
    things["Box"].scale = (-1.0, 0.7, 1.2)
    things["Ring"].scale = (1.1, -0.8, 0.7)
    twin = things["Small"].copy()
    twin.name = "Twin"
    twin.location, twin.scale = (0.3, 0.9, 0.7), (0.7, 1.3, -1.5)
    bpy.context.scene.collection.objects.link(twin)
    lamp("AREA", 400, HIGH, shape="SQUARE", size=1.0)


def instances():
    """A collection that stands in two places, turned and scaled, and a mesh that two objects share."""
    room(diffuse_set())
    group = bpy.data.collections.new("Group")
    for name in ("Ring", "Small"):
        bpy.context.scene.collection.objects.unlink(bpy.data.objects[name])
        group.objects.link(bpy.data.objects[name])
    for name, place, turn, scale in (("First", (0.1, 0.1, 0.0), 0.2, 1.0), ("Second", (-0.9, -0.6, 0.0), 2.2, 0.7)):
        empty = bpy.data.objects.new(name, None)
        empty.instance_type, empty.instance_collection = "COLLECTION", group
        empty.location, empty.rotation_euler, empty.scale = place, Euler((0, 0, turn)), (scale, scale, scale)
        bpy.context.scene.collection.objects.link(empty)
    twin = bpy.data.objects["Box"].copy()
    twin.name, twin.location, twin.scale = "Twin", (0.2, 1.3, 0.0), (0.5, 0.5, 1.2)
    bpy.context.scene.collection.objects.link(twin)
    lamp("POINT", 700, KEY, shadow_soft_size=0.2)


def principled():
    """A scene that a cross-check renders with pure shaders in the place of Principled ones."""
    waves = picture("Waves")
    materials = {name: material("principled", color, 0.5) for name, color in (
        ("Floor", (0.8, 0.78, 0.74)), ("Back", (0.75, 0.75, 0.8)), ("Side", (0.8, 0.2, 0.12)),
        ("Small", (0.9, 0.9, 0.9)))}
    materials["Ball"] = material("principled", (0.9, 0.8, 0.5), 0.3)
    materials["Box"] = material("principled", (1, 1, 1), 0.4, waves)
    materials["Ring"] = material("principled", (1, 1, 1), 0.4, waves)
    for name in ("Ball", "Ring"):
        materials[name].node_tree.nodes["Principled BSDF"].inputs["Metallic"].default_value = 1.0
    room(materials)
    lamp("AREA", 400, HIGH, shape="SQUARE", size=1.0)


def camera_scene(**settings):
    def build():
        room(diffuse_set())
        lamp("SUN", 4, KEY, angle=0.0)
        camera(**settings)
    return build


def shapes():
    matrix_shapes.build(material("diffuse", (0.5, 0.5, 0.5)))


def hair(shape):
    def build():
        room(diffuse_set())
        for name in ("Ball", "Box", "Ring", "Small"):
            bpy.data.objects.remove(bpy.data.objects[name])
        matrix_hair.build([material("diffuse", (0.6, 0.6, 0.6)), material("diffuse", (0.7, 0.5, 0.2)),
                           material("diffuse", (1, 1, 1), 0.5, picture("Waves"))], shape)
        lamp("SUN", 4, KEY, angle=0.0)
    return build


DIFFUSE_LAYERS = ["full", "LDE", "LDDE", "LD12E"]
SCENES = {  # builder, layers, size, samples, bounces
    "emissive": (emissive, DIFFUSE_LAYERS, LARGER, 256, 8),
    "rough": (rough, DIFFUSE_LAYERS + ["LSE"], LANDSCAPE, 128, 8),
    "coarse": (coarse, DIFFUSE_LAYERS + ["LSE"], LARGER, 64, 8),
    "bent": (bent, DIFFUSE_LAYERS + ["LSE"], LANDSCAPE, 64, 8),
    "world": (world_only, DIFFUSE_LAYERS, LANDSCAPE, 64, 8),
    "mixed": (mixed, DIFFUSE_LAYERS + ["LSE"], LARGER, 128, 8),
    "stretched": (stretched, DIFFUSE_LAYERS, LARGER, 32, 8),
    "instances": (instances, DIFFUSE_LAYERS, LANDSCAPE, 32, 8),
    "principled": (principled, DIFFUSE_LAYERS + ["LSE"], LARGER, 128, 8),
    "orthographic": (camera_scene(type="ORTHO", ortho_scale=6.0), DIFFUSE_LAYERS, LARGER, 32, 8),
    "shapes": (shapes, [], "240x135", 0, 0),
}
# AUTO is HORIZONTAL in a landscape and VERTICAL in a portrait, but for the sensor's side that it reads.
for fit, way in (("AUTO", LANDSCAPE), ("AUTO", PORTRAIT), ("HORIZONTAL", PORTRAIT), ("VERTICAL", LANDSCAPE)):
    SCENES[f"fit_{fit.lower()}_{way}"] = (
        camera_scene(sensor_fit=fit, sensor_height=30.0, shift_x=0.12, shift_y=-0.08), [], way, 0, 0)
SHARP_LAMPS = ("point", "spot")
BOUNCED_LAMPS = ("spot_soft", "sun")  # of the others' kinds there are scenes above that compare bounced light
for lamp_name, add_lamp in LAMPS.items():
    def build(make_set=diffuse_and_glossy_set_for_points if lamp_name in SHARP_LAMPS else diffuse_and_glossy_set,
              add_lamp=add_lamp):
        room(make_set())
        add_lamp()
    bounced = lamp_name in BOUNCED_LAMPS
    SCENES[lamp_name] = (build, ["full", "LDE", "LD12E", "LSE"] + ["LDDE"] * bounced, LARGER if bounced else LANDSCAPE,
                         32 if lamp_name in SHARP_LAMPS else 128, 8 if bounced else 0)


def textured():
    """A texture is read alike under any lamp."""
    room(textured_set())
    LAMPS["area_square"]()


SCENES["textured"] = (textured, ["full", "LDE", "LSE"], LANDSCAPE, 128, 8)


HAIR = {  # made only where they are named: they have limits of their own
    "hair": (hair("RIBBONS"), ["LDE"], LANDSCAPE, 16, 8),
    "hair_round": (hair("THICK"), ["LDE"], LANDSCAPE, 16, 8),
}


def save(folder, name, pixels):
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = (int(side) for side in pixels.split("x"))
    render.resolution_percentage = 100
    if bpy.context.scene.camera is None:
        camera()
    bpy.context.view_layer.update()
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}.blend"), compress=True)


def main():
    parser = argparse.ArgumentParser(prog="make_matrix.py", description="Makes the scenes of cycles_matrix_test.cpp.")
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    chosen = [name for name in arguments.only.split(",") if name] or list(SCENES)
    listed = {}
    for name in chosen:
        build, layers, pixels, samples, bounces = {**SCENES, **HAIR}[name]
        bpy.ops.wm.read_factory_settings(use_empty=True)
        build()
        save(arguments.output.resolve(), name, pixels)
        listed[name] = {"layers": layers, "size": pixels, "samples": samples, "bounces": bounces}
    (arguments.output / "matrix.json").write_text(json.dumps(listed, indent=1))


if __name__ == "__main__":
    try:
        main()
    except Exception:
        traceback.print_exc()
        sys.exit(1)
