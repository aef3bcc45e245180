"""Images that glTF cannot hold, as copies that it can: part of export_scene.py.

glTF's colours are in sRGB with 8 bits, its numbers are not decoded, and a texture is one picture. Where an image is
otherwise, a .png with what Cycles reads from it takes its place, in Blender's folder for the run. A copy serves all
materials and all frames. Tiles (UDIM) become one picture, at which a Mapping node aims.
"""

import functools
import os
import struct
import zlib
from dataclasses import dataclass, field

import bpy
import numpy as np

from blend_check import is_lost
from export_copies import merge_mappings
from export_nodes import (ORIGINAL_FULL, READS_ALPHA, full_name_of, holds_colours, holds_numbers, image_fault, is_raw,
                          name_of, place_fault, previous, stand_for)

COPY = "scumble_copy"  # properties of an image, by kind: the copy that stands for it
KIND = "scumble_kind"  # properties of an image, by use: kind_needed's answer
RANGE = "scumble_range"  # property of a copy: by what its numbers must be multiplied
MOST_PIXELS = 8192 * 8192  # of all tiles together
CLIPPED, CLIPPED_SHARE = (-0.02, 1.02), 1e-3  # beyond them a value is clipped visibly; more of the pixels are told
WHITE, NEUTRAL = (1.0, 1.0, 1.0, 1.0), (0.5, 0.5, 1.0, 1.0)  # where there is no tile; as a normal, it bends nothing
ROWS = 128  # that are converted at once
GREY_WITH_ALPHA = {16, 64}  # depths of PNG with 8 and 16 bits; an image's `channels` are 4 for them, too
PACKED = {"CHANNEL_PACKED", "NONE"}  # alpha modes with colours that do not depend on alpha


@dataclass
class Made:
    """A copy's file, and what has to be said of it."""
    path: str
    is_colour: bool  # in sRGB
    range: float = 1.0
    lines: list = field(default_factory=list)


made = {}  # by copy_of's key; None where there can be none. It outlives the scene of a frame.


# ---- Conversion -----------------------------------------------------------------------------------------------------


def encoded(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def decoded(values):
    return np.where(values <= 0.04045, values / 12.92, ((np.maximum(values, 0.0) + 0.055) / 1.055) ** 2.4)


@functools.lru_cache
def table_of_floats():
    """The byte in sRGB of each linear float, by the float's first 19 bits: within 1/16 of a byte's step."""
    floats = (np.arange(1 << 19, dtype=np.uint32) << 13 | 1 << 12).view(np.float32)
    with np.errstate(invalid="ignore"):
        return quantised(encoded(np.clip(np.nan_to_num(floats, nan=0.0, posinf=1.0), 0.0, 1.0)), 8)


def quantised(values, bits):
    most = (1 << bits) - 1
    with np.errstate(invalid="ignore"):
        return (np.clip(np.nan_to_num(values), 0.0, 1.0) * most + 0.5).astype(np.uint8 if bits == 8 else np.uint16)


@functools.lru_cache
def table_of_codes():
    """The linear number with 16 bits of each one in sRGB with 16 bits."""
    return quantised(decoded(np.arange(1 << 16) / 65535), 16)


@dataclass
class Look:
    """What pixels mean, and what becomes of them."""
    is_linear: bool  # no decoding is needed
    is_associated: bool  # colours are multiplied by alpha
    bends: bool  # Cycles multiplies them if nothing reads alpha
    keeps_alpha: bool
    colour: bool  # the result is in sRGB; else it is numbers
    bits: int
    low: float = 0.0  # numbers from here
    range: float = 1.0  # by so much become 0 to 1


def straight(pixels):
    """Colours that were multiplied by alpha, as they were before."""
    alpha = pixels[..., 3:]
    return pixels[..., :3] / np.where(alpha > 0.0, alpha, 1.0)


def matched(pixels, look):
    """Colours as Cycles sees them: not multiplied by alpha if alpha is read, else multiplied."""
    colors, alpha = pixels[..., :3], pixels[..., 3:]
    if look.keeps_alpha and look.is_associated:
        return straight(pixels)
    if not look.keeps_alpha and look.bends and not look.is_associated and alpha.min() < 1.0:
        return colors * alpha
    return np.ascontiguousarray(colors)


def converted(pixels, look):
    """(the copy's pixels, how many are clipped visibly) of rows of floats."""
    result = np.empty((*pixels.shape[:2], 4 if look.keeps_alpha else 3), np.uint8 if look.bits == 8 else np.uint16)
    table, clipped = table_of_floats() if look.colour and look.is_linear else None, 0
    for start in range(0, len(pixels), ROWS):
        rows = slice(start, start + ROWS)
        colors = matched(pixels[rows], look)
        if table is not None:
            result[rows, :, :3] = table.take(colors.astype(np.float32, copy=False).view(np.uint32) >> 13)
            clipped += np.count_nonzero((colors > CLIPPED[1]).any(axis=2))
        elif look.colour or look.is_linear:
            values = (colors - look.low) / look.range
            result[rows, :, :3] = quantised(values, look.bits)
            if look.bits == 16:
                clipped += np.count_nonzero(((values < CLIPPED[0]) | (values > CLIPPED[1])).any(axis=2))
        else:
            result[rows, :, :3] = table_of_codes().take(quantised(colors, 16))
        if look.keeps_alpha:
            result[rows, :, 3] = quantised(pixels[rows, :, 3], look.bits)
    return result, clipped


def pixels_of(image):
    """Rows of four floats, the lowest first; None where it cannot be read."""
    width, height = image.size
    values = np.empty(len(image.pixels) if width else 0, np.float32)
    if not values.size or values.size != width * height * image.channels:
        return None
    image.pixels.foreach_get(values)
    values = values.reshape(height, width, -1)
    if values.shape[2] == 4:
        return values
    full = np.ones((height, width, 4), np.float32)
    full[..., :3] = values[..., :3] if values.shape[2] == 3 else values[..., :1]
    if values.shape[2] == 2:
        full[..., 3] = values[..., 1]
    return full


def is_in_range(pixels):
    """Whether no colour is beyond 0 and 1."""
    return bool(np.all((pixels[..., :3] >= 0.0) & (pixels[..., :3] <= 1.0 + 1e-5)))


def is_read_by_cycles(image):
    """Whether Cycles reads the file itself. It then multiplies sRGB by alpha, and interpolates it, before it decodes;
    Blender decodes first."""
    return image.source != "GENERATED" and image.packed_file is None and not image.is_dirty


def unmultiplied_pixels(image):
    """The pixels of an image's file, its colours as they are under any alpha."""
    copy = bpy.data.images.load(bpy.path.abspath(image.filepath, library=image.library), check_existing=False)
    copy.alpha_mode, copy.colorspace_settings.name = "CHANNEL_PACKED", image.colorspace_settings.name
    pixels = pixels_of(copy)
    bpy.data.images.remove(copy)
    return pixels


def read(image, kind, alpha, by_cycles):
    """(pixels, look) of an image of one file; None where it cannot be read."""
    keeps_grey = by_cycles and image.file_format == "PNG" and image.depth in GREY_WITH_ALPHA  # it never multiplies them
    pixels = unmultiplied_pixels(image) if keeps_grey else pixels_of(image)
    if pixels is None:
        return None
    space, is_float = image.colorspace_settings.name, image.is_float
    bends = not image.colorspace_settings.is_data and image.alpha_mode not in PACKED and not keeps_grey
    look = Look(is_float or is_raw(image), is_float and bends, bends, alpha, kind == "colour", 16)
    if not look.is_linear and space != "sRGB":
        pixels, look.is_linear = through_blender(pixels, space), True
        if pixels is None:
            return None
    elif is_float and space == "sRGB" and by_cycles:
        look.colour |= kind == "height" and is_in_range(pixels)
        if (look.colour and kind == "height") or (bends and not alpha and pixels[..., 3].min() < 1.0):
            pixels[..., :3] = encoded(np.maximum(straight(pixels) if bends else pixels[..., :3], 0.0))
            look.is_linear = look.is_associated = False
    if kind == "colour" or (is_raw(image) and not is_float):
        look.bits = 8
    if kind == "height" and is_float and not look.colour:
        low, high = float(np.nanmin(pixels[..., :3])), float(np.nanmax(pixels[..., :3]))
        if np.isfinite(high - low) and (low < 0.0 or high > 1.0):
            look.low, look.range = low, high - low if high > low else 1.0  # a constant bends nothing
    return pixels, look


def through_blender(pixels, space):
    """Colours of bytes in a space that only Blender knows, decoded."""
    path = new_path("space")
    write_png(path, quantised(pixels, 16))
    image = bpy.data.images.load(path, check_existing=False)
    image.alpha_mode, image.colorspace_settings.name = "CHANNEL_PACKED", space
    result = pixels_of(image)
    bpy.data.images.remove(image)
    os.remove(path)
    return result


# ---- Files ----------------------------------------------------------------------------------------------------------


def new_path(name, ending=".png"):
    folder = os.path.join(bpy.app.tempdir, "scumble")
    os.makedirs(folder, exist_ok=True)
    stem = "".join(c if c.isalnum() or c in "-_ " else "_" for c in os.path.splitext(name)[0])[:60]
    number = len(os.listdir(folder))
    while os.path.exists(os.path.join(folder, f"{stem}.{number}{ending}")):
        number += 1
    return os.path.join(folder, f"{stem}.{number}{ending}")


def write_png(path, pixels):
    """Rows of 8 or 16 bits, the lowest first, quickly packed."""
    height, width, channels = pixels.shape
    step = channels * pixels.itemsize
    packer, packed = zlib.compressobj(1), []
    for start in range(height, 0, -ROWS):
        rows = pixels[max(start - ROWS, 0):start][::-1]
        rows = np.ascontiguousarray(rows, rows.dtype.newbyteorder(">")).view(np.uint8).reshape(len(rows), -1)
        lines = np.empty((len(rows), 1 + rows.shape[1]), np.uint8)
        lines[:, 0], lines[:, 1:1 + step] = 1, rows[:, :step]  # each byte less that of the pixel to its left
        np.subtract(rows[:, step:], rows[:, :-step], out=lines[:, 1 + step:])
        packed.append(packer.compress(lines.tobytes()))
    packed.append(packer.flush())
    kind = {1: 0, 3: 2, 4: 6}[channels]
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        head = struct.pack(">IIBBBBB", width, height, 8 * pixels.itemsize, kind, 0, 0, 0)
        for name, data in ((b"IHDR", head), (b"IDAT", b"".join(packed)), (b"IEND", b"")):
            file.write(struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)))


def load_copy(image, copied):
    copy = bpy.data.images.load(copied.path, check_existing=False)
    stand_for(copy, image)
    copy.colorspace_settings.name = "sRGB" if copied.is_colour else "Non-Color"
    copy[RANGE] = copied.range
    return copy


# ---- Tiles ----------------------------------------------------------------------------------------------------------


def tile_grid(image):
    """The tiles' columns and rows, by their numbers; and the first column, the first row, and how many there are."""
    places = {tile.number: ((tile.number - 1001) % 10, (tile.number - 1001) // 10) for tile in image.tiles}
    columns, rows = ([place[axis] for place in places.values()] for axis in (0, 1))
    return places, min(columns), min(rows), max(columns) - min(columns) + 1, max(rows) - min(rows) + 1


def tile_path(image, number):
    """The file of a tile; a packed one is written to a new file first."""
    packed = {file.tile_number: file for file in image.packed_files} if image.packed_file is not None else {}
    if number in packed:
        path = new_path("tile", os.path.splitext(packed[number].filepath)[1])
        with open(path, "wb") as file:
            file.write(packed[number].packed_file.data)
        return path
    column, row = (number - 1001) % 10, (number - 1001) // 10
    path = image.filepath.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{column + 1}_v{row + 1}")
    return bpy.path.abspath(path, library=image.library)


def read_tile(image, number, most, kind, alpha):
    """(the tile's pixels for the copy, how many are clipped, whether it was made smaller); None where it cannot be
    read."""
    try:
        tile = bpy.data.images.load(tile_path(image, number), check_existing=False)
    except RuntimeError:
        return None
    tile.alpha_mode, tile.colorspace_settings.name = image.alpha_mode, image.colorspace_settings.name
    pixels = tile.size[0] * tile.size[1]
    shrinks = pixels > most
    if shrinks:
        tile.scale(*(max(int(side * (most / pixels) ** 0.5), 1) for side in tile.size))
    found = read(tile, kind, alpha, is_read_by_cycles(image))
    bpy.data.images.remove(tile)
    return (*converted(*found), shrinks) if found is not None else None


def join_tiles(image, kind, alpha):
    """One picture of all tiles: (its pixels, the share that is clipped, what has to be said); None without any."""
    places, left, low, columns, rows = tile_grid(image)
    tiles, lost, lines = {}, [], []
    kind = "data" if kind == "height" else kind  # all tiles have one range
    for number in sorted(places):
        tile = read_tile(image, number, MOST_PIXELS // (columns * rows), kind, alpha)
        if tile is None:
            lost.append(number)
        else:
            tiles[number] = tile
    if not tiles:
        return None
    height, width = (max(tile[0].shape[axis] for tile in tiles.values()) for axis in (0, 1))
    bits = 8 * max(tile[0].itemsize for tile in tiles.values())
    channels = 4 if alpha else 3
    whole = np.empty((rows * height, columns * width, channels), np.uint8 if bits == 8 else np.uint16)
    whole[:] = quantised(np.array((WHITE if kind == "colour" else NEUTRAL)[:channels]), bits)
    for number, (pixels, _, _) in tiles.items():
        x, y = (places[number][0] - left) * width, (places[number][1] - low) * height
        whole[y:y + height, x:x + width] = stretched(pixels, height, width, bits)
    if lost:
        more = f" and {len(lost) - 1} more" if len(lost) > 1 else ""
        lines.append(f"image '{name_of(image)}': its tile {lost[0]}{more} cannot be read from '{image.filepath}' and "
                     "is white where it was the colour; in Cycles it is magenta")
    if any(shrinks for _, _, shrinks in tiles.values()):
        lines.append(f"image '{name_of(image)}': its tiles are shrunk to {width} x {height} pixels, because {columns} "
                     f"x {rows} of them become one picture")
    clipped = sum(count for _, count, _ in tiles.values()) / sum(pixels[..., 0].size for pixels, _, _ in tiles.values())
    return whole, clipped, lines


def stretched(pixels, height, width, bits):
    """A smaller tile, by repeated pixels; bytes with 16 bits."""
    if bits > 8 * pixels.itemsize:
        pixels = pixels.astype(np.uint16) * 257
    if pixels.shape[:2] == (height, width):
        return pixels
    down, across = (np.arange(size) * pixels.shape[axis] // size for axis, size in ((0, height), (1, width)))
    return pixels[down][:, across]


def turned_fault(node):
    """glTF cannot turn coordinates and then scale them unevenly, as tiles need it that are no square together."""
    source = previous(node.inputs["Vector"])
    _, _, _, columns, rows = tile_grid(node.image)
    if source is None or source.node.type != "MAPPING" or columns == rows:
        return None
    turn = source.node.inputs["Rotation"].default_value[2]
    return f"node '{name_of(node)}' with {columns} x {rows} tiles at turned coordinates" if abs(turn) > 1e-6 else None


def aim_at_tiles(node, image):
    """A Mapping node from the tiles' places to those of the picture of them all."""
    _, left, low, columns, rows = tile_grid(image)
    node.extension = "EXTEND"
    if (left, low, columns, rows) == (0, 0, 1, 1):
        return
    tree = node.id_data
    source = previous(node.inputs["Vector"]) or tree.nodes.new("ShaderNodeTexCoord").outputs["UV"]
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.name = f"Tiles of {name_of(node)}"
    mapping.inputs["Location"].default_value = (-left / columns, -low / rows, 0.0)
    mapping.inputs["Scale"].default_value = (1.0 / columns, 1.0 / rows, 1.0)
    tree.links.new(source, mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    merge_mappings(tree)


# ---- Copies ---------------------------------------------------------------------------------------------------------


def kind_needed(image, use):
    """What an image that glTF cannot hold for that use has to become: "colour", "data", or "height", whose range may
    change; None where glTF has it, or nothing helps."""
    if image.source not in {"FILE", "GENERATED", "TILED"} or image.type == "MULTILAYER":
        return None
    name = f"{KIND}.{use}"
    if name not in image:  # to ask for its depth loads the file
        image[name] = kind_of(image, use)
    return image[name] or None


def kind_of(image, use):
    fits = image.source != "TILED"
    if use == "alpha" or (use != "data" and holds_colours(image)):
        return "" if fits else "colour"
    if use == "colour":
        return "colour"
    return "" if fits and holds_numbers(image) else "height" if use == "height" else "data"


def white(image, alpha):
    """The copy of colours that cannot be read."""
    result = Made(new_path(image.name), True)
    if not is_lost(image):  # else blend_check.py has said so
        result.lines.append(f"image '{name_of(image)}' cannot be read from '{image.filepath}' and is white where it "
                            "was the colour; in Cycles it is magenta")
    write_png(result.path, quantised(np.ones((1, 1, 4 if alpha else 3)), 8))
    return result


def make(image, kind, alpha):
    """The copy's file; None where the image cannot be read."""
    if image.source == "TILED":
        joined = join_tiles(image, kind, alpha)
        if joined is None:
            return None
        pixels, clipped, lines = joined
        result = Made(new_path(image.name), kind == "colour", 1.0, lines)
    else:
        found = read(image, kind, alpha, is_read_by_cycles(image))
        if found is None:
            return None
        pixels, clipped = converted(*found)
        clipped /= pixels[..., 0].size
        result = Made(new_path(image.name), found[1].colour, found[1].range)
        if image.source == "FILE" and not image.is_dirty:
            image.buffers_free()  # the original is not needed any more
    if clipped > CLIPPED_SHARE:
        what = "colours above 1, which are taken for 1" if kind == "colour" else "numbers beyond 0 and 1, which are cut"
        result.lines.append(f"image '{name_of(image)}': {100 * clipped:.3g}% of its pixels have {what}")
    write_png(result.path, pixels)
    return result


def copy_of(image, kind, alpha, unsupported):
    """`made` has it by names of the user's file: Blender numbers images of ours anew in each frame."""
    key, name = (full_name_of(image), ORIGINAL_FULL in image, kind, alpha), f"{COPY}.{kind}.{int(alpha)}"
    if key not in made:
        made[key] = make(image, kind, alpha) or (white(image, alpha) if kind == "colour" else None)
    if made[key] is None:
        return None
    if image.get(name) is None:
        image[name] = load_copy(image, made[key])
    for line in made[key].lines:
        unsupported.add(line)
    return image[name]


def fault(node, use, unsupported):
    """The fault in an image texture; None where glTF has it, or now has a copy of its image. `use`: "colour", "data",
    "height", "alpha", or "any" of colours and numbers."""
    if node.image is not None and place_fault(node) is None:
        turned = turned_fault(node) if node.image.source == "TILED" else None
        if turned is not None:
            return turned
        alpha, kind = bool(node.get(READS_ALPHA)), kind_needed(node.image, use)
        if kind is None and use == "alpha":  # one picture with the colours
            node.image = node.image.get(f"{COPY}.colour.1") or node.image
        copy = copy_of(node.image, kind, alpha, unsupported) if kind is not None else None
        if copy is not None:
            if node.image.source == "TILED":
                aim_at_tiles(node, node.image)
            node.image = copy
    return image_fault(node, use)
