"""Puts the stretch of an object's matrix into its mesh, where Cycles does: part of export_scene.py.

Cycles carries the normals of a mesh that stands in one place only into the world, makes them unit there, and then
interpolates; where a mesh has several users it interpolates first. Under a stretch that is up to half a degree of
difference between the corners of a coarse mesh. glTF's readers always interpolate first, which is the same once the
node's matrix is a mere rotation or reflection. Normal maps lie in the mesh before its stretch, in Cycles, too: a mesh
with one keeps the stretch in its extras, so that a reader can undo it.
"""

import numpy as np

FLOAT = 5126
POINTS, TRIANGLES = 0, 4  # modes of primitives; points are strands of hair
TINY = 1e-6  # relative; below it a stretch is a float's rounding
FLAT = 2e-6  # relative: how thick what is flattened becomes, so that its normals have a way into the world


def split(matrix):
    """(orthogonal, stretch) with linear part = orthogonal @ stretch and the stretch symmetric and positive, or None
    where it is the same in all directions, or flattens."""
    linear = np.array([row[:3] for row in matrix[:3]], dtype=np.float64)
    if not np.isfinite(linear).all():
        return None
    left, sizes, right = np.linalg.svd(linear)
    if sizes[2] <= TINY * sizes[0] or sizes[0] - sizes[2] <= TINY * sizes[0]:
        return None
    stretch = right.T @ np.diag(sizes) @ right
    return left @ right, (stretch + stretch.T) / 2


def thicken(nodes):
    """Makes each "matrix" that flattens a mesh onto a plane, which Cycles draws, one that can be inverted, and returns
    these nodes. What is flattened onto a line has no surface."""
    thickened = []
    matrices = np.array([node["matrix"] for node in nodes], dtype=np.float64).reshape(-1, 4, 4)
    linear = matrices[:, :3, :3]
    thin = np.abs(np.linalg.det(linear)) <= TINY * np.linalg.norm(linear, axis=(1, 2)) ** 3
    for number in np.flatnonzero(thin & np.isfinite(linear).all(axis=(1, 2))):
        left, sizes, right = np.linalg.svd(linear[number])
        if sizes[2] <= TINY * sizes[0] < sizes[1]:
            sizes[2] = FLAT * sizes[0] * np.sign(np.linalg.det(left) * np.linalg.det(right))
            linear[number] = left @ np.diag(sizes) @ right
            nodes[number]["matrix"] = matrices[number].ravel().tolist()
            thickened.append(nodes[number])
    return thickened


def values_of(document, buffer, accessor):
    """The vectors of an accessor as an array that shares memory with the buffer."""
    view = document["bufferViews"][accessor["bufferView"]]
    if accessor["componentType"] != FLOAT or accessor["type"] != "VEC3" or view.get("byteStride", 12) != 12:
        raise ValueError("the exporter packs its vectors in a way that is not known here")
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return np.frombuffer(buffer, np.float32, 3 * accessor["count"], start).reshape(-1, 3)


def numbers_of(document, buffer, accessor):
    """As values_of, of single numbers."""
    view = document["bufferViews"][accessor["bufferView"]]
    return np.frombuffer(buffer, np.float32, accessor["count"], view.get("byteOffset", 0))


def thicken_surfaces(document, nodes, unsupported):
    """As above; what is hair alone stays flat, and is left out by the reader."""
    kinds = [{primitive.get("mode", TRIANGLES) for primitive in mesh["primitives"]}
             for mesh in document.get("meshes", [])]
    for node in thicken([node for node in nodes if "mesh" in node and kinds[node["mesh"]] != {POINTS}]):
        if POINTS in kinds[node["mesh"]]:
            unsupported.add(f"object '{node['name']}': is flattened, so its hair is too thin to be seen")


def bake(document, binary, nodes, unsupported):
    """Thickens what is flat, stretches the meshes of those nodes that are their mesh's only users, and makes their
    "matrix" orthogonal. Returns the binary."""
    buffer = bytearray(binary)
    users = {}
    thicken_surfaces(document, nodes, unsupported)
    for node in nodes:
        users.setdefault(node.get("mesh"), []).append(node)
    accessor_users = {}
    for number, mesh in enumerate(document.get("meshes", [])):
        for primitive in mesh["primitives"]:
            for name in ("POSITION", "NORMAL"):
                if name in primitive["attributes"]:
                    accessor_users.setdefault(primitive["attributes"][name], set()).add(number)
    for number, (node, *others) in users.items():
        if number is None or others:
            continue
        matrix = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
        parts = split(matrix)
        primitives = document["meshes"][number]["primitives"]
        accessors = {(name, primitive["attributes"][name]) for primitive in primitives
                     for name in ("POSITION", "NORMAL") if name in primitive["attributes"]}
        if parts is None or any(accessor_users[index] != {number} for _, index in accessors):
            continue
        orthogonal, stretch = parts
        if any(has_normal_map(document, primitive) for primitive in primitives):
            document["meshes"][number].setdefault("extras", {})["scumble"] = {"stretch": stretch.ravel().tolist()}
        for name, index in sorted(accessors):
            stretch_accessor(document, buffer, document["accessors"][index], name, stretch)
        for primitive in primitives:
            if "_SCUMBLE_RADIUS" in primitive["attributes"]:
                radii = document["accessors"][primitive["attributes"]["_SCUMBLE_RADIUS"]]
                numbers_of(document, buffer, radii)[:] *= np.cbrt(np.linalg.det(stretch))
        matrix[:3, :3] = orthogonal
        node["matrix"] = matrix.T.ravel().tolist()
    return bytes(buffer)


def has_normal_map(document, primitive):
    if "material" not in primitive:
        return False
    return "normal" in document["materials"][primitive["material"]].get("extras", {}).get("scumble", {})


def stretch_accessor(document, buffer, accessor, name, stretch):
    values = values_of(document, buffer, accessor)
    if name == "POSITION":
        values[:] = values.astype(np.float64) @ stretch.T
        accessor["min"], accessor["max"] = values.min(0).tolist(), values.max(0).tolist()
        return
    turned = values.astype(np.float64) @ np.linalg.inv(stretch)  # the inverse's transpose; it is symmetric
    lengths = np.linalg.norm(turned, axis=1, keepdims=True)
    values[:] = np.where(lengths > 0, turned / np.where(lengths > 0, lengths, 1.0), values)
