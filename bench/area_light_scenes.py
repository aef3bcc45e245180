#!/usr/bin/env python3
"""Two scenes under area lights, for measuring what their light costs.

    /usr/bin/python3 bench/area_light_scenes.py FOLDER

ball.glb: a ball on a ground under a square lamp, seen as StyLit's exemplar scene is. level.glb: four rooms of some
2,400 triangles with doorways, pillars, stairs, shelves and crates, six area lights under their ceilings.
"""

import argparse
import json
import math
import random
import struct
from pathlib import Path

WALL, HEIGHT = 0.2, 3.0


class Scene:
    """Meshes without shared corners, so that faces are flat; a ball brings its own normals."""

    def __init__(self):
        self.meshes, self.nodes, self.data, self.views, self.accessors = [], [], b"", [], []

    def _accessor(self, values, kind):
        packed = b"".join(struct.pack("<3f", *value) for value in values)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed), "target": 34962})
        self.data += packed
        accessor = {"bufferView": len(self.views) - 1, "componentType": 5126, "count": len(values), "type": "VEC3"}
        if kind == "POSITION":
            accessor["min"] = [min(v[k] for v in values) for k in range(3)]
            accessor["max"] = [max(v[k] for v in values) for k in range(3)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def mesh(self, name, positions, normals):
        attributes = {"POSITION": self._accessor(positions, "POSITION"), "NORMAL": self._accessor(normals, "NORMAL")}
        self.meshes.append({"name": name, "primitives": [{"attributes": attributes, "material": 0}]})
        self.nodes.append({"name": name, "mesh": len(self.meshes) - 1})

    def boxes(self, name, boxes):
        """Boxes (low corner, high corner) as one object."""
        positions, normals = [], []
        for low, high in boxes:
            for axis in range(3):
                for side in (0, 1):
                    u, v = (axis + 1) % 3, (axis + 2) % 3
                    corners = []
                    for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        point = [0.0] * 3
                        point[axis] = (low, high)[side][axis]
                        point[u], point[v] = (low, high)[a][u], (low, high)[b][v]
                        corners.append(point)
                    if side == 0:
                        corners.reverse()
                    normal = [0.0] * 3
                    normal[axis] = 1.0 if side else -1.0
                    positions += [corners[k] for k in (0, 1, 2, 0, 2, 3)]
                    normals += [normal] * 6
        self.mesh(name, positions, normals)

    def ball(self, name, centre, radius, rings):
        def point(i, j):
            theta, phi = math.pi * i / rings, math.pi * j / rings
            return (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi))
        normals = []
        for i in range(rings):
            for j in range(2 * rings):
                a, b, c, d = point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)
                normals += [a, b, c] if i > 0 else []
                normals += [a, c, d] if i + 1 < rings else []
        self.mesh(name, [[centre[k] + radius * n[k] for k in range(3)] for n in normals], normals)

    def lamp(self, name, at, target, size, watts):
        self.nodes.append({"name": name, "matrix": look(at, target), "extras": {"scumble": {"lamp": {
            "type": "AREA", "energy": watts, "color": [1.0, 1.0, 1.0], "shape": "SQUARE", "size": size,
            "size_y": size}}}})

    def write(self, path, at, target, angle):
        self.nodes.append({"name": "Camera", "camera": 0, "matrix": look(at, target)})
        gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(self.nodes)))}],
                "nodes": self.nodes, "meshes": self.meshes, "accessors": self.accessors, "bufferViews": self.views,
                "buffers": [{"byteLength": len(self.data)}],
                "materials": [{"name": "plaster", "pbrMetallicRoughness": {"metallicFactor": 0.0}}],
                "cameras": [{"type": "perspective",
                             "perspective": {"yfov": math.radians(angle), "znear": 0.05, "zfar": 200.0}}]}
        text = json.dumps(gltf).encode()
        text += b" " * (-len(text) % 4)
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.data)) +
                         struct.pack("<II", len(text), 0x4E4F534A) + text +
                         struct.pack("<II", len(self.data), 0x004E4942) + self.data)

    def triangles(self):
        return sum(self.accessors[m["primitives"][0]["attributes"]["POSITION"]]["count"] // 3 for m in self.meshes)


def look(at, target):
    """The matrix, by columns, of a camera or lamp there that looks at `target`."""
    back = [a - t for a, t in zip(at, target)]
    length = math.sqrt(sum(c * c for c in back))
    z = [c / length for c in back]
    up = (0.0, 1.0, 0.0) if abs(z[1]) < 0.999 else (0.0, 0.0, -1.0)
    x = [up[1] * z[2] - up[2] * z[1], up[2] * z[0] - up[0] * z[2], up[0] * z[1] - up[1] * z[0]]
    length = math.sqrt(sum(c * c for c in x))
    x = [c / length for c in x]
    y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    return [*x, 0.0, *y, 0.0, *z, 0.0, *at, 1.0]


def make_ball(path):
    scene = Scene()
    scene.boxes("Ground", [((-20.0, -0.5, -20.0), (20.0, 0.0, 20.0))])
    scene.ball("Ball", (0.0, 1.0, 0.0), 1.0, 64)
    scene.lamp("Lamp", (-2.2, 4.2, 2.4), (0.0, 0.6, 0.0), 1.5, 600.0)
    scene.write(path, (0.0, 2.4, 6.5), (0.0, 0.8, 0.0), 32.0)
    return scene.triangles()


def make_level(path):
    scene, chance = Scene(), random.Random(24)
    w, h = WALL, HEIGHT
    scene.boxes("Floor", [((-8.0, -0.2, -8.0), (8.0, 0.0, 8.0))])
    scene.boxes("Ceiling", [((-8.0, h, -8.0), (8.0, h + 0.2, 2.5))])
    scene.boxes("Walls", [((-8.0, 0.0, -8.0), (8.0, h, -8.0 + w)), ((-8.0, 0.0, -8.0), (-8.0 + w, h, 8.0)),
                          ((8.0 - w, 0.0, -8.0), (8.0, h, 8.0)),
                          # Between the rooms, with doorways and their lintels.
                          ((-8.0, 0.0, -2.0), (-5.0, h, -2.0 + w)), ((-3.4, 0.0, -2.0), (3.2, h, -2.0 + w)),
                          ((4.8, 0.0, -2.0), (8.0, h, -2.0 + w)), ((-5.0, 2.2, -2.0), (-3.4, h, -2.0 + w)),
                          ((3.2, 2.2, -2.0), (4.8, h, -2.0 + w)), ((-w / 2, 0.0, -8.0), (w / 2, h, -6.0)),
                          ((-w / 2, 0.0, -4.4), (w / 2, h, 1.2)), ((-w / 2, 2.2, -6.0), (w / 2, h, -4.4))])
    scene.boxes("Pillars", [((x - 0.15, 0.0, z - 0.15), (x + 0.15, h, z + 0.15))
                            for x in (-6.0, -2.5, 2.5, 6.0) for z in (-6.0, -0.5, 2.2)])
    scene.boxes("Stairs", [((6.0, 0.0, -1.6 + 0.3 * i), (7.6, 0.2 * (i + 1), -1.3 + 0.3 * i)) for i in range(10)])
    scene.boxes("Railing", [((5.95, 0.0, -1.6 + 0.15 * i), (5.99, 0.9 + 0.1 * i, -1.56 + 0.15 * i)) for i in range(20)])
    scene.boxes("Shelves", [((x, 0.4 + 0.5 * i, -7.8), (x + 1.6, 0.44 + 0.5 * i, -7.4))
                            for x in (-7.0, -3.0, 2.0, 5.0) for i in range(4)])
    scene.boxes("Table", [((-5.4, 0.75, 0.2), (-3.2, 0.82, 1.4))] +
                [((x, 0.0, z), (x + 0.08, 0.75, z + 0.08)) for x in (-5.35, -3.33) for z in (0.25, 1.27)])
    crates = []
    for _ in range(124):
        x, z = chance.uniform(-7.4, 7.0), chance.uniform(-7.2, 3.5)
        side, y = chance.uniform(0.15, 0.6), chance.choice((0.0, 0.0, 0.0, 0.6))
        crates.append(((x, y, z), (x + side, y + side * chance.uniform(0.6, 1.4), z + side)))
    scene.boxes("Crates", crates)
    for i, (x, z) in enumerate(((-4.0, -5.0), (4.0, -5.0), (-4.4, -0.2), (2.0, 0.2), (5.2, 1.0), (-1.5, 3.6))):
        scene.lamp("Lamp%d" % i, (x, h - 0.05, z), (x, 0.0, z), 0.5, 60.0)
    scene.write(path, (-1.2, 2.4, 8.6), (-0.2, 0.8, -1.5), 42.0)
    return scene.triangles()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="where the scenes go")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, make in (("ball.glb", make_ball), ("level.glb", make_level)):
        print("%s: %d triangles" % (folder / name, make(folder / name)))


if __name__ == "__main__":
    main()
