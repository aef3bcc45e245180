#!/usr/bin/python3
"""What few files do is exported as Cycles renders it: odd materials, curves with geometry nodes, settings of the
viewport, view layers other than the window's and their filters, alpha, subdivision and lamps that are said, animated
nodes, cameras of one name, what is flat, limits of instancers, and images that glTF cannot hold.

    oddities_test.py PROGRAM [BLENDER]
"""

import json
import math
import struct
import sys
import tempfile
from pathlib import Path

from everything_test import expect, run

SOURCE = Path(__file__).resolve().parents[2]
DATA = {"A", "normal", "depth", "object", "position", "albedo"}
QUADS = 16
TRIANGLES = {  # of objects whose viewport shows another mesh, or none
    "DrivenAway": 2 * QUADS, "StripAway": 2 * QUADS, "KeyedArray": 6 * QUADS, "DrivenLevels": 2 * QUADS * 16,
    "Screw": 2 * 24, "RenderAlone": 2 * QUADS, "Body": 2 * QUADS, "Child": 2 * QUADS * 16,
    "Instancer/Body": 2 * QUADS, "Instancer/Child": 2 * QUADS * 16, "Path/Path": 2 * QUADS, "Path/Path#5": 2 * QUADS}

LOST = ["lamp 'Panel': is visible to the camera",
        "material 'by ray': node 'Mix Shader' (MIX_SHADER) cannot be expressed",
        "material 'elsewhere': node 'Image Texture.001' at other places than the colour's image",
        "material 'fade': image 'Fade' is its alpha and half transparent in wide parts",
        "material 'fog': it has a volume and no surface: its faces are left out",
        "material 'glass': its alpha 0.3 is cut at one half: the surface is left out",
        "material 'pane': node 'Glass BSDF' (BSDF_GLASS) cannot be expressed; it is Diffuse in its viewport colour "
        "instead: its surfaces are opaque, also to light",
        "material 'tilted': node 'Mapping'",
        "material 'two': node 'Image Texture.001' at other places than the roughness",
        "material 'veil': its alpha 0.6 is cut at one half: the surface is solid",
        "material 'velvet': node 'Velvet BSDF' (BSDF_VELVET) cannot be expressed",
        "object 'Diced': its adaptive subdivision is taken for 4 levels more than its modifier's"]

LIMITS = ["camera 'Flat': its scale leaves it no direction, left out",
          "lamp 'AREA xy': is flattened along its axis", "lamp 'Sheared': is sheared",
          "materials that take the UV of the instancer ('scattered'): instances cannot share meshes for it, and 1024",
          "object 'Catch': is a shadow catcher", "object 'Dark': is invisible to shadow rays",
          "object 'Inner': its style does not hold in the instances of 'Outer'",
          "object 'Unseen': is not seen by the camera"]
SHEARED = (0.447742, 0.554991, 0.701079)  # the third axis under the inverse of the scale


LOST_IMAGES = ["image 'bright.exr': 81.2% of its pixels have colours above 1",
               "image 'brighter.exr': 100% of its pixels have colours above 1",
               "image 'damaged' cannot be read from '//damaged.exr'",
               "image 'gap': its tile 1002 cannot be read from '//gap.<UDIM>.png' and is white",
               "image 'large': its tiles are shrunk to 8 x 8 pixels, because 2 x 1 of them",
               "material 'boxed': node 'Image Texture' with BOX projection",
               "material 'frames': node 'Image Texture' with an image of source SEQUENCE",
               "material 'soft': image 'soft.png' is its alpha and half transparent in wide parts",
               "material 'turned': node 'Image Texture' with 2 x 1 tiles at turned coordinates"]
FEW_PIXELS = ("import sys; sys.dont_write_bytecode = True; sys.path.insert(0, {!r}); import export_images; "
              "export_images.MOST_PIXELS = 128")


def blender_run(blender, *arguments):
    done = run([blender, "-b", "-noaudio", "--factory-startup", "-Y", *arguments])
    expect(done.returncode == 0, arguments, done.stdout[-2000:], done.stderr)
    return done.stderr


def exported(blender, folder, name, *arguments, before="0"):
    """The document of the exported scene; what is not expressed. `before`: Python that Blender runs first."""
    output = folder / (name + ".glb")
    export(blender, folder / (name + ".blend"), output, *arguments, before=before)
    document = read(output)[0]
    return document, document["scenes"][document["scene"]]["extras"]["scumble"]


def export(blender, scene, output, *arguments, before="0"):
    blender_run(blender, scene, "--python-expr", before, "-P", SOURCE / "blender_scripts/export_scene.py", "--",
                "--output", output, *arguments)


def read(glb):
    """The document and the binary chunk."""
    data = glb.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[28 + length:]


def triangles_of(document, node):
    return sum(document["accessors"][primitive["indices"]]["count"] // 3
               for primitive in document["meshes"][node["mesh"]]["primitives"])


def check_odd(document, extras):
    nodes = {node["name"]: node for node in document["nodes"]}
    materials = {material["name"]: material["extras"]["scumble"]["bsdf"] for material in document["materials"]}

    def primitives(name):
        return document["meshes"][nodes[name]["mesh"]]["primitives"]

    for name, triangles in TRIANGLES.items():
        expect(name in nodes, name, sorted(nodes))
        expect(triangles_of(document, nodes[name]) == triangles, name, triangles_of(document, nodes[name]), triangles)
    expect("Path" not in nodes and "Stone" not in nodes, "what renders do not show", sorted(nodes))
    expect(all("Word" != name.split("/")[0] or name == "Word" for name in nodes), "a text once", sorted(nodes))
    painted = [document["materials"][primitive["material"]]["name"] for primitive in primitives("Tube")]
    expect(painted == ["tube"], painted)
    shared = {primitives(name)[0]["material"] for name in nodes if name.startswith("Order ")}
    expect(len(shared) == 1, "one material for all orders of UV maps", shared)
    modes = {material["name"]: material.get("alphaMode", "OPAQUE") for material in document["materials"]}
    for name in ("leaf", "leaf swapped", "leaf mask", "leaf math", "leaf shape", "unseen", "unseen mix"):
        expect(modes[name] == "BLEND", "holes by a Mix Shader with Transparent", name, modes[name])
    expect(materials["leaf"]["type"] == "DIFFUSE" and materials["leaf swapped"]["type"] == "PRINCIPLED", materials)
    expect(abs(materials["glow"]["strength"] - 0.7152) < 1e-6, materials["glow"])
    expect(max(abs(value - 0.7152) for value in extras["world"]) < 1e-6, extras["world"])
    expect(not extras["unsupported"], extras["unsupported"])


def check_images(document, extras):
    """What they look like is compared with Cycles."""
    def pictures(name, *path):
        found = next(material for material in document["materials"] if material["name"] == name)
        for key in path:
            found = found[key]
        return document["textures"][found["index"]]["source"]

    materials = {material["name"]: material["extras"]["scumble"] for material in document["materials"]}
    expect(materials["coded"]["bump"]["srgb"], "a height is decoded after it was interpolated", materials["coded"])
    color = ("pbrMetallicRoughness", "baseColorTexture")
    shared = {pictures(name, *color) for name in ("image 0", "mapped", "extended", "twice", "glowing")}
    expect(len(shared) == 1, "materials share a copy", shared)
    height = pictures("twice", "extras", "scumble", "bump", "texture")
    expect(height not in shared, "the height has a copy of its own", height)
    expect(not extras["unsupported"], extras["unsupported"])


def check_blinking(blender, folder):
    """Copies serve all frames of a run, each image its own."""
    export(blender, folder / "blinking.blend", folder / "blinking.#.glb", "--frames", "1-2")
    pictures = []
    for frame in (1, 2):
        document, binary = read(folder / f"blinking.{frame}.glb")
        view = document["bufferViews"][document["images"][0]["bufferView"]]
        pictures.append(binary[view["byteOffset"]:view["byteOffset"] + view["byteLength"]])
    expect(pictures[0] != pictures[1], "a later frame has its own image's copy")


def check_lost_images(document, extras):
    textured = {material["name"] for material in document["materials"]
                if "baseColorTexture" in material["pbrMetallicRoughness"]}
    expect(textured == {"gap", "bright", "brighter", "damaged", "large", "soft"}, textured)
    lost = sorted(extras["unsupported"])
    expect(len(lost) == len(LOST_IMAGES) and all(start in line for start, line in zip(LOST_IMAGES, lost)), lost)


def check_against_cycles(program, blender, scene, *more, albedo=0.002):
    done = run([program, "crosscheck", scene, "--blender", blender, "--size", "320x240", "--samples", "1", "-q",
                "--json", *more])
    expect(done.stdout, done.stderr)
    report = json.loads(done.stdout)
    report = report[0] if isinstance(report, list) else report
    figures = {figure["layer"]: figure for figure in report["figures"] if figure["layer"] in DATA}
    expect(set(figures) == DATA, sorted(figures))
    for figure in report["figures"]:
        if figure["layer"] in DATA:
            expect(figure["kept"], figure)
    expect(figures["albedo"]["value"] < albedo, figures["albedo"])


def check_layered(document, extras):
    names = {node["name"] for node in document["nodes"]}
    expect({"Comes", "Sun"} <= names and "Goes" not in names, extras, sorted(names))
    diced = {node["name"]: triangles_of(document, node) for node in document["nodes"]
             if node["name"] in {"Diced", "Plain"}}
    expect(diced == {"Diced": 2 * QUADS * 4 ** 5, "Plain": 2 * QUADS * 4}, diced)
    lamp = next(node["extras"]["scumble"]["lamp"] for node in document["nodes"] if node["name"] == "Sun")
    expect(lamp["energy"] == 5, lamp)
    colors = [material["extras"]["scumble"]["bsdf"]["color"] for material in document["materials"]
              if material["name"] == "painted"]
    expect(colors == [[0, 0, 1]], colors)
    heights = [node["matrix"][13] for node in document["nodes"] if node["name"].startswith("Emitter/Leaf")]
    expect(heights and abs(max(heights) - 9 / 24) < 0.05, "particles keep their way", heights)
    away = next(node["matrix"][12] for node in document["nodes"] if node["name"] == "Away")
    expect(abs(away - 10) < 1e-6, "a camera that the view layer excludes stands where the frame has it", away)
    living = {name for name in names if name.startswith("Brief/")}
    expect(living == {f"Brief/Leaf#{system}{number}" for system in ("", "2.") for number in range(7, 11)},
           "particles keep their numbers when others are gone", sorted(living))
    modes = {material["name"]: material.get("alphaMode", "OPAQUE") for material in document["materials"]}
    holes = {name for name, mode in modes.items() if mode != "OPAQUE"}
    expect(holes == {"glass", "fade", "named", "alone", "clipped", "fog", "velvet"}, "surfaces with holes", modes)
    glass = next(material for material in document["materials"] if material["name"] == "glass")
    expect(glass["pbrMetallicRoughness"]["baseColorFactor"][3] == 0, "an alpha that is cut is told once", glass)
    lost = sorted(extras["unsupported"])
    expect(len(lost) == len(LOST) and all(start in line for start, line in zip(LOST, lost)), lost)


def check_filter(document, has_surfaces, has_hair):
    """Furry is the only one with hair."""
    kinds = {node["name"]: {primitive.get("mode", 4) for primitive in document["meshes"][node["mesh"]]["primitives"]}
             for node in document["nodes"] if "mesh" in node}
    expect(("First" in kinds) == has_surfaces, sorted(kinds))
    expect(kinds["Furry"] == ({4} if has_surfaces else set()) | ({0} if has_hair else set()), kinds["Furry"])


def check_placed(document, extras):
    nodes = {node["name"]: node for node in document["nodes"]}
    seen = [(node["name"], node["matrix"][12]) for node in document["nodes"] if "camera" in node]
    expect(seen == [("Above#3", 3.5), ("Above", 100), ("Above#2", 200)],
           "the active camera first, whatever its name", seen)
    strands = document["meshes"][nodes["Short"]["mesh"]]["primitives"]
    segments = [document["accessors"][primitive["indices"]]["count"] for primitive in strands]
    expect(segments == [4], "curves beside one of a single point", segments)
    expect(not extras["unsupported"], extras["unsupported"])


def check_limits(document, extras):
    nodes = {node["name"]: node for node in document["nodes"]}
    lamps = {name: node["extras"]["scumble"]["lamp"]["energy"] for name, node in nodes.items()
             if "lamp" in node.get("extras", {}).get("scumble", {})}
    lit = {"POINT", "POINT xy", "POINT z", "POINT yz", "POINT xyz", "SUN z", "SUN yz", "SUN xyz", "SPOT z", "SPOT yz",
           "SPOT xyz", "AREA xy", "AREA xyz", "Sheared"}
    expect({name for name, energy in lamps.items() if energy > 0} == lit, "lamps that shine in Cycles", lamps)

    def backward(name):
        return nodes[name]["matrix"][8:11]

    for kind, axes in (("SUN", "z"), ("SUN", "yz"), ("SPOT", "z"), ("AREA", "xy")):
        expect(math.dist(backward(f"{kind} {axes}"), backward(f"{kind} xyz")) < 1e-6, kind, axes)
    expect(math.dist(backward("Sheared"), SHEARED) < 1e-5, "across its first two axes", backward("Sheared"))
    for name in ("Shared", "Shared.001"):
        thickness = math.hypot(*nodes[name]["matrix"][4:7])
        expect(1e-7 < thickness < 1e-6, "what is flat keeps a direction for its normals", nodes[name]["matrix"])
    scattered = {nodes.pop(name)["mesh"] for name in sorted(nodes) if name.startswith("Field/Seed")}
    expect(len(scattered) == 1, "instances share a mesh where they would need too many", scattered)
    styles = {name: node["extras"]["scumble"].get("style") for name, node in nodes.items() if "mesh" in node}
    beside = styles.pop("Beside")
    expect(beside.endswith("/assets/paints/ink"), "beside the library", beside)
    expect(nodes["FlatHair"]["matrix"][4:7] == [0, 0, 0], "hair that is flat is left out", nodes["FlatHair"]["matrix"])
    wanted = {"Bundled": "oil", "Reserved": "catcher", "FlatHair": None, "Shared": None, "Shared.001": None,
              "Plain/Member": None, "Dark/Member": None, "Catch/Member": "catcher-or-rendered", "Wish/Member": "ink",
              "Outer/Member": None}
    wanted.update({f"{name}/Own": "oil" for name in ("Plain", "Dark", "Catch", "Wish", "Outer")})
    expect(styles == wanted, styles)
    styled = [material["extras"]["scumble"].get("style") for material in document["materials"]
              if material["name"] == "styled"]
    expect(styled == ["ink"], styled)
    lost = sorted(extras["unsupported"])
    expect(len(lost) == len(LIMITS) and all(start in line for start, line in zip(LIMITS, lost)), lost)


def main():
    program, blender = Path(sys.argv[1]).resolve(), (sys.argv[2:] or ["blender"])[0]
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        blender_run(blender, "-P", SOURCE / "tests/blender/make_oddities.py", "--", "--output", folder)
        check_odd(*exported(blender, folder, "odd"))
        layered, extras = exported(blender, folder, "layered", "--frame", "10", "--view-layer", "Second")
        check_layered(layered, extras)
        check_filter(layered, True, False)
        check_filter(exported(blender, folder, "layered", "--view-layer", "Strands")[0], False, True)
        check_placed(*exported(blender, folder, "placed", "--frame", "10"))
        check_limits(*exported(blender, folder, "limits"))
        check_images(*exported(blender, folder, "images"))
        check_blinking(blender, folder)
        few = FEW_PIXELS.format(str(SOURCE / "blender_scripts"))
        check_lost_images(*exported(blender, folder, "lost", before=few))
        check_against_cycles(program, blender, folder / "odd.blend")
        check_against_cycles(program, blender, folder / "images.blend", albedo=0.0005)
        check_against_cycles(program, blender, folder / "placed.blend", "--frame", "10")


main()
