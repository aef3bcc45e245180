#!/usr/bin/python3
"""Makes the fuzzers' seeds, small files of every kind that Scumble reads: tests/fuzz/make_seeds.py [FOLDER]

They are kept in tests/fuzz/corpus/TARGET/; this makes them again, for when a format gains something to be tested.
"""
import io
import json
import pathlib
import struct
import sys
import zipfile
import zlib

import numpy as np
import OpenImageIO as oiio

FOLDER = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "corpus")


def write(target, name, content):
    path = FOLDER / target / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)


def png(width, height, kind, bits, extra=b"", interlace=0):
    """A PNG of colour type `kind` and any pixels."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[kind]
    row = (width * channels * bits + 7) // 8
    rows = b"".join(bytes([y % 5]) + bytes((7 * x + 3 * y) % 256 for x in range(row)) for y in range(height))
    if interlace:
        rows = bytes(4 * (row + 2) * (height + 8))
    if kind == 3:
        rows = b"".join(bytes(1 + row) for _ in range(height))
        extra = chunk(b"PLTE", bytes(range(12))) + chunk(b"tRNS", bytes([255, 7])) + extra
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, interlace))
    text = chunk(b"tEXt", b"scumble:settings\0one two") if kind == 6 else b""
    if kind == 2:
        text = chunk(b"gAMA", struct.pack(">I", 45455)) + chunk(b"sRGB", b"\0") + chunk(b"zTXt", b"Note\0\0"
                                                                                        + zlib.compress(b"x" * 50))
    return b"\x89PNG\r\n\x1a\n" + head + extra + text + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def exr(name, parts):
    """An EXR file's bytes; parts are (width, height, channels, attributes)."""
    path = str(FOLDER / "made.exr")
    specs = []
    for width, height, channels, attributes in parts:
        spec = oiio.ImageSpec(width, height, len(channels), oiio.FLOAT)
        spec.channelnames = channels
        spec.alpha_channel = -1
        spec.attribute("DateTime", "")
        for key, value in attributes.items():
            if key in ("tile_width", "tile_height", "full_width", "full_height", "x", "y"):
                setattr(spec, key, value)
            elif key == "half":
                spec.set_format(oiio.HALF)
            else:
                spec.attribute(key, value)
        specs.append(spec)
    output = oiio.ImageOutput.create(path)
    assert output.open(path, tuple(specs) if len(specs) > 1 else specs[0]), output.geterror()
    for i, spec in enumerate(specs):
        if i:
            assert output.open(path, spec, "AppendSubimage"), output.geterror()
        pixels = np.zeros((spec.height, spec.width, spec.nchannels), np.float32)
        for c, channel in enumerate(spec.channelnames):
            if channel == "A" or channel.endswith((".Z", ".V")):
                pixels[:, :, c] = 1
            if channel.endswith((".ID", ".r")):
                pixels[:, :, c] = 3.5
        pixels[0, 0, :] = 0
        assert output.write_image(pixels), output.geterror()
    output.close()
    data = pathlib.Path(path).read_bytes()
    pathlib.Path(path).unlink()
    for target in ("guides", "exr"):
        write(target, name, data)


def with_attribute(data, name, kind, value):
    """A plain EXR file with one attribute more, of a type that OpenImageIO does not write."""
    end = 8
    while data[end]:
        for _ in range(2):
            end = data.index(0, end) + 1
        end += 4 + struct.unpack_from("<i", data, end)[0]
    added = name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    first = struct.unpack_from("<Q", data, end + 1)[0]  # the chunks' places stand before the first one
    count = (first - end - 1) // 8
    places = struct.unpack_from(f"<{count}Q", data, end + 1)
    return (data[:end] + added + b"\0" + struct.pack(f"<{count}Q", *(place + len(added) for place in places)) +
            data[first:])


def make_fragments():
    """Guides with two fragments in one pixel and one in another."""
    data = (FOLDER / "guides" / "guides_none.exr").read_bytes()
    names = ["A", "normal.X", "normal.Y", "normal.Z", "depth.Z", "object.ID", "material.ID"]
    planes = [(0.25, 0.5, 0.125), (0, 0, 0.6), (0, 1, 0), (1, 0, 0.8), (2, 3, 4), (3, 4, 4), (3, 3, 3)]
    value = (struct.pack("<5I", 1, 3, 3, 3, len(names)) + b"".join(n.encode() + b"\0" for n in names) +
             struct.pack("<3I", 4, 4, 7) + b"".join(struct.pack("<3f", *plane) for plane in planes))
    for target in ("guides", "exr"):
        write(target, "fragments.exr", with_attribute(data, "scumble:fragments", "scumbleFragments", value))


def make_exr():
    guides = ["A", "normal.X", "normal.Y", "normal.Z", "depth.Z", "object.ID", "material.ID"]
    texts = {"scumble:objects": "3 Ball\n4 A\\nB\n", "scumble:materials": "3 Grey\n", "scumble:camera": "Camera",
             "scumble:viewFromWorld": "1 0 0 0 0 1 0 0 0 0 1 0 0 0 -5 1", "scumble:generator": "guidegen 0.1",
             "scumble:clipFromView": "1 0 0 0 0 1 0 0 0 0 -1 -1 0 0 -0.2 0", "scumble:objectStyles": "3 oil\n"}
    for compression in ("none", "rle", "zips", "zip", "piz"):
        exr(f"guides_{compression}.exr", [(3, 3, guides, {"compression": compression, **texts})])
    exr("few.exr", [(2, 2, guides[:4], {"compression": "none"})])
    exr("colour.exr", [(3, 2, guides[:4] + ["luminance.Y", "albedo.R", "albedo.G", "albedo.B", "shadow.Y"],
                        {"compression": "none", "half": 1})])
    exr("tiled.exr", [(4, 4, guides[:4], {"compression": "none", "tile_width": 2, "tile_height": 2})])
    exr("window.exr", [(2, 2, guides[:4], {"compression": "none", "full_width": 5, "full_height": 4, "x": 1, "y": 1})])
    exr("parts.exr", [(2, 2, guides[:4], {"compression": "none", "name": "a"}), (2, 2, ["depth.Z", "object.ID"],
                                                                                 {"name": "b"})])
    layer = "ViewLayer."
    passes = [layer + c for c in ("Combined.R", "Combined.G", "Combined.B", "Combined.A", "Normal.X", "Normal.Y",
                                  "Normal.Z",
                                  "Depth.Z", "Position.X", "Position.Y", "Position.Z", "IndexOB.X",
                                  "CryptoObject00.r", "CryptoObject00.g", "CryptoObject00.b", "CryptoObject00.a")]
    exr("blender.exr", [(4, 3, passes, {"compression": "none", "Software": "Blender 3.4.1",
                                        "cryptomatte/9f/name": layer + "CryptoObject",
                                        "cryptomatte/9f/manifest": '{"Ball":"40600000","A \\"b":"1a2b3c4d"}',
                                        "cryptomatte/9f/hash": "MurmurHash3_32"})])


def make_gltf():
    floats = lambda *v: struct.pack(f"<{len(v)}f", *v)
    blob, views, accessors = b"", [], []

    def accessor(data, count, kind, component=5126):
        nonlocal blob
        blob += bytes(-len(blob) % 4)
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        blob += data
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind})
        return len(accessors) - 1
    position = accessor(floats(0, 0, 0, 1, 0, 0, 0, 1, 0), 3, "VEC3")
    index = accessor(struct.pack("<3H", 0, 1, 2), 3, "SCALAR", 5123)
    picture = accessor(png(2, 2, 6, 8), 1, "SCALAR", 5121)
    image_view = accessors.pop(picture)["bufferView"]
    attributes = {"POSITION": position, "NORMAL": accessor(floats(*(0, 0, 1) * 3), 3, "VEC3"),
                  "TEXCOORD_0": accessor(floats(0, 0, 1, 0, 0, 1), 3, "VEC2"),
                  "COLOR_0": accessor(bytes(range(12)), 3, "VEC4", 5121),
                  "JOINTS_0": accessor(bytes(12), 3, "VEC4", 5121),
                  "WEIGHTS_0": accessor(floats(*(1, 0, 0, 0) * 3), 3, "VEC4")}
    accessors[attributes["COLOR_0"]]["normalized"] = True
    times = accessor(floats(0, 1), 2, "SCALAR")
    moves = accessor(floats(0, 0, 0, 1, 2, 3), 2, "VEC3")
    turns = accessor(floats(0, 0, 0, 1, 0, 1, 0, 0), 2, "VEC4")
    weights = accessor(floats(0, 1), 2, "SCALAR")
    binds = accessor(floats(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1), 1, "MAT4")
    morph = accessor(floats(*(0, 0, 1) * 3), 3, "VEC3")
    accessors.append({"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {
        "count": 1, "indices": {"bufferView": accessors[index]["bufferView"], "componentType": 5123},
        "values": {"bufferView": accessors[position]["bufferView"]}}})
    asset = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3],
                                                                  "extras": {"scumble": {"world": [1, 0.5, 1],
                                                                                         "style": "oil"}}}],
             "accessors": accessors,
             "bufferViews": views}
    small = {**asset, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "Tri"}],
             "meshes": [{"primitives": [{"attributes": {"POSITION": position}, "indices": index}]}]}
    large = {**asset, "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
             "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 5,
                                                                "spot": {"outerConeAngle": 0.5}},
                                                               {"type": "directional"},
                                                               {"type": "point", "range": 3}]}},
             "images": [{"bufferView": image_view, "mimeType": "image/png"}],
             "samplers": [{"wrapS": 33071, "magFilter": 9728}],
             "textures": [{"source": 0, "sampler": 0}],
             "materials": [{"name": "Paint", "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": True,
                            "emissiveFactor": [1, 0, 0],
                            "extras": {"scumble": {"bsdf": {"type": "GLOSSY", "roughness": 0.2, "color": [1, 0.5, 0]}}},
                            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.5,
                                                     "roughnessFactor": 0.1},
                            "normalTexture": {"index": 0, "scale": 0.5,
                                              "extensions": {"KHR_texture_transform": {"scale": [2, 2],
                                                                                       "rotation": 1}}}}],
             "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1, "aspectRatio": 1.5}},
                         {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}}],
             "meshes": [{"name": "M", "weights": [0.5], "primitives": [
                 {"attributes": attributes, "indices": index, "material": 0, "targets": [{"POSITION": morph}]},
                 {"attributes": {"POSITION": len(accessors) - 1}, "mode": 5, "targets": [{"POSITION": morph}]}]}],
             "skins": [{"joints": [1], "inverseBindMatrices": binds}],
             "nodes": [{"mesh": 0, "skin": 0, "name": "Leaf", "extras": {"scumble_style": "oil"}},
                       {"camera": 0, "extras": {"scumble": {"camera": {"sensor_fit": "AUTO", "shift_x": 0.1,
                                                                       "shift_y": 0, "angle": 0.8}}},
                        "rotation": [0, 0, 0, 1], "children": [4]},
                       {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
                        "extensions": {"KHR_lights_punctual": {"light": 0}},
                        "extras": {"scumble": {"lamp": {"type": "AREA", "shape": "DISK", "size": 1, "size_y": 2,
                                                        "energy": 10, "color": [1, 1, 1]}}}},
                       {"camera": 1, "scale": [1, 2, 3], "translation": [0, 1, 0]}, {"mesh": 0, "weights": [1]}],
             "animations": [{"name": "Go", "samplers": [{"input": times, "output": moves, "interpolation": "STEP"},
                                                        {"input": times, "output": turns},
                                                        {"input": times, "output": weights}],
                             "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}},
                                          {"sampler": 1, "target": {"node": 3, "path": "rotation"}},
                                          {"sampler": 2, "target": {"node": 4, "path": "weights"}}]}]}
    def glb(model):
        data = blob + bytes(-len(blob) % 4)
        text = json.dumps({**model, "buffers": [{"byteLength": len(data)}]}, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
    write("gltf", "small.glb", glb(small))
    write("gltf", "everything.glb", glb(large))
    strand = accessor(floats(0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 2, 0, 1, 2, 0), 5, "VEC3")
    hair = {"mode": 0, "indices": accessor(struct.pack("<2H", 0, 1), 2, "SCALAR", 5123),
            "attributes": {"POSITION": strand, "TEXCOORD_0": accessor(floats(*(0.2, 0.8) * 5), 5, "VEC2"),
                           "_SCUMBLE_RADIUS": accessor(floats(0.2, 0.2, 0.1, 0, 0), 5, "SCALAR")}}
    shapes = [{**hair, "extras": {"scumble": {"curves": {"ribbons": ribbons, "pieces": 5}}}}
              for ribbons in (True, False)]
    write("gltf", "hair.glb", glb({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                                   "nodes": [{"mesh": 0}], "meshes": [{"primitives": shapes}],
                                   "bufferViews": views, "accessors": accessors}))
    write("gltf", "text.gltf", json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "buffers": [{"byteLength": 36,
                     "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}))


def make_text():
    write("obj", "cube.obj",
          "mtllib scene.obj\no A\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 2 0\nvt 0 0\nvt 1 0\nvn 0 0 1\n"
          "s 1\nusemtl m\nf 1/1/1 2/2/1 3/1/1 4/2/1 5/1/1\nf -5 -4 -3\ng B\ns off\nf 1//1 2//1 3//1\n"
          "newmtl m\nKd 0.5 1 0\nKe 1 1 1\nNs 50\nd 0.5\nillum 2\nmap_Kd -s 2 2 lit.png\nnorm n.png\n")
    write("obj", "lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\np 3\nf 1 2 3\n")
    head = "ply\nformat %s 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" \
           "%selement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    write("ply", "ascii.ply", head % ("ascii", "property uchar red\nproperty uchar green\nproperty uchar blue\n") +
          "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n4 0 1 2 3\n")
    xyz = (0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
    for order, mark in (("little", "<"), ("big", ">")):
        write("ply", order + ".ply", (head % (f"binary_{order}_endian", "")).encode() +
              struct.pack(mark + "12fB4i", *xyz, 4, 0, 1, 2, 3))
    write("ply", "normals.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
          "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
          "element face 1\nproperty list uint8 uint32 vertex_index\nend_header\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n"
          "0 1 0 0 0 1 0 1\n3 0 1 2\n")
    exemplar = '[[exemplar]]\nimage = "lit.png"\n'
    write("style", "small.toml", exemplar)
    write("style", "more.toml",
          'name = "oil"\nlicence = "CC0-1.0"\n[transfer]\nthreshold = 0.07\nvariety = 15\nlevels = 5\n'
          'method = "styleblit"\ncolorize = 0.5\ncolorize_mode = "oklab"\nblend_radius = 2\nedge_aware = false\n'
          'paper = "#ffeedd"\n'
          + exemplar + 'luminance = 0.8\n' + exemplar
          + "luminance = 0.1\n\0transfer.scale=0.5\nexemplar.2.luminance=0.3\n")
    write("style", "tracks.toml",
          "[transfer]\nthreshold = [[1, 0.1], [24, 0.3]]\njitter = [[-5, 0], [5, 1.0]]\njitter_fps = 12\n"
          'edge = "exemplar"\nguide_weights = { normal = 2 }\nluminance_weight = inf\n' + exemplar)
    write("style", "finish.toml",
          '[[finish]]\neffect = "outline"\nname = "ink"\nwidth = [[1, 2], [9, 4]]\nink = "#102030"\nside = "inside"\n'
          'objects = ["A*", "B"]\n[[finish]]\neffect = "shadows"\nmode = "complement"\nat = "sheet"\nstrength = 0.5\n'
          '[[finish]]\neffect = "hatch"\nlayers = 3\n' + exemplar)
    write("style", "toon.toml", '[transfer]\nmethod = "toon"\n[[finish]]\neffect = "toon"\nbands = 4\n')
    write("style", "sphere.toml", "[transfer]\nguide_weights = { lpe.LDE = 0.5, luminance = 1 }\n" +
          2 * (exemplar + 'guides = "sphere.exr"\n'))
    write("style", "scene.toml", "[transfer]\ncolorize = [[-999999999, 0], [999999999, 1]]\n"
          'paper = [[1, "#ffffff"], [48, "lit.png"]]\n' + 2 * (exemplar + 'guides = "scene.exr"\n'))
    write("header", "camera", "camera Camera.001\nviewFromWorld 1 0 0 0 0 1 0 0 0 0 1 0 0 0 -5 1\n"
          "clipFromView 1.5 0 0 0 0 2 0 0 0 0 -1 -1 0 0 -0.2 0\n")
    scene = {"size": "640x360", "samples": 64, "max_bounces": 8, "limits": {"normal 99% within": 0.0007, "A": 0}}
    write("baseline", "small.json", json.dumps({"scumble_baseline": 1, "blender": "3.4.1",
                                                "scenes": {"suzanne.glb": scene}}))
    write("baseline", "more.json", json.dumps({"scumble_baseline": 1, "scenes": {
        "a.blend": {**scene, "camera": "Camera.001", "frame": -7},
        "\u00e9 b.glb": {**scene, "limits": {"lpe.LDE mean difference": 1e300}}}}))
    write("options", "sheet", "\ufeff# who is painted how\nTree* = charcoal\n\nGlass=rendered\r\n  Ball=a=b\n")
    write("header", "manifest", '{"Ball":"40600000","A \\"b\\u00e9":"1a2b3c4d","c"d":"00000001"}')
    write("header", "names", "3 Ball\n4 A\\nB\n5 back\\\\slash\n")
    write("header", "matrix", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 -5 1e300")
    for i, name in enumerate(("ViewLayer.CryptoObject00.r", "normal.X", "View.lpe.LDE.R", "A,normal,depth,lpe.full")):
        write("header", f"channel{i}", name)
    for i, words in enumerate((
            "stylize a.glb --style oil --size 640x480 -o p.####.png --frames 1-24x2 --fps 24000/1001 --seed 7",
            "guidegen a.obj --layers normal,depth --view 35,20,4 --aa 4 --isa avx2 --half --explain -o g.exr",
            "transfer g.exr --style oil --set transfer.threshold=0.2 --assign Tree*=charcoal --over o.png -o p.png "
            "--exposure auto",
            "compare a.exr b.exr -fail 0.1 -failpercent 2 --json", "sphere --size 512 -o d --paper A4 --margin 12.5mm",
            "crosscheck a.glb --threads 2 -q", "info f.exr", "styles check d", "help stylize", "--version")):
        write("options", f"line{i}", words.replace(" ", "\n"))


def make_requests():
    """Requests to the studio's server, with the port and the token of tests/fuzz/http_fuzz.cpp."""
    end = "\r\n"
    host = "Host: 127.0.0.1:4321" + end
    ours = host + "Cookie: a=b; scumble_4321=0123456789abcdef" + end
    change = (ours + "Origin: http://127.0.0.1:4321" + end + "Sec-Fetch-Site: same-origin" + end + "X-Scumble: 1" + end
              + "Content-Type: application/json" + end)
    get = f"GET /api/pick?x=3&y=%34 HTTP/1.1{end}{ours}{end}"
    write("http", "first", f"GET /?token=0123456789abcdef HTTP/1.1{end}{host}Sec-Fetch-Site: cross-site{end}{end}")
    write("http", "page", f"GET / HTTP/1.1{end}{ours}If-None-Match: \"1\"{end}{end}")
    write("http", "events", f"GET /api/events HTTP/1.1{end}{ours}Last-Event-ID: 7{end}{end}")
    write("http", "two", get + f"HEAD /web/page.js HTTP/1.1{end}{ours}{end}")
    write("http", "patch", f"PATCH /api/state HTTP/1.1{end}{change}Content-Length: 11{end}{end}" + '{"frame":2}' + get)
    write("http", "chunked", f"POST /api/save-as HTTP/1.1{end}{change}Transfer-Encoding: chunked{end}{end}"
          f"5;a=b{end}" + '{"nam' + f"{end}9{end}" + 'e": "x"}\n' + f"{end}0{end}Trailer: t{end}{end}" + get)
    write("http", "paint", f"POST /api/paint?exemplar=0&stamp=1 HTTP/1.1{end}{ours}X-Scumble: 1{end}"
          f"Content-Type: image/png{end}Content-Length: 4{end}Expect: 100-continue{end}{end}\x00PNG")
    write("http", "foreign", f"POST /api/save HTTP/1.1{end}Host: evil.example{end}Origin: null{end}"
          f"Content-Type: text/plain{end}Content-Length: 1{end}Content-Length: 1{end}{end}x")
    write("http", "old", f"GET /web/..%2f%00 HTTP/1.0{end}Connection: keep-alive{end}{end}")


def make_changes():
    """What a page changes, with the scenes and styles of tests/fuzz/state_fuzz.cpp."""
    view = {"azimuth": 33.25, "elevation": -10, "distance": 4.5, "right": 0.1, "up": -0.05, "fov": 40}
    for name, change in {
            "view": {"view": view, "light": {"azimuth": 20, "elevation": 30.5}},
            "keys": {"style": "oil",
                     "keys": {"transfer.threshold": 0.3, "transfer.levels": 5, "transfer.coherent": True,
                              "transfer.method": "litsphere", "transfer.paper": "#f4efe6", "name": "a'b",
                              "transfer.jitter": None, "transfer.hybrid": "inf"}},
            "scene": {"scene": "toys", "camera": "Camera.001", "frame": 13, "size": [320, 180], "seed": 7},
            "assign": {"assignments": [{"name": "Suzanne*", "style": "ink"}, {"name": "Ball", "style": "oil"}]},
            "dash": {"camera": "--help", "assignments": [{"name": "-o x", "style": "ink"}],
                     "keys": {"name": "--a=b\nc"}},
            "nul": {"camera": "a\0b"}, "nul_name": {"assignments": [{"name": "a\0", "style": "ink"}]},
            "nul_key": {"keys": {"name": "a\0"}}, "far": {"view": {"azimuth": 1e6, "elevation": 90, "distance": 1e12}},
            "numbers": {"seed": 18446744073709551615, "frame": -1000000, "size": [16384, 1], "budget_ms": 1e-300},
            "draft": {"quality": "draft", "view": None}, "budget": {"budget_ms": 33.5, "frame": None},
            "wrong": {"style": "../x", "size": [0, 1e9], "path": "/etc"}}.items():
        write("state", name, json.dumps(change))


def make_pictures():
    for kind, bits in ((0, 1), (0, 16), (2, 8), (3, 8), (4, 8), (6, 8), (6, 16)):
        write("png", f"kind{kind}_{bits}.png", png(3, 3, kind, bits))
    write("png", "interlaced.png", png(5, 5, 2, 8, interlace=1))
    for name, method in (("stored.ora", zipfile.ZIP_STORED), ("deflated.ora", zipfile.ZIP_DEFLATED)):
        data = io.BytesIO()
        with zipfile.ZipFile(data, "w", method) as archive:
            for entry, content in (("mimetype", b"image/openraster"),
                                   ("stack.xml", b"<image w='2' h='2'><stack/></image>"),
                                   ("mergedimage.png", png(2, 2, 6, 8)), ("bomb", bytes(3000))):
                archive.writestr(zipfile.ZipInfo(entry, (1980, 1, 1, 0, 0, 0)), content, method)
        write("raster", name, data.getvalue())


def packed_picture(ending, channels, kind=oiio.UINT8, **attributes):
    """The bytes of a small picture as OpenImageIO writes that format; nothing where it does not."""
    path = str(FOLDER / f"made.{ending}")
    spec = oiio.ImageSpec(9, 6, channels, kind)
    for key, value in attributes.items():
        spec.attribute(key, value)
    output = oiio.ImageOutput.create(path)
    assert output and output.open(path, spec), oiio.geterror()
    pixels = np.fromfunction(lambda y, x, c: (x // 3 + y // 2 + c) % 4 / 3, (6, 9, channels)).astype(np.float32)
    assert output.write_image(pixels), output.geterror()
    output.close()
    data = pathlib.Path(path).read_bytes()
    pathlib.Path(path).unlink()
    return data


def make_other_pictures():
    for name, ending, channels, kind, attributes in (
            ("plain.bmp", "bmp", 3, oiio.UINT8, {}), ("alpha.bmp", "bmp", 4, oiio.UINT8, {}),
            ("grey.bmp", "bmp", 1, oiio.UINT8, {}),
            ("plain.tga", "tga", 4, oiio.UINT8, {"compression": "none"}),
            ("runs.tga", "tga", 3, oiio.UINT8, {"compression": "rle"}),
            ("grey.tga", "tga", 1, oiio.UINT8, {"compression": "rle"}), ("plain.hdr", "hdr", 3, oiio.FLOAT, {}),
            ("plain.jpg", "jpg", 3, oiio.UINT8, {"Orientation": 6}), ("grey.jpg", "jpg", 1, oiio.UINT8, {}),
            ("plain.tif", "tif", 4, oiio.UINT8, {"compression": "none", "oiio:UnassociatedAlpha": 1}),
            ("lzw.tif", "tif", 3, oiio.UINT16, {"compression": "lzw"}),
            ("zip.tif", "tif", 1, oiio.FLOAT, {"compression": "zip"}),
            ("tiled.tif", "tif", 3, oiio.UINT8, {"compression": "packbits", "tile_width": 16})):
        write("picture", name, packed_picture(ending, channels, kind, **attributes))
    runs = b"".join(bytes([2, 2, 0, 9]) + bytes([128 + 9, 40 + y]) * 4 for y in range(6))
    write("picture", "runs.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 6 +X 9\n" + runs)
    for kind, row in ((1, b"0 1 1\n"), (2, b"0 7 255\n"), (3, b"1 2 3 4 5 6 7 8 9\n"), (4, b"\xa0"), (5, b"\0\x07\xff"),
                      (6, bytes(range(9)))):
        write("picture", f"p{kind}.pnm", b"P%d\n# words\n3 2\n" % kind + (b"" if kind in (1, 4) else b"255\n")
              + row * 2)
    write("picture", "float.pfm", b"PF\n3 2\n-1.0\n" + struct.pack("<18f", *range(18)))
    write("picture", "grey.pfm", b"Pf\n3 2\n1.0\n" + struct.pack(">6f", *range(6)))
    # Targa with a palette, packed by runs.
    write("picture", "palette.tga", struct.pack("<BBBHHBHHHHBB", 0, 1, 9, 0, 256, 24, 0, 0, 9, 6, 8, 0x20)
          + bytes(range(256)) * 3 +
          bytes([0x88, 1]) * 3 + bytes([8, *range(4), *range(4), 0]) * 3)
    for bits, palette in ((1, 2), (4, 16), (8, 256)):  # BMP with a palette
        row = bytes([0x1b] * ((9 * bits + 31) // 32 * 4))
        head = 14 + 40 + 4 * palette
        write("picture", f"palette{bits}.bmp", struct.pack("<2sIHHI", b"BM", head + 6 * len(row), 0, 0, head) +
              struct.pack("<IiiHHIIiiII", 40, 9, 6, 1, bits, 0, 0, 2835, 2835, palette, 0) +
              bytes(v % 256 for v in range(4 * palette)) + row * 6)
    write("picture", "old.bmp", struct.pack("<2sIHHI", b"BM", 14 + 12 + 6 * 28, 0, 0, 26)
          + struct.pack("<IHHHH", 12, 9, 6, 1, 24) + bytes(6 * 28))
    for mode, channels, depth, packed in ((3, 3, 8, 0), (3, 4, 8, 1), (1, 1, 16, 0), (4, 4, 8, 0), (2, 1, 8, 0),
                                          (0, 1, 1, 0)):
        row = bytes((9 * depth + 7) // 8)
        palette = bytes(768) if mode == 2 else b""
        resources = b"8BIM" + struct.pack(">HHI", 1005, 0, 16) + struct.pack(">IHHIHH", 72 << 16, 1, 1, 72 << 16, 1, 1)
        data = struct.pack(">H", packed)
        if packed:
            run = bytes([257 - 9, 7])
            data += struct.pack(">H", len(run)) * (6 * channels) + run * (6 * channels)
        else:
            data += row * (6 * channels)
        write("picture", f"mode{mode}_{channels}_{depth}.psd",
              struct.pack(">4sH6xHIIHH", b"8BPS", 1, channels, 6, 9, depth, mode) +
              struct.pack(">I", len(palette)) + palette + struct.pack(">I", len(resources)) + resources
              + struct.pack(">I", 0) + data)
    # Nothing but a palette: GIFs are refused by their first bytes.
    write("picture", "plain.gif", b"GIF89a" + struct.pack("<HHBBB", 9, 6, 0x80, 0, 0) + bytes(6) + b";")


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    make_exr()
    make_fragments()
    make_gltf()
    make_text()
    make_requests()
    make_changes()
    make_pictures()
    make_other_pictures()
