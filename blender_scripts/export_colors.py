"""Colour attributes as Cycles reads them: part of export_scene.py.

glTF multiplies vertex colours into every material. Each corner therefore gets the attribute that the material of its
face reads, and white if that reads none. Blender 3.4's exporter mixes up the colours of corners and leaves attributes
of other types white. It writes our colours as an attribute of its own, which export_glb.py renames to COLOR_0.
"""

import numpy as np

from export_flat import material_key
from export_maps import MOST_MAPS, add_map, maps_of

ATTRIBUTE = "_scumble_color"  # as in export_rest.py
# How attributes of each type that Cycles reads store their values: the property and the number of them.
TYPES = {"FLOAT": ("value", 1), "INT": ("value", 1), "BOOLEAN": ("value", 1), "FLOAT2": ("vector", 2),
         "FLOAT_VECTOR": ("vector", 3), "FLOAT_COLOR": ("color", 4), "BYTE_COLOR": ("color", 4)}


def colors_of(data, name, width):
    """Numbers are grey, and pairs have no blue."""
    values = np.empty(width * len(data), np.float32)
    data.foreach_get(name, values)
    values = values.reshape(-1, width)
    if width == 1:
        return np.repeat(values, 3, axis=1)
    return np.pad(values, ((0, 0), (0, 1))) if width == 2 else values[:, :3]


def of_faces(mesh, values):
    totals = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", totals)
    return np.repeat(values, totals, axis=0)


def of_edges(mesh, values):
    """Each vertex has the mean of its edges."""
    ends = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", ends)
    sums, counts = np.zeros((len(mesh.vertices), 3), np.float32), np.bincount(ends, minlength=len(mesh.vertices))
    np.add.at(sums, ends, np.repeat(values, 2, axis=0))
    return sums / np.maximum(counts, 1)[:, None]


SPREAD = {"FACE": ("CORNER", of_faces), "EDGE": ("POINT", of_edges)}


def black(mesh):
    return "POINT", np.zeros((len(mesh.vertices), 3), np.float32)


def read(mesh, name, only_colors):
    """(domain, colours): by vertex if possible, else by corner. What is missing is black in Cycles."""
    attribute = mesh.attributes.get(name)
    if only_colors and (attribute is None or attribute.data_type not in {"FLOAT_COLOR", "BYTE_COLOR"}):
        return black(mesh)
    if attribute is not None and attribute.data_type in TYPES and attribute.domain in ("POINT", "CORNER", *SPREAD):
        colors = colors_of(attribute.data, *TYPES[attribute.data_type])
        if attribute.domain not in SPREAD:
            return attribute.domain, colors
        domain, spread = SPREAD[attribute.domain]
        return domain, spread(mesh, colors)
    if name in mesh.uv_layers:
        return "CORNER", colors_of(mesh.uv_layers[name].data, "uv", 2)
    return black(mesh)


def at_corners(mesh, domain, colors):
    if domain == "CORNER":
        return colors
    vertices = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", vertices)
    return colors[vertices]


def slots_of_corners(mesh, count):
    slots = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", slots)
    return of_faces(mesh, np.minimum(slots, count - 1))


def render_color(mesh):
    """The name of the colour attribute that renders take where a material names none."""
    index = mesh.color_attributes.render_color_index
    return mesh.color_attributes[index].name if 0 <= index < len(mesh.color_attributes) else ""


def colors_of_mesh(mesh, attributes):
    """(domain, colours) of a mesh whose materials read these attributes, export_materials.py's, one for each slot; None
    where no face reads any."""
    attributes = [attribute and (attribute[0] or render_color(mesh), attribute[1]) for attribute in attributes]
    slots = slots_of_corners(mesh, len(attributes))
    used = {attributes[slot] for slot in np.unique(slots)}
    if used <= {None}:
        return None
    if len(used) == 1:
        return read(mesh, *used.pop())
    colors = np.ones((len(mesh.loops), 3), np.float32)
    for number, attribute in enumerate(attributes):
        if attribute is not None:
            wanted = slots == number
            colors[wanted] = at_corners(mesh, *read(mesh, *attribute))[wanted]
    return "CORNER", colors


def meshes_with_slots(flat):
    """(mesh, materials) of each of the export's meshes once."""
    return {placed.mesh.name: (placed.mesh, placed.slots) for placed in flat.meshes}.values()


def maps_of_slots(slots, materials):
    return {name for slot in slots for name in maps_of(materials[material_key(slot)]["material"])}


def add_maps(flat, materials):
    """A UV Map node takes attributes of every kind by their name: those become maps, as far as there is room."""
    for mesh, slots in meshes_with_slots(flat):
        for name in sorted(maps_of_slots(slots, materials)):
            if name not in mesh.attributes or name in mesh.uv_layers or len(mesh.uv_layers) >= MOST_MAPS:
                continue
            values = at_corners(mesh, *read(mesh, name, False))[:, :2]
            mesh.attributes.remove(mesh.attributes[name])  # names are unique from Blender 3.5 on
            add_map(mesh, name, np.ascontiguousarray(values, np.float32).ravel())


def add_colors(flat, materials):
    """Replaces the colour attributes of all meshes, the export's own copies, except those that become maps; returns
    whether any is read."""
    found = False
    for mesh, slots in meshes_with_slots(flat):
        result = colors_of_mesh(mesh, [materials[material_key(slot)]["color_attribute"] for slot in slots])
        kept = maps_of_slots(slots, materials)
        for name in [attribute.name for attribute in mesh.color_attributes if attribute.name not in kept]:
            mesh.color_attributes.remove(mesh.color_attributes[name])
        if result is not None:
            found = True
            attribute = mesh.attributes.new(ATTRIBUTE, "FLOAT_VECTOR", result[0])
            attribute.data.foreach_set("vector", np.ascontiguousarray(result[1], np.float32).ravel())
    return found
