"""The .glb file that Blender's exporter wrote, completed: part of export_scene.py."""

import json
import math
import os
import re
import struct

import export_bends
import export_colors
import export_hair
import export_styles
from blend_common import GLTF_FROM_BLENDER

LUMENS_PER_WATT = 683.0
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def read(path):
    """(document, binary chunk) of a .glb file."""
    data = path.read_bytes()
    length, kind = struct.unpack_from("<II", data, 12)
    if data[:4] != b"glTF" or kind != JSON_CHUNK:
        raise ValueError(f"{path} is no .glb file")
    binary = b""
    if len(data) > 20 + length:
        size, _ = struct.unpack_from("<II", data, 20 + length)
        binary = data[28 + length:28 + length + size]
    return json.loads(data[20:20 + length]), binary


def write(path, document, binary):
    """Written under another name, then renamed: an interrupted export leaves no half a file."""
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode("utf-8")
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), JSON_CHUNK) + text
    if binary:
        chunks += struct.pack("<II", len(binary), BINARY_CHUNK) + binary
    temporary = path.with_name(path.name + ".part")
    temporary.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    os.replace(temporary, path)


def matrix_numbers(matrix, turned):
    """Column by column, in glTF's world. `turned` for meshes, whose vertices the exporter turns too; lights and cameras
    look down their own −Z in both programs."""
    result = GLTF_FROM_BLENDER @ matrix
    if turned:
        result = result @ GLTF_FROM_BLENDER.transposed()
    return [result[row][column] for column in range(4) for row in range(4)]


def light_of(extras):
    """KHR_lights_punctual for other readers; ours use the extras. None for area lights."""
    watts = extras["energy"]
    light = {"color": [min(max(c, 0.0), 1.0) for c in extras["color"]]}
    if extras["type"] == "SUN":
        return {**light, "type": "directional", "intensity": max(watts, 0.0) * LUMENS_PER_WATT}
    light["intensity"] = max(watts, 0.0) * LUMENS_PER_WATT / (4 * math.pi)
    if extras["type"] == "POINT":
        return {**light, "type": "point"}
    if extras["type"] == "SPOT":
        outer = min(extras["spot_size"] / 2, math.pi / 2)
        return {**light, "type": "spot",
                "spot": {"outerConeAngle": outer, "innerConeAngle": outer * (1 - extras["spot_blend"]) * 0.999999}}
    return None


def camera_of(extras):
    """glTF's camera at the render's proportions, without the shift."""
    aspect = extras["aspect"]
    wide = extras["sensor_fit"] == "HORIZONTAL" or (extras["sensor_fit"] == "AUTO" and aspect >= 1)
    planes = {"znear": extras["clip_start"], "zfar": extras["clip_end"]}
    if extras["type"] == "ORTHO":
        half = extras["ortho_scale"] / 2
        width, height = (half, half / aspect) if wide else (half * aspect, half)
        return {"type": "orthographic", "orthographic": {"xmag": width, "ymag": height, **planes}}
    half = math.tan(extras["angle"] / 2)
    yfov = 2 * math.atan(half / aspect if wide else half)
    return {"type": "perspective", "perspective": {"yfov": yfov, "aspectRatio": aspect, **planes}}


def style_request(placed):
    style = export_styles.style_of(placed.source, placed.shown)
    return {} if style is None else {"style": style}


def add_hair(document, binary, flat, by_name, settings):
    """Each mesh gets its hair; the triangles of a mesh that stands for hair alone go."""
    done = set()
    for placed in flat.meshes:
        mesh = by_name[placed.exported].get("mesh")
        if mesh is None or mesh in done or not placed.hair:
            continue
        done.add(mesh)
        primitives = document["meshes"][mesh]["primitives"]
        if export_hair.stands_for_hair(placed.mesh):
            primitives.clear()
        for hair in placed.hair:
            stand_in = document["meshes"][by_name[hair.exported]["mesh"]]["primitives"][0]
            primitives.append(export_hair.primitive_of(document, binary, hair, stand_in.get("material"), settings))


def final_name(attribute):
    """Blender 3.4 puts a _ before names that begin with one."""
    name = re.sub("^__", "_", attribute)
    return "COLOR_0" if name == export_colors.ATTRIBUTE.upper() else name


def complete(document, binary, flat, materials, lamps, cameras, curves):
    """Restores the places and names of meshes, and adds hair, cameras, lights and extras. Returns the binary chunk."""
    document["asset"]["generator"] = "scumble export_scene.py"
    by_name = {node["name"]: node for node in document.get("nodes", [])}
    binary = bytearray(binary)
    add_hair(document, binary, flat, by_name, curves)
    if document.get("buffers"):
        document["buffers"][0]["byteLength"] = len(binary)
    nodes = []
    for placed in flat.meshes:
        mesh = by_name[placed.exported].get("mesh")
        if mesh is None:
            continue
        document["meshes"][mesh]["name"] = placed.source.data.name if placed.source.data else placed.source.name
        nodes.append({"name": placed.name, "mesh": mesh, "matrix": matrix_numbers(placed.matrix, True),
                      "extras": {"scumble": {"pass_index": placed.source.pass_index, **style_request(placed)}}})
    for placed, extras in zip(flat.cameras, cameras):
        document.setdefault("cameras", []).append({"name": placed.source.data.name, **camera_of(extras)})
        nodes.append({"name": placed.name, "camera": len(document["cameras"]) - 1,
                      "matrix": matrix_numbers(placed.matrix, False), "extras": {"scumble": {"camera": extras}}})
    lights = []
    for placed, extras in zip(flat.lamps, lamps):
        node = {"name": placed.name, "matrix": matrix_numbers(placed.matrix, False),
                "extras": {"scumble": {"lamp": extras}}}
        light = light_of(extras)
        if light is not None:
            lights.append({"name": placed.source.data.name, **light})
            node["extensions"] = {"KHR_lights_punctual": {"light": len(lights) - 1}}
        nodes.append(node)
    if lights:
        document.setdefault("extensions", {})["KHR_lights_punctual"] = {"lights": lights}
        used = document.setdefault("extensionsUsed", [])
        if "KHR_lights_punctual" not in used:
            used.append("KHR_lights_punctual")
    document["nodes"] = nodes
    scene = document["scenes"][document["scene"]]
    scene["nodes"] = list(range(len(nodes)))
    if not nodes:
        scene.pop("nodes")
        document.pop("nodes")
    entries = {entry["exported"]: entry for entry in materials.values()}
    for mesh in document.get("meshes", []):
        for primitive in mesh["primitives"]:
            primitive["attributes"] = {final_name(name): value for name, value in primitive["attributes"].items()}
    for material in document.get("materials", []):
        entry = entries[material["name"]]
        material["name"] = entry["name"]
        extras = export_bends.complete(material, entry["extras"])
        material["extras"] = {"scumble": extras}
        material["doubleSided"] = True
    export_bends.drop_unused_coat(document)
    return bytes(binary)
