"""Makes the sample scenes. Licence of the scenes: CC0-1.0.

    blender -b -noaudio --factory-startup -P blender_scripts/make_scenes.py -- --output scenes [--only NAME]
                                                                               [--preview DIR]

Running it twice gives the same bytes. `--preview` also renders each scene with Cycles, 960×540.
"""

import argparse
import math
import sys
import traceback
from pathlib import Path

import bmesh
import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
from export_nodes import principled_input  # noqa: E402
import scene_kit as kit  # noqa: E402  (Blender does not put a script's own folder on the path)
from scene_kit import Shape, spline  # noqa: E402


def three_lamps(target, reach):
    """The key from the upper left over the viewer's shoulder, as for the bundled exemplars; a cooler fill from the
    right, a rim from behind. One light of each kind that glTF has."""
    x, y, z = target
    kit.lamp("Key", "SUN", (x - 2 * reach, y - 2.4 * reach, z + 2.6 * reach), target, 2.6, (1.0, 0.96, 0.9))
    kit.lamp("Fill", "POINT", (x + 1.9 * reach, y - 1.6 * reach, z + 0.8 * reach), target, 28 * reach**2,
             (0.75, 0.85, 1.0))
    kit.lamp("Rim", "SPOT", (x + 1.2 * reach, y + 2.2 * reach, z + 2.2 * reach), target, 160 * reach**2,
             (1.0, 0.9, 0.75), 60.0)


def plinth(radius, height, edge):
    """The profile of a round slab with a soft upper edge, its top at z = 0. Rings that lie close together keep the
    smooth normals of the flat parts flat."""
    flat = [(r, 0.0) for r in np.linspace(0, radius - edge, 8)[:-1]] + [(radius - edge - 0.004, 0.0)]
    rounding = [(radius - edge + edge * math.sin(a), -edge + edge * math.cos(a))
                for a in np.linspace(0, math.pi / 2, 12)]
    foot = [(radius, -height + 0.024), (radius, -height + 0.02), (radius - 0.02, -height), (radius - 0.024, -height)]
    return flat + rounding + foot + [(0.0, -height)]


# ---- suzanne --------------------------------------------------------------------------------------------------------


def monkey(name, skin, eyes):
    """Blender's monkey, smooth, its two eyeballs in a material of their own."""
    mesh = bmesh.new()
    bmesh.ops.create_monkey(mesh)
    islands = []
    unseen = set(mesh.faces)
    for seed in mesh.faces:  # in order, so that the result does not depend on the set
        if seed not in unseen:
            continue
        island, front = [], [seed]
        unseen.discard(seed)
        while front:
            face = front.pop()
            island.append(face)
            for neighbour in (f for e in face.edges for f in e.link_faces if f in unseen):
                unseen.discard(neighbour)
                front.append(neighbour)
        islands.append(island)
    largest = max(len(island) for island in islands)
    for island in islands:
        for face in island:
            face.smooth = True
            face.material_index = 0 if len(island) == largest else 1
    data = bpy.data.meshes.new(name)
    mesh.to_mesh(data)
    mesh.free()
    data.materials.append(skin)
    data.materials.append(eyes)
    result = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(result)
    result.modifiers.new("Subdivision", "SUBSURF").levels = 2
    result.modifiers["Subdivision"].render_levels = 2
    return result


def suzanne():
    skin = kit.material("Skin", (0.60, 0.27, 0.12))
    eyes = kit.material("Eyes", (0.85, 0.82, 0.74), 0.2)
    stone = kit.material("Plinth", (0.5, 0.5, 0.5), 0.8,
                         kit.checker("PlinthChecker", 128, 8, (0.72, 0.70, 0.64), (0.42, 0.46, 0.50)))
    head = monkey("Suzanne", skin, eyes)
    head.rotation_euler = Euler((math.radians(-14), math.radians(4), math.radians(20)))
    bpy.context.view_layer.update()
    head.location = (0.0, 0.1, -0.02 - kit.lowest(head))
    Shape().lathe(plinth(1.80, 0.24, 0.11), 96).place("Plinth", stone, keep_uv=True)
    Shape().ball((0, 0, 0), (0.34, 0.34, 0.34), 32, 48).place("Ball", kit.material("Ball", (0.10, 0.32, 0.55), 0.3),
                                                             (-1.22, -0.80, 0.34))
    turn = np.linspace(0, 2 * math.pi, 64, endpoint=False)
    ring = np.stack([0.30 * np.cos(turn), 0.30 * np.sin(turn), 0 * turn], 1)
    Shape().tube(ring, 0.11, 24, closed=True).place("Ring", kit.material("Ring", (0.75, 0.55, 0.10), 0.3),
                                                    (1.20, -0.80, 0.11))
    three_lamps((0, 0, 0.8), 1.6)
    kit.camera("Camera", (0.0, -7.8, 2.7), (0.0, 0.0, 0.72), 71)


# ---- snail ----------------------------------------------------------------------------------------------------------


def ground_height(x, y):
    """A gentle mound."""
    return 0.10 * math.sin(1.3 * x + 0.4) * math.cos(1.7 * y) - 0.05 * (x * x / 3 + y * y)


def mound(radius_x, radius_y):
    """Undulating ground, closed below: the edge turns down like a quarter of a circle."""
    lip = 0.16
    turn = np.linspace(0, math.pi / 2, 10)
    profile = [(r, 0.0) for r in np.linspace(0, 1 - lip, 26)[:-1]]
    profile += [(1 - lip + lip * math.sin(a), 2 * lip * (1 - math.cos(a))) for a in turn]
    profile += [(1.0, 0.42), (0.99, 0.44), (0.0, 0.44)]
    rings = []
    for r, drop in profile:
        ring = [(r * radius_x * math.cos(a), r * radius_y * math.sin(a))
                for a in np.linspace(0, 2 * math.pi, 96, endpoint=False)]
        rings.append([(x, y, ground_height(x, y) - drop) for x, y in ring])
    return rings


def shell_rings(radius, shrink_per_turn, turns, rise):
    """A logarithmic spiral whose tube is as wide as makes the whorls touch; ribbed. Counter-clockwise inward, seen by
    the camera; the apex stands towards it."""
    width = 1.42 * (1 - shrink_per_turn) / (1 + shrink_per_turn)
    steps = int(90 * turns)
    section = np.linspace(0, 2 * math.pi, 40, endpoint=False)
    closing = np.sqrt(1 - np.clip(1 - (steps - np.arange(steps + 1)) / 10, 0, 1) ** 2)  # the apex is round
    rings = []
    for i in range(steps + 1):
        turn = turns * i / steps
        r = radius * shrink_per_turn**turn
        angle = math.radians(-105) + 2 * math.pi * turn
        out = np.array([math.cos(angle), 0, math.sin(angle)])
        tube = width * r * (1 + 0.035 * math.cos(15 * 2 * math.pi * turn)) * closing[i]
        center = out * r + np.array([0, -rise * (1 - r / radius), 0])
        rings.append(center + tube * (np.cos(section)[:, None] * out + np.sin(section)[:, None] * np.array([0, 1, 0])))
    mouth = np.mean(rings[0], axis=0)
    return [np.tile(mouth, (40, 1)), mouth + 0.5 * (rings[0] - mouth)] + rings


def snail_body(parent_turn):
    body = kit.material("Body", (0.55, 0.42, 0.25), 0.5)
    knots = [(1.75, 0, 0.03, 0.03, 1.0), (1.30, 0, 0.12, 0.15, 1.6), (0.6, 0, 0.20, 0.27, 1.6),
             (-0.4, 0, 0.22, 0.32, 1.5), (-0.95, 0, 0.34, 0.34, 1.25), (-1.30, 0, 0.78, 0.28, 1.0),
             (-1.48, 0, 1.20, 0.28, 1.0), (-1.76, 0, 1.34, 0.21, 1.05), (-1.92, 0, 1.34, 0.12, 1.0)]
    curve = spline(knots, 110)
    radii = curve[:, 3] * kit.round_cap(7, len(curve))
    at, turn = (0, 0, 0.06), (0, 0, parent_turn)
    Shape().tube(curve[:, :3], radii, 40, curve[:, 4]).place("SnailBody", body, at, turn)
    for side, name in ((-1, "Near"), (1, "Far")):
        stalk = spline([(-1.55, 0.12 * side, 1.36), (-1.60, 0.22 * side, 1.68), (-1.74, 0.36 * side, 2.00)], 20)
        Shape().tube(stalk, np.linspace(0.085, 0.05, 20), 20).ball(stalk[-1], (0.105,) * 3, 16, 20).place(
            "Stalk" + name, body, at, turn)
        feeler = spline([(-1.84, 0.09 * side, 1.31), (-2.00, 0.13 * side, 1.22), (-2.12, 0.19 * side, 1.18)], 12)
        Shape().tube(feeler, 0.05 * kit.round_cap(4, 12), 16).place("Feeler" + name, body, at, turn)
    shell = kit.material("Shell", (0.62, 0.25, 0.10), 0.35)
    spiral = Shape().grid(shell_rings(0.86, 0.46, 4.0, 0.55), wrap_columns=True)
    spiral.ball((0, -0.55, 0), (0.06, 0.06, 0.06), 12, 16)
    spiral.place("Shell", shell, (0.10 * math.cos(math.radians(parent_turn)),
                                  0.10 * math.sin(math.radians(parent_turn)), 1.28), (0, -6, parent_turn))


def mushroom(name, x, y, height, cap_radius, lean, cap, stem, spots):
    base = ground_height(x, y) - 0.08
    foot = cap_radius * 0.36
    stalk = spline([(0, 0, 0, 1.25), (0.02, 0, 0.18 * height, 1.2), (-0.02, 0, 0.6 * height, 0.75),
                    (0, 0, 1.02 * height, 0.8)], 28)
    Shape().tube(stalk[:, :3], foot * stalk[:, 3], 32).place(name + "Stem", stem, (x, y, base), (0, lean, 0))
    profile = spline([(0.0, 0.62), (0.35, 0.58), (0.72, 0.36), (0.96, 0.03), (0.97, -0.10), (0.86, -0.10),
                      (0.5, 0.04), (0.2, 0.08), (0.0, 0.08)], 56) * cap_radius
    profile[0, 0] = profile[-1, 0] = 0.0
    tilt = Euler((0, math.radians(lean), 0)).to_matrix()
    top = Vector((x, y, base)) + tilt @ Vector((0, 0, height))
    Shape().lathe(np.maximum(profile, [[0.0, -9.0]]), 64,
                  lambda a, z: 1 + 0.03 * math.sin(3 * a + 1) + 0.02 * math.sin(5 * a)).place(
        name + "Cap", cap, top, (0, lean, 0))
    dots = Shape()
    for turn, along, size in spots:
        r, z = spline([(0.0, 0.62), (0.35, 0.58), (0.72, 0.36), (0.96, 0.03)], 64)[int(along * 63)] * cap_radius
        a = math.radians(turn)
        dots.ball((r * math.cos(a), r * math.sin(a), z - 0.01), (size, size, size * 0.8), 14, 18)
    if spots:
        dots.place(name + "Spots", kit.material(name + "Spots", (0.86, 0.82, 0.72)), top, (0, lean, 0))


def pebble(name, x, y, radii, seed, color):
    waves = [(Vector((math.sin(seed * k), math.cos(1.7 * seed * k), math.sin(2.3 * seed + k))), 1.1 + 0.4 * k)
             for k in range(1, 5)]
    Shape().ball((0, 0, 0), radii, 28, 36, lambda d: 1 + sum(0.05 * math.sin(f * w.dot(d) + seed) for w, f in waves)
                 ).place(name, color, (x, y, ground_height(x, y) + 0.55 * radii[2]), (0, 0, 40 * seed))


def snail():
    soil = kit.material("Moss", (0.17, 0.30, 0.08), 0.9)
    Shape().grid(mound(3.0, 1.9), wrap_columns=True).place("Mound", soil)
    snail_body(26)
    stem = kit.material("Stem", (0.80, 0.72, 0.55))
    red = kit.material("RedCap", (0.62, 0.07, 0.04), 0.35)
    ochre = kit.material("OchreCap", (0.66, 0.38, 0.10), 0.4)
    dots = [(-90, 0.35, 0.10), (-150, 0.55, 0.12), (-30, 0.6, 0.10), (-75, 0.78, 0.08), (-115, 0.85, 0.07),
            (60, 0.4, 0.1), (130, 0.55, 0.1), (-5, 0.3, 0.07), (-172, 0.85, 0.07), (-45, 0.9, 0.06)]
    mushroom("Tall", 1.75, 0.85, 1.75, 0.85, 6, red, stem, dots)
    mushroom("Small", 1.65, -0.50, 0.78, 0.48, -9, ochre, stem, [])
    mushroom("Tiny", 2.25, -0.35, 0.50, 0.32, 14, ochre, stem, [])
    fern = kit.material("Fern", (0.25, 0.42, 0.10), 0.6)
    for name, x, y, height, size in (("FernTall", -2.05, 0.80, 1.70, 0.36), ("FernSmall", -2.70, 0.45, 1.05, 0.26)):
        coil = [(size * 0.86**k * math.cos(0.55 * k), 0.012 * k, size * 0.86**k * math.sin(0.55 * k) + height)
                for k in range(14)]
        stalk = [(size + 0.10, 0, 0), (size + 0.12, 0, 0.35 * height), (size + 0.03, 0, 0.75 * height)]
        path = spline(stalk + coil, 150)
        Shape().tube(path, np.linspace(0.08, 0.022, 150) * kit.round_cap(3, 150), 16).place(
            name, fern, (x, y, ground_height(x + size, y) - 0.1))
    grey = kit.material("Pebble", (0.35, 0.36, 0.38), 0.7)
    pale = kit.material("PalePebble", (0.62, 0.58, 0.52), 0.7)
    pebble("PebbleA", -2.05, -0.75, (0.36, 0.28, 0.22), 1, grey)
    pebble("PebbleB", -0.15, -1.25, (0.22, 0.18, 0.14), 2, pale)
    pebble("PebbleC", 0.60, -1.15, (0.34, 0.27, 0.20), 3, pale)
    three_lamps((0, 0, 0.9), 1.9)
    kit.camera("Camera", (0.0, -9.0, 2.6), (0.0, 0.0, 0.95), 56)


# ---- stilllife ------------------------------------------------------------------------------------------------------


def leaf(length, width, curl):
    """A blade along +X, folded along its middle, bent down towards the tip."""
    return [[(length * t, width * s * math.sin(math.pi * t**0.75) ** 0.9, 0.35 * width * abs(s) *
              math.sin(math.pi * t) - curl * t * t) for s in (-1, -0.6, -0.25, 0, 0.25, 0.6, 1)]
            for t in np.linspace(0, 1, 14)]


def branch(name, knots, bark, green, count):
    """A branch with leaves on both sides, from halfway up."""
    path = spline(knots, 60)
    Shape().tube(path, np.linspace(0.032, 0.010, 60) * kit.round_cap(2, 60), 10).place(name, bark)
    blades = Shape()
    for i in range(count):
        at = 24 + int(35 * i / (count - 1))
        along = Vector(path[min(at + 1, 59)] - path[at - 1]).normalized()
        side = along.cross(Vector((0.3, -0.9, 0.25))).normalized() * (1 if i % 2 else -1)
        out = (0.55 * along + 0.8 * side + Vector((0, -0.15 * (i % 3), 0))).normalized()
        if i == count - 1:
            out = along
        across = out.cross(Vector((0.25 * (i % 4 - 1.5), -1.0, 0.5))).normalized()
        frame = Matrix((out, across, out.cross(across))).transposed()
        size = 0.44 - 0.16 * i / count
        blades.grid([[Vector(path[at]) + frame @ Vector(p) for p in row] for row in leaf(size, 0.24 * size, 0.12)])
    blades.place(name + "Leaves", green, closed=False)


def chair(at, turn):
    wood = kit.material("ChairWood", (0.20, 0.09, 0.04), 0.4)
    cane = kit.material("ChairSeat", (0.70, 0.50, 0.25), 0.7)
    seat = 0.92
    rim = plinth(0.50, 0.10, 0.045)
    Shape().lathe([(r, z + seat) for r, z in rim], 64).place("ChairSeat", cane, at, turn)
    frame = Shape()
    for x, y in ((-1, -1), (1, -1)):
        frame.tube(spline([(0.34 * x, 0.34 * y, seat - 0.05), (0.38 * x, 0.38 * y, 0.45), (0.45 * x, 0.44 * y, 0)],
                          24), 0.032, 12)
    hoop = [(-0.46, 0.46, 0.0), (-0.38, 0.38, 0.5), (-0.36, 0.36, seat), (-0.36, 0.44, 1.4), (-0.22, 0.50, 1.80),
            (0, 0.52, 1.92), (0.22, 0.50, 1.80), (0.36, 0.44, 1.4), (0.36, 0.36, seat), (0.38, 0.38, 0.5),
            (0.46, 0.46, 0.0)]
    frame.tube(spline(hoop, 120), 0.035, 12)
    inner = [(-0.20, 0.42, seat - 0.03), (-0.19, 0.45, 1.3), (-0.11, 0.49, 1.60), (0, 0.50, 1.66),
             (0.11, 0.49, 1.60), (0.19, 0.45, 1.3), (0.20, 0.42, seat - 0.03)]
    frame.tube(spline(inner, 80), 0.024, 12)
    circle = np.linspace(0, 2 * math.pi, 64, endpoint=False)
    frame.tube(np.stack([0.50 * np.cos(circle), 0.50 * np.sin(circle), 0 * circle + 0.42], 1), 0.022, 10, closed=True)
    frame.place("ChairFrame", wood, at, turn)


def curtain(width, height):
    """Hanging folds that widen downward."""
    rows = []
    for v in np.linspace(0, 1, 40):
        row = []
        for u in np.linspace(0, 1, 120):
            swing = (0.35 + 0.65 * v)
            x = width * ((u - 0.5) * (0.80 + 0.20 * v * v)) + 0.05 * math.sin(5 * v + 9 * u)
            fold = math.sin(2 * math.pi * (5.5 * u + 0.12 * math.sin(4 * v)))
            y = 0.14 * swing * fold * (0.8 + 0.2 * math.sin(9 * u))
            row.append((x, y, height * (1 - v)))
        rows.append(row)
    return rows


def fruit(name, kind, at, turn, color):
    pear = [(0.0, -0.02), (0.12, -0.05), (0.27, 0.05), (0.33, 0.22), (0.27, 0.42), (0.16, 0.58), (0.11, 0.70),
            (0.06, 0.76), (0.0, 0.75)]
    apple = [(0.0, 0.05), (0.09, 0.0), (0.22, 0.04), (0.31, 0.20), (0.30, 0.38), (0.19, 0.49), (0.07, 0.47),
             (0.0, 0.41)]
    profile = spline(pear if kind == "pear" else apple, 44)
    profile[0, 0] = profile[-1, 0] = 0.0
    top = profile[-1, 1]
    lumps = 0.02 if kind == "pear" else 0.035
    body = Shape().lathe(np.maximum(profile, [[0.0, -1.0]]), 56, lambda a, z: 1 + lumps * math.cos(5 * a) * z)
    body.tube(spline([(0, 0, top - 0.04), (0.02, 0, top + 0.08), (0.07, 0.02, top + 0.17)], 10),
              0.018 * kit.round_cap(2, 10), 10)
    body.place(name, color, at, turn)


def room():
    """Two flat walls and a floor, lower than the picture; on the wall a rippled dish, before it a curtain."""
    wall = kit.material("Wall", (0.55, 0.58, 0.60), 0.9)
    floor = kit.material("Floor", (0.40, 0.28, 0.18), 0.7)
    corner, turn = (-2.05, 1.75, 0), (0, 0, -12)
    Shape().box((5.2, 0.12, 2.35), (2.54, 0.06, 1.175)).place("WallRight", wall, corner, turn, bevel=0.03)
    Shape().box((0.12, 3.3, 2.35), (-0.06, -1.59, 1.175)).place("WallLeft", wall, corner, turn, bevel=0.03)
    Shape().box((5.32, 3.42, 0.14), (2.48, -1.53, -0.07)).place("Floor", floor, corner, turn, bevel=0.04)
    ripples = [(r, 0.05 * (1 - r) * math.cos(14 * r) + 0.05) for r in np.linspace(0, 0.46, 44)]
    ripples += [(0.50, 0.10), (0.53, 0.07), (0.52, 0.0), (0.0, 0.0)]
    Shape().lathe(spline(ripples, 120), 96).place("Dish", kit.material("Dish", (0.20, 0.42, 0.42), 0.3),
                                                  (0.42, 1.22, 1.62), (90, 0, -12))
    cloth = kit.material("Curtain", (0.50, 0.10, 0.12), 0.8)
    Shape().grid(curtain(1.25, 2.52)).place("Curtain", cloth, (2.15, 0.62, 0.06), turn, closed=False)
    stand = Shape()
    rail = [(-0.75, 0, 2.60), (0, 0, 2.61), (0.75, 0, 2.60)]
    stand.tube(spline(rail, 12), 0.028, 14).ball(rail[0], (0.06,) * 3, 16, 20).ball(rail[2], (0.06,) * 3, 16, 20)
    for x in (-0.66, 0.66):
        stand.tube([(x, 0.05, 0), (x, 0.05, 1.3), (x, 0.02, 2.60)], 0.022, 12)
    stand.place("CurtainStand", kit.material("Brass", (0.55, 0.40, 0.12), 0.3), (2.15, 0.62, 0), turn)


def stilllife():
    room()
    crate = kit.material("Crate", (0.46, 0.30, 0.14), 0.8)
    Shape().box((0.95, 0.80, 0.78), (0, 0, 0.39)).place("Crate", crate, (-0.85, 0.20, 0), (0, 0, 22), bevel=0.04)
    glaze = kit.material("Vase", (0.5, 0.6, 0.7), 0.25,
                         kit.marble("VaseMarble", 128, (0.86, 0.88, 0.86), (0.20, 0.36, 0.55)))
    outer = spline([(0.0, 0.0), (0.17, 0.0), (0.20, 0.03), (0.24, 0.20), (0.37, 0.48), (0.33, 0.74), (0.16, 0.93),
                    (0.13, 1.03), (0.21, 1.15)], 64)
    inner = spline([(0.20, 1.16), (0.11, 1.03), (0.14, 0.92), (0.28, 0.72), (0.0, 0.25)], 30)
    outer[0, 0] = inner[-1, 0] = 0.0
    vase = np.array([-0.85, 0.20, 0.78])
    Shape().lathe(np.vstack([outer, inner]), 96).place("Vase", glaze, vase, keep_uv=True)
    bark = kit.material("Bark", (0.16, 0.10, 0.06), 0.8)
    green = kit.material("Leaf", (0.16, 0.34, 0.10), 0.5)
    mouth = vase + np.array([0, 0, 1.0])
    for name, bends in (("BranchLeft", [(-0.12, -0.02, 0.35), (-0.55, -0.15, 0.75), (-1.05, -0.30, 0.85)]),
                        ("BranchUp", [(0.02, 0.05, 0.40), (-0.10, 0.05, 0.75), (0.10, 0.0, 1.08)]),
                        ("BranchRight", [(0.12, -0.05, 0.35), (0.45, -0.15, 0.70), (0.95, -0.25, 0.72)])):
        branch(name, [mouth - (0, 0, 0.5), mouth] + [mouth + np.array(b) for b in bends], bark, green, 11)
    chair((1.15, 0.10, 0), (0, 0, -28))
    wires = Shape()
    bmesh.ops.create_icosphere(wires.mesh, subdivisions=1, radius=0.40)
    edges = [(Vector(e.verts[0].co), Vector(e.verts[1].co)) for e in wires.mesh.edges]
    bmesh.ops.delete(wires.mesh, geom=list(wires.mesh.verts), context="VERTS")
    for a, b in edges:
        wires.tube([a, a.lerp(b, 0.5), b], 0.020, 10).ball(a, (0.035,) * 3, 10, 12).ball(b, (0.035,) * 3, 10, 12)
    wires.place("WireBall", kit.material("Wire", (0.75, 0.60, 0.20), 0.3), (-1.75, -0.55, 0.36), (20, 35, 0))
    fruit("Pear", "pear", (-0.62, -0.85, 0.05), (0, 0, 0), kit.material("Pear", (0.60, 0.56, 0.12), 0.4))
    fruit("FallenPear", "pear", (-0.12, -0.72, 0.30), (0, 78, 25), kit.material("RipePear", (0.66, 0.40, 0.10), 0.4))
    fruit("Apple", "apple", (0.30, -1.12, 0.0), (0, -12, 0), kit.material("Apple", (0.58, 0.08, 0.05), 0.3))
    three_lamps((0, 0, 1.0), 1.9)
    kit.camera("Camera", (0.1, -9.2, 2.9), (0.12, 0.0, 1.42), 53)


# ---- toys -----------------------------------------------------------------------------------------------------------


TOYS_FRAMES = range(1, 49)  # two seconds


def rolling_ball(color):
    """Rolls along +X without slipping."""
    radius = 0.36
    ball = Shape().ball((0, 0, 0), (radius,) * 3, 24, 36).place("Ball", color, keep_uv=True)
    kit.key(ball, "location", lambda t: (-1.35 + 2.7 * t, -1.05, radius), TOYS_FRAMES)
    kit.key(ball, "rotation_euler", lambda t: (math.radians(60), 2.7 * t / radius, 0), TOYS_FRAMES)


def dancer(color):
    """A skittle with two arms on three bones: turns once, and sways to both sides."""
    profile = spline([(0.0, 0.0), (0.40, 0.0), (0.46, 0.08), (0.36, 0.50), (0.22, 0.95), (0.17, 1.16), (0.26, 1.34),
                      (0.24, 1.54), (0.10, 1.64), (0.0, 1.65)], 44)
    profile[0, 0] = profile[-1, 0] = 0.0
    shape = Shape().lathe(np.maximum(profile, [[0.0, -1.0]]), 40)
    for side in (-1, 1):
        arm = spline([(0.16 * side, 0, 0.98), (0.48 * side, -0.04, 1.08), (0.66 * side, -0.10, 1.40)], 20)
        shape.tube(arm, 0.075 * kit.round_cap(4, 20), 10)
    shape.ball((0, -0.27, 1.43), (0.06, 0.10, 0.06), 8, 10)
    body = shape.place("Dancer", color)
    bones = kit.skeleton("DancerBones", (-0.62, 0.55, 0), (0.55, 0.55, 0.55))
    knees = (0.4, 0.9)  # heights at which one bone hands over to the next
    def weights(at):
        upper = [min(max((at.z - knee) / 0.35 + 0.5, 0.0), 1.0) for knee in knees]
        return 1 - upper[0], upper[0] - upper[1], upper[1]
    kit.bind(body, bones, weights)
    for i, bone in enumerate(bones.pose.bones):
        turn = 2 * math.pi if i == 0 else 0.0  # about the bone's own axis, which stands upright
        kit.key(bone, "rotation_euler",
                lambda t: (0.10 * i * math.sin(4 * math.pi * t), turn * t, 0.22 * i * math.sin(2 * math.pi * t)),
                TOYS_FRAMES)


def jelly(color):
    """Wobbles by a shape key: flat and wide, then tall and narrow."""
    profile = spline([(0.0, 0.0), (0.50, 0.0), (0.56, 0.06), (0.50, 0.45), (0.36, 0.68), (0.0, 0.74)], 24)
    profile[0, 0] = profile[-1, 0] = 0.0
    pudding = Shape().lathe(np.maximum(profile, [[0.0, -1.0]]), 56, lambda a, z: 1 + 0.05 * math.cos(8 * a)).place(
        "Jelly", color, (1.05, 0.45, 0))
    pudding.shape_key_add(name="Basis")
    squash = pudding.shape_key_add(name="Squash")
    for vertex, point in zip(pudding.data.vertices, squash.data):
        wide = 1 + 0.35 * vertex.co.z
        point.co = (wide * vertex.co.x, wide * vertex.co.y, 0.66 * vertex.co.z)
    squash.slider_min = -1.0
    kit.key(squash, "value", lambda t: math.sin(6 * math.pi * t) * (1 - 0.6 * t), TOYS_FRAMES)


def toys():
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = 24, TOYS_FRAMES[0], TOYS_FRAMES[-1]
    ground = [(0.0, 0.0), (1.2, 0.0), (2.18, 0.0), (2.2, 0.0), (2.27, -0.03), (2.30, -0.10), (2.30, -0.22),
              (2.28, -0.24), (0.0, -0.24)]
    Shape().lathe(ground, 64).place("Table", kit.material("Table", (0.50, 0.45, 0.36), 0.8))
    rolling_ball(kit.material("Ball", (0.6, 0.3, 0.1), 0.3, kit.checker("BallChecker", 64, 4, (0.85, 0.30, 0.20),
                                                                        (0.92, 0.88, 0.75))))
    dancer(kit.material("Dancer", (0.16, 0.34, 0.55), 0.4))
    jelly(kit.material("Jelly", (0.20, 0.45, 0.15), 0.3))
    Shape().ball((0, 0, 0.17), (0.3, 0.24, 0.17), 12, 18).place("Pebble",
                                                                kit.material("Pebble", (0.4, 0.38, 0.36), 0.8),
                                                               (0.35, 1.25, 0), (0, 0, 30))
    three_lamps((0, 0, 0.7), 1.8)
    eye = kit.camera("Camera", (0.0, -7.4, 3.2), (0.0, 0.0, 0.5), 52)
    target = Vector((0.0, 0.0, 0.5))
    def place(t):
        turn = math.radians(-9 + 18 * t)
        return Vector((7.4 * math.sin(turn), -7.4 * math.cos(turn), 3.2))
    kit.key(eye, "location", place, TOYS_FRAMES)
    kit.key(eye, "rotation_euler", lambda t: (target - place(t)).to_track_quat("-Z", "Y").to_euler(), TOYS_FRAMES)
    scene.frame_set(TOYS_FRAMES[0])


# ---- ball -----------------------------------------------------------------------------------------------------------


def ball():
    """A sphere on a floor before a wall, a classic exercise, under one square light at the place of the bundled
    exemplars' key. The light is a mesh that emits, for glTF has no area lights."""
    Shape().ball((0, 0, 0), (1, 1, 1), 96, 144).place("Ball", kit.material("Ball", (0.62, 0.36, 0.24), 0.25),
                                                      at=(0, 0, 1))
    # One quadrangle each: their normals are everywhere the same.
    floor = [[(-9, -9, 0), (9, -9, 0)], [(-9, 3, 0), (9, 3, 0)]]
    Shape().grid(floor).place("Floor", kit.material("Floor", (0.60, 0.53, 0.44), 1.0), closed=False)
    wall = [[(-9, 3, 0), (9, 3, 0)], [(-9, 3, 9), (9, 3, 9)]]
    Shape().grid(wall).place("Wall", kit.material("Wall", (0.46, 0.50, 0.54), 1.0), closed=False)
    shining = kit.material("Lamp", (0.0, 0.0, 0.0))
    shader = shining.node_tree.nodes["Principled BSDF"]
    principled_input(shader, "Emission").default_value = (1.0, 0.97, 0.92, 1.0)
    shader.inputs["Emission Strength"].default_value = 30.0
    at, target, half = Vector((-2.95, -3.52, 4.86)), Vector((0.0, 0.0, 1.0)), 0.8
    lamp = Shape().grid([[(-half, -half, 0), (half, -half, 0)], [(-half, half, 0), (half, half, 0)]], flip=True).place(
        "Lamp", shining, at, closed=False)
    lamp.rotation_euler = (target - at).to_track_quat("-Z", "Y").to_euler()
    kit.camera("Camera", (0.0, -7.6, 2.8), (0.32, 0.0, 0.90), 74)


SCENES = {"suzanne": suzanne, "snail": snail, "stilllife": stilllife, "toys": toys, "ball": ball}
MOVING = {"toys"}


def main():
    parser = argparse.ArgumentParser(prog="make_scenes.py", description="Makes the sample scenes.")
    parser.add_argument("--output", required=True, type=Path, help="folder for the .glb files")
    parser.add_argument("--only", choices=sorted(SCENES), help="make this one scene")
    parser.add_argument("--preview", type=Path, help="folder for Cycles pictures of 960×540")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    arguments.output.mkdir(parents=True, exist_ok=True)
    for name, build in SCENES.items():
        if arguments.only in (None, name):
            kit.clear()
            build()
            kit.export(arguments.output / (name + ".glb"), name in MOVING)
            if arguments.preview:
                kit.preview(arguments.preview / (name + ".png"))


if __name__ == "__main__":
    try:
        main()
    except Exception:  # Blender itself would print the traceback and exit with 0
        traceback.print_exc()
        sys.exit(1)
