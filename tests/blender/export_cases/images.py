"""Images that glTF cannot hold, each on a plane in a cell of its own: part of make_oddities.py.

Files are written beside the .blend.
"""

import struct
import zlib

import bpy
import numpy as np

from odd_materials import diffuse, plane, shader, textured

SPACES = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items
ODD_SPACE = next(space.identifier for space in SPACES if "ACEScg" in space.identifier)
NORMALS = np.array([[0.8, 0.45, 0.9], [0.5, 0.5, 1.0], [0.3, 0.6, 0.85], [0.55, 0.3, 0.95]], np.float32)


def linear(values):
    """Of sRGB, whose nearest byte is taken: so the export does not round."""
    values = np.round(255 * values) / 255
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def cells(alpha=1.0, turn=0.0, size=4, brightest=1.0):
    """Rows of linear colours, the lowest first; the lower half has that alpha, and `turn` makes others."""
    y, x = np.mgrid[0:size, 0:size]
    colors = [0.4 + 0.6 * x / size, 0.4 + 0.6 * (y + turn) / (size + 4), 0.3 + 0.5 * ((x + y) % 2)]
    colors = [brightest * linear(values) for values in colors]
    return np.stack([*colors, np.where(y < size / 2, alpha, 1.0)], axis=2).astype(np.float32)


def new_image(name, pixels, is_float=True):
    image = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True, float_buffer=is_float)
    image.pixels.foreach_set(pixels.ravel())
    return image


def written(folder, name, pixels, kind, space, depth="16", associate=True):
    """The file of a picture, loaded: linear colours in OPEN_EXR and HDR, else as a render writes them."""
    pixels = pixels.copy()
    if associate:
        pixels[..., :3] *= pixels[..., 3:]
    image, settings = new_image("written", pixels), bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode = kind, "RGB" if kind == "HDR" else "RGBA"
    if kind not in {"HDR", "JPEG"}:
        settings.color_depth = depth
    bpy.context.scene.view_settings.view_transform = "Standard"
    image.save_render(str(folder / name), scene=bpy.context.scene)
    bpy.data.images.remove(image)
    return loaded(folder, name, space)


def written_grey(folder, name, space, alpha=0.3):
    """A PNG of grey and alpha with 16 bits, which Blender does not write, loaded."""
    y, x = np.mgrid[0:4, 0:4]
    values = np.stack([0.3 + 0.6 * (x + y) / 6, np.where(y < 2, 1.0, alpha)], axis=2)
    rows = b"".join(b"\0" + row.tobytes() for row in np.round(65535 * values).astype(">u2"))
    chunks = (b"IHDR", struct.pack(">IIBBBBB", 4, 4, 16, 4, 0, 0, 0)), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")
    packed_chunks = [struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
                     for kind, data in chunks]
    (folder / name).write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(packed_chunks))
    return loaded(folder, name, space)


def loaded(folder, name, space):
    image = bpy.data.images.load(str(folder / name), check_existing=False)
    if space:
        image.colorspace_settings.name = space
    return image


def packed(image):
    image.pack()
    return image


def tiles(folder, stem, numbers, kind="PNG", ending="png", space="", depth="8", token="<UDIM>", sizes=(4,)):
    """A tiled image whose tiles differ; its first tile is the first of the numbers."""
    for index, number in enumerate(numbers):
        column, row = (number - 1001) % 10, (number - 1001) // 10
        name = str(number) if token == "<UDIM>" else f"u{column + 1}_v{row + 1}"
        written(folder, f"{stem}.{name}.{ending}", cells(turn=index, size=sizes[index % len(sizes)]), kind, space,
                depth)
    first = str(numbers[0]) if token == "<UDIM>" else "u1_v1"
    image = loaded(folder, f"{stem}.{first}.{ending}", space)
    image.name, image.source = stem, "TILED"
    image.filepath = str(folder / f"{stem}.{token}.{ending}")
    image.tiles[0].number = numbers[0]
    for number in numbers[1:]:
        image.tiles.new(number)
    return image


def spread(thing, columns, rows=1, left=0, low=0):
    """Its UV map lies over so many tiles, not quite to their borders."""
    for corner in thing.data.uv_layers[0].data:
        u, v = corner.uv
        corner.uv = (left + 0.01 + (columns - 0.02) * u, low + 0.01 + (rows - 0.02) * v)
    return thing


def with_alpha(name, image, kind="ShaderNodeBsdfPrincipled"):
    material, tree, surface = shader(name, kind)
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
    tree.links.new(texture.outputs["Alpha"], surface.inputs["Alpha"])
    return material


def bent(name, image, kind="NormalMap", color=None, interpolation="Closest"):
    """A normal map, or a bump's height, of an image that may be the colour, too."""
    material = diffuse(name, (0.5, 0.5, 0.5))
    tree, surface = material.node_tree, material.node_tree.nodes["Diffuse BSDF"]
    texture, node = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNode" + kind)
    texture.image, texture.interpolation = image, interpolation
    tree.links.new(texture.outputs["Color"], node.inputs["Color" if kind == "NormalMap" else "Height"])
    tree.links.new(node.outputs["Normal"], surface.inputs["Normal"])
    if kind == "Bump":
        node.inputs["Distance"].default_value = 0.02
    if color:
        tree.links.new(texture.outputs["Color"], surface.inputs["Color"])
    return material


def normals():
    """Four normals in squares of a map."""
    pixels = np.ones((4, 4, 4), np.float32)
    pixels[..., :3] = NORMALS[(np.mgrid[0:4, 0:4][0] // 2 * 2 + np.mgrid[0:4, 0:4][1] // 2)]
    return pixels


def heights():
    y, x = np.mgrid[0:8, 0:8] * (np.pi / 4)
    values = 0.5 + np.sin(x) + 0.5 * np.cos(y)
    return np.stack([values, values, values, np.ones_like(values)], axis=2).astype(np.float32)


def colours(folder):
    """Cells 0 to 15."""
    exr = written(folder, "plain.exr", cells(), "OPEN_EXR", "", "32")
    mapped = ("Mapping", {"Scale": (2, 3, 1), "Location": (0.3, 0.2, 0)}), ("TexCoord", {})
    png = {depth: written(folder, f"plain{depth}.png", cells(), "PNG", "sRGB", depth) for depth in ("8", "16")}
    dark = written(folder, "dark8.png", cells(brightest=0.4), "PNG", ODD_SPACE, "8")
    raw, scene_linear = (loaded(folder, "plain8.png", space) for space in ("Non-Color", exr.colorspace_settings.name))
    images = [exr, written(folder, "plain.hdr", cells(), "HDR", ""), png["16"],
              written(folder, "plain.tif", cells(), "TIFF", "sRGB"), raw, scene_linear, dark,
              packed(written(folder, "packed.exr", cells(turn=2), "OPEN_EXR", "", "32")),
              packed(written(folder, "packed.png", cells(turn=2), "PNG", "sRGB"))]
    for cell, image in enumerate(images):
        plane(f"Image {cell} {image.name}", cell, textured(f"image {cell}", image))
    grid = bpy.data.images.new("Grid", 64, 64, float_buffer=True)
    grid.generated_type = "UV_GRID"
    plane("Grid", 9, textured("grid", grid))
    plane("Mapped", 10, textured("mapped", exr, *mapped))
    over = textured("extended", exr, *mapped)
    over.node_tree.nodes["Image Texture"].extension = "EXTEND"
    plane("Extended", 11, over)
    plane("Twice", 12, bent("twice", exr, "Bump", color=True, interpolation="Linear"))
    glow = shader("glowing", "ShaderNodeBsdfPrincipled")
    plane("Glowing", 13, glow[0])
    texture = glow[1].nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = exr, "Closest"
    glow[1].links.new(texture.outputs["Color"], glow[2].inputs["Base Color"])


def alphas(folder):
    """Cells 14 to 23 and 36 to 40: alpha that nothing reads, in each mode, and alpha that is read."""
    glass = cells(0.3)
    exr = written(folder, "glass.exr", glass, "OPEN_EXR", "", "32")
    for cell, mode in enumerate(("STRAIGHT", "CHANNEL_PACKED", "NONE")):
        image = written(folder, f"glass{cell}.png", glass, "PNG", "sRGB")
        image.alpha_mode = mode
        plane(f"Glass {mode}", 16 + cell, textured(f"glass {mode}", image))
    plane("Glass EXR", 19, textured("glass exr", exr))
    scene_linear = written(folder, "glass8.png", glass, "PNG", exr.colorspace_settings.name, "8")
    plane("Glass linear", 20, textured("glass linear", scene_linear))
    dark = cells(0.3, brightest=0.4)
    plane("Glass odd", 21, textured("glass odd", written(folder, "dark_glass8.png", dark, "PNG", ODD_SPACE, "8")))
    plane("Glass packed", 14, textured("glass packed", packed(written(folder, "glass16.png", glass, "PNG", "sRGB"))))
    plane("Glass TIFF", 15, textured("glass tiff", written(folder, "glass.tif", glass, "TIFF", "sRGB")))
    cut = cells(0.05)
    plane("Cut EXR", 22, with_alpha("cut exr", written(folder, "cut.exr", cut, "OPEN_EXR", "", "32")))
    plane("Grey", 36, textured("grey", written_grey(folder, "grey.png", "sRGB")))
    plane("Grey clear", 37, textured("grey clear", written_grey(folder, "grey_clear.png", "sRGB", 0.0)))
    plane("Grey linear", 38, textured("grey linear", loaded(folder, "grey.png", exr.colorspace_settings.name)))
    plane("Grey packed", 39, textured("grey packed", packed(written_grey(folder, "grey_packed.png", "sRGB"))))
    plane("Cut grey", 40, with_alpha("cut grey", written_grey(folder, "cut_grey.png", "sRGB", 0.05)))
    plane("Cut PNG", 23, with_alpha("cut png", written(folder, "cut.png", cut, "PNG", "sRGB")))


def tiled(folder):
    """Cells 24 to 31."""
    three = tiles(folder, "three", (1001, 1002, 1003), space="sRGB")
    spread(plane("Tiles", 24, textured("tiles", three)), 3)
    spread(plane("Tiles mapped", 25, textured("tiles mapped", three, ("Mapping", {"Scale": (0.5, 1, 1)}),
                                              ("TexCoord", {}))), 6)
    square = tiles(folder, "square", (1012, 1013, 1022, 1023), "OPEN_EXR", "exr", "", "32")
    spread(plane("Tiles EXR", 26, textured("tiles exr", square)), 2, 2, 1, 1)
    named = tiles(folder, "named", (1001, 1011), token="<UVTILE>", space="sRGB")
    spread(plane("Tiles named", 27, textured("tiles named", named)), 1, 2)
    sizes = tiles(folder, "sizes", (1001, 1002), "TIFF", "tif", "sRGB", "16", sizes=(4, 8))
    spread(plane("Tiles of sizes", 28, textured("tiles of sizes", sizes)), 2)
    both = packed(tiles(folder, "both", (1001, 1002), space="sRGB"))
    spread(plane("Tiles packed", 29, textured("tiles packed", both)), 2)
    for path in folder.glob("both.*"):
        path.unlink()
    one = tiles(folder, "one", (1001,), space="sRGB")
    spread(plane("Tile", 30, textured("tile", one)), 1)
    spread(plane("Tiles cut", 31, with_alpha("tiles cut", three)), 3)


def numbers(folder):
    """Cells 32 to 35 and 41 on: normal maps and heights."""
    exr = written(folder, "normals.exr", normals(), "OPEN_EXR", "Non-Color", "32")
    plane("Normals EXR", 32, bent("normals exr", exr))
    bpy.context.scene.view_settings.view_transform = "Raw"
    plane("Normals TIFF", 33, bent("normals tiff", written(folder, "normals.tif", normals(), "TIFF", "Non-Color")))
    plane("Normals sRGB", 34, bent("normals srgb", written(folder, "normals.png", normals(), "PNG", "sRGB")))
    height = written(folder, "heights.exr", heights(), "OPEN_EXR", "Non-Color", "32")
    plane("Heights", 35, bent("heights", height, "Bump", interpolation="Linear"))
    level = np.full((4, 4, 4), 2.0, np.float32)
    level[..., 3] = 1.0
    level = written(folder, "level.exr", level, "OPEN_EXR", "Non-Color", "32")
    plane("Level", 41, bent("level", level, "Bump", interpolation="Linear"))
    coded = heights()
    coded[..., :3] /= 2.0
    coded = written(folder, "coded.png", np.clip(coded, 0.0, 1.0), "PNG", "sRGB")
    plane("Coded", 42, bent("coded", coded, "Bump", interpolation="Linear"))


def build(folder):
    for group in (colours, alphas, tiled, numbers):
        group(folder)


def build_blinking(folder):
    """Two images with straight alpha and one start of a name, each seen in one frame alone, as roughness."""
    for frame, (name, brightest) in enumerate((("wood.png", 0.2), ("wood.png.001", 0.8)), 1):
        image = written(folder, f"wood{frame}.png", cells(0.3, brightest=brightest), "PNG", "sRGB", "8")
        image.name = name
        material, tree, surface = shader(f"blinking {frame}", "ShaderNodeBsdfPrincipled")
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        tree.links.new(texture.outputs["Color"], surface.inputs["Roughness"])
        thing = plane(f"Blinking {frame}", frame, material)
        for now in (1, 2):
            thing.hide_render = now != frame
            thing.keyframe_insert("hide_render", frame=now)


def build_lost(folder):
    """What the export says of images: some are left out, others taken as far as it goes."""
    gap = tiles(folder, "gap", (1001, 1002, 1003), space="sRGB")
    (folder / "gap.1002.png").unlink()
    spread(plane("Gap", 0, textured("gap", gap)), 3)
    bright = written(folder, "bright.exr", cells(brightest=3.0), "OPEN_EXR", "", "32")
    plane("Bright", 1, textured("bright", bright))
    brighter = written(folder, "brighter.exr", cells(brightest=20.0), "OPEN_EXR", "", "32")
    plane("Brighter", 8, textured("brighter", brighter))
    frames = loaded(folder, "bright.exr", None)
    frames.name, frames.source = "frames", "SEQUENCE"
    plane("Frames", 2, textured("frames", frames))
    damaged = loaded(folder, "bright.exr", None)
    (folder / "damaged.exr").write_text("no picture")
    damaged.name, damaged.filepath = "damaged", str(folder / "damaged.exr")
    plane("Damaged", 3, textured("damaged", damaged))
    large = tiles(folder, "large", (1001, 1002), space="sRGB", sizes=(16,))
    spread(plane("Large", 4, textured("large", large)), 2)
    turned = ("Mapping", {"Rotation": (0, 0, 0.5)}), ("TexCoord", {})
    spread(plane("Turned", 6, textured("turned", large, *turned)), 2)
    soft = written(folder, "soft.png", cells(0.3), "PNG", "sRGB")
    plane("Soft", 7, with_alpha("soft", soft))
    boxed = textured("boxed", bright)
    boxed.node_tree.nodes["Image Texture"].projection = "BOX"
    plane("Boxed", 5, boxed)
