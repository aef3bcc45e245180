"""What feeds the input of a node, and which images glTF can keep: shared by the parts that read materials."""


# Inputs of the Principled node by their names up to Blender 3.6, and from 4.0 on.
PRINCIPLED_INPUTS = {"Subsurface": "Subsurface Weight", "Specular": "Specular IOR Level", "Sheen": "Sheen Weight",
                     "Clearcoat": "Coat Weight", "Clearcoat Roughness": "Coat Roughness",
                     "Clearcoat Normal": "Coat Normal", "Transmission": "Transmission Weight",
                     "Emission": "Emission Color"}

INSTANCER_MAP = "scumble.instancer"  # the UV map that holds an instance's place in its instancer's map

READS_ALPHA = "scumble_reads_alpha"  # property of a node: whether something reads its image's alpha

ORIGINAL, ORIGINAL_FULL = "scumble_original", "scumble_original_full"  # properties of a stand-in: the other's names

LUMINANCE = (0.2126, 0.7152, 0.0722)  # of Blender's own colour space


def stand_for(other, original):
    """Gives an image of ours the names of the one in the user's file for which it stands."""
    other[ORIGINAL], other[ORIGINAL_FULL] = name_of(original), full_name_of(original)


def name_of(thing):
    """The name in the user's file of an image or a node."""
    return thing.get(ORIGINAL, thing.name)


def full_name_of(image):
    """The same with its library's, so that no other image of the file has it."""
    return image.get(ORIGINAL_FULL, image.name_full)


def principled_input(node, name):
    """The input of that older name; None where this Blender's node has none."""
    return node.inputs.get(PRINCIPLED_INPUTS.get(name, name)) or node.inputs.get(name)


def passed_through(output):
    """The input that a muted node hands on to that output; None where there is none."""
    return next((link.from_socket for link in output.node.internal_links if link.to_socket == output), None)


def trace(socket):
    """(output, input): the output that feeds this input, past reroutes and muted nodes, None where nothing does; and
    the last input on the way, None where a muted node hands nothing on."""
    while socket is not None and socket.is_linked and not socket.links[0].is_muted:
        source = socket.links[0].from_socket
        if source.node.type == "REROUTE":
            socket = source.node.inputs[0]
        elif source.node.mute:
            socket = passed_through(source)
        else:
            return source, socket
    return None, socket


def previous(socket):
    """The socket that feeds this one, past reroutes and muted nodes; None where nothing does."""
    return trace(socket)[0]


def constant(socket):
    """The value of an input, a number or a tuple as the input is; None where something else feeds it. Blender turns a
    colour into a number by its luminance."""
    source, last = trace(socket)
    if source is not None and source.node.type not in {"RGB", "VALUE"}:
        return None
    value, is_number = (source or socket).default_value, isinstance(socket.default_value, (int, float))
    if source is None and last not in (None, socket):
        value = 0.0  # a reroute or a muted node that nothing feeds
    if isinstance(value, (int, float)):
        return float(value) if is_number else (float(value),) * 3
    return sum(a * b for a, b in zip(LUMINANCE, value)) if is_number else tuple(value)[:3]


def is_plain_mapping(node):
    """Whether it turns, scales and moves coordinates in the plane of the image, all by constants."""
    if node.type != "MAPPING" or node.vector_type != "POINT":
        return False
    if any(previous(node.inputs[name]) is not None for name in ("Location", "Rotation", "Scale")):
        return False
    return max(abs(angle) for angle in node.inputs["Rotation"].default_value[:2]) < 1e-6


def is_used_panel(panel):
    """Whether an image's Texture Mapping panel moves its coordinates."""
    return any(panel.translation) or any(panel.rotation) or any(value != 1.0 for value in panel.scale)


def is_odd_panel(panel):
    """Whether it swaps or clamps them."""
    return panel.use_min or panel.use_max or (panel.mapping_x, panel.mapping_y, panel.mapping_z) != ("X", "Y", "Z")


def coordinates_of(socket):
    """The name of the UV map that a texture's coordinates come from, "" for the active one; and the fault in them, None
    where glTF has them."""
    source = previous(socket)
    if source is None or (source.node.type == "TEX_COORD" and source.name == "UV"):
        return "", None
    if source.node.type == "UVMAP":
        return source.node.uv_map, None
    if is_plain_mapping(source.node):
        below = previous(source.node.inputs["Vector"])
        if below is not None and below.node.type != "MAPPING":
            return coordinates_of(source.node.inputs["Vector"])
    return "", f"node '{name_of(source.node)}' ({source.node.type}) as coordinates"


def keeps_its_depth(image):
    """Whether the exporter copies the file as it is, so that more than 8 bits stay."""
    return not image.is_float or (image.source == "FILE" and image.file_format == "PNG" and not image.is_dirty)


def is_raw(image):
    """Whether Cycles takes the numbers in the file as they are."""
    space = image.colorspace_settings
    return space.is_data or space.name in {"Non-Color", "Raw", "Linear", "Linear Rec.709"}


def holds_colours(image):
    """Whether glTF can take it for a picture of colours."""
    return image.colorspace_settings.name == "sRGB" and not image.is_float


def holds_numbers(image):
    return is_raw(image) and keeps_its_depth(image)


def place_fault(node):
    """The fault in how and where an image lies on a surface; None where glTF has it."""
    if node.projection != "FLAT" or node.extension == "CLIP":
        return f"node '{name_of(node)}' with {node.projection} projection and extension {node.extension}"
    if is_odd_panel(node.texture_mapping):
        return f"node '{name_of(node)}' with a projection or limits in its Texture Mapping panel"
    return coordinates_of(node.inputs["Vector"])[1]


def image_fault(node, use):
    """The fault in an image texture; None where glTF has it. `use`: export_images.fault has them."""
    image = node.image
    if image is None:
        return f"node '{name_of(node)}' without an image"
    fault = place_fault(node)
    if fault is not None:
        return fault
    if image.source not in {"FILE", "GENERATED"}:
        return f"node '{name_of(node)}' with an image of source {image.source}"
    if use == "alpha" or (use != "data" and holds_colours(image)) or (use != "colour" and holds_numbers(image)):
        return None
    if use == "height" and image.colorspace_settings.name == "sRGB" and keeps_its_depth(image):
        return None
    bits = ", of more than 8 bits" if image.is_float else ""
    return f"node '{name_of(node)}' with an image in {image.colorspace_settings.name}{bits}"


def placement_of(node, shown_map):
    """Where and how an image texture without a fault lies on the surface."""
    name = coordinates_of(node.inputs["Vector"])[0] or shown_map
    source = previous(node.inputs["Vector"])
    numbers = (0.0, 0.0, 0.0, 1.0, 1.0)
    if source is not None and source.node.type == "MAPPING":
        at, turn, scale = (source.node.inputs[key].default_value for key in ("Location", "Rotation", "Scale"))
        numbers = (at[0], at[1], turn[2], scale[0], scale[1])
    return name, *(round(number, 6) for number in numbers)


def one_texture(first, second, shown_map):
    """Whether one texture of glTF can hold both images. `shown_map`: the UV map that renders take, "" if unknown."""
    return placement_of(first, shown_map) == placement_of(second, shown_map)


def clear_links(tree, socket):
    for link in list(socket.links):
        tree.links.remove(link)
