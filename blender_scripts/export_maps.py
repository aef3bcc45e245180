"""UV maps that materials name: part of export_scene.py.

glTF's textures give the number of a map, and Blender's exporter takes it from any one of the meshes that share the
material. So the meshes, the export's own copies, get their maps in one order. Where several materials of a mesh want
different orders, a copy of the material has another number. A map that a mesh lacks is zero everywhere in Cycles.

The UV of an instancer is one point for each instance. Meshes with a material that reads it are not shared then, unless
there would be too many.
"""

import bpy
import numpy as np

from blend_common import listed
from export_nodes import INSTANCER_MAP, coordinates_of

NEARLY_ZERO = 1e-6
MOST_MAPS = 8  # of a mesh in Blender
MOST_MESHES, MOST_CORNERS = 1000, 4_000_000  # of those that are not shared: some 5 seconds


def maps_of(material):
    """The UV maps that the images of a simplified material read, in order; "" is the one that renders take."""
    if not material.use_nodes or not material.node_tree:
        return []
    return sorted({coordinates_of(node.inputs["Vector"])[0] for node in material.node_tree.nodes
                   if node.type == "TEX_IMAGE"})


def instancer_readers(depsgraph, unsupported):
    """The full names of the materials that take the UV of what instances them; none where that takes too many meshes,
    whose images are then read at one place."""
    readers = {material.name_full for material in bpy.data.materials
               if material.use_nodes and material.node_tree
               and any(getattr(node, "from_instancer", False) and node.outputs["UV"].is_linked
                       for node in material.node_tree.nodes)}
    if not readers:
        return readers
    corners = {}
    for instance in depsgraph.object_instances:
        if reads_instancer(instance, readers):
            data = instance.object.data
            corners[(data.as_pointer(), *instance.uv)] = len(getattr(data, "loops", ()))
    total = sum(corners.values())
    if len(corners) <= MOST_MESHES and total <= MOST_CORNERS:
        return readers
    unsupported.add(f"materials that take the UV of the instancer ({listed(sorted(readers))}): instances cannot share "
                    f"meshes for it, and {len(corners)} meshes with {total} corners are more than {MOST_MESHES} or "
                    f"{MOST_CORNERS}, so their images are read at (0, 0)")
    return set()


def reads_instancer(instance, readers):
    """Whether a material of an instance is one of those. Blender 3.4.1 crashes at the slots of an Empty."""
    if not readers or not instance.is_instance or instance.object.type not in {"MESH", "META"}:
        return False
    materials = [slot.material for slot in instance.object.material_slots]
    return any(material is not None and material.original.name_full in readers for material in materials)


def add_instancer_map(mesh, uv):
    if len(mesh.uv_layers) < MOST_MAPS:  # else number_of says so
        add_map(mesh, INSTANCER_MAP, np.tile(np.array(uv, np.float32), len(mesh.loops)))


def shown_map(mesh):
    return next((layer.name for layer in mesh.uv_layers if layer.active_render), "")


def drop_unread(mesh, read):
    """glTF's readers often know two maps only, ours too. The one that renders take stays if there is room."""
    kept = set(read) - {""}
    if "" in read or len(kept) < 2:
        kept.add(shown_map(mesh))
    for name in [layer.name for layer in mesh.uv_layers if layer.name not in kept]:
        mesh.uv_layers.remove(mesh.uv_layers[name])


def add_map(mesh, name, values=None):
    """One that does not become the one that renders take. Where there is none, that is zero everywhere, as is a map
    without values; nearly, because glTF's v would be 1, which belongs to the other end of an image that repeats."""
    if values is not None and not mesh.uv_layers:
        add_map(mesh, "scumble.0")
    shown = shown_map(mesh)
    mesh.uv_layers.new(name=name, do_init=False)
    if values is None:
        values = np.full(2 * len(mesh.loops), NEARLY_ZERO, np.float32)
    mesh.uv_layers[name].data.foreach_set("uv", values)
    if shown:
        mesh.uv_layers[shown].active_render = True


def swap(mesh, first, second):
    a, b = mesh.uv_layers[first], mesh.uv_layers[second]
    at_a, at_b = (np.empty(2 * len(mesh.loops), np.float32) for _ in range(2))
    a.data.foreach_get("uv", at_a)
    b.data.foreach_get("uv", at_b)
    a.data.foreach_set("uv", at_b)
    b.data.foreach_set("uv", at_a)
    name_a, name_b, shown = a.name, b.name, [layer.active_render for layer in mesh.uv_layers]
    a.name = "scumble"
    mesh.uv_layers[second].name = name_a
    mesh.uv_layers[first].name = name_b
    if shown[first] != shown[second]:
        mesh.uv_layers[second if shown[first] else first].active_render = True


def number_of(mesh, name, wanted, taken):
    """The number of a map, which is added if it is missing; None where there is no room. It is `wanted` if that is not
    None, and no other map's that a material of this mesh has `taken`."""
    name = name or shown_map(mesh)
    if mesh.uv_layers.find(name) < 0 and len(mesh.uv_layers) < MOST_MAPS:
        add_map(mesh, name)
    number = mesh.uv_layers.find(name)
    if number < 0:
        return None
    if number not in taken and wanted is not None and wanted not in taken:
        while len(mesh.uv_layers) <= wanted:
            add_map(mesh, f"scumble.{len(mesh.uv_layers)}")
        if number != wanted:
            swap(mesh, number, wanted)
        number = wanted
    taken.add(number)
    return number


def material_for(mesh, key, materials, taken, complain):
    """The exporter's material for that key on that mesh; `materials` gets an entry for each copy. `taken`: the numbers
    of maps that the mesh's other materials read."""
    entry = materials[key]
    names = [name for name in maps_of(entry["material"]) if name or mesh.uv_layers]
    if not names:
        return entry["material"]
    wanted = entry.get("maps", {})
    numbers = {name: number_of(mesh, name, wanted.get(name), taken) for name in names}
    for name in (name for name, number in numbers.items() if number is None):
        complain(f"has no room for UV map '{name}', which material '{entry['name']}' reads")
    if all(wanted.get(name, number) == number for name, number in numbers.items()):
        entry["maps"] = {**wanted, **numbers}
        return entry["material"]
    copy_key = (key, *sorted(numbers.items()))
    if copy_key not in materials:
        copy = entry["material"].copy()
        copy.name = f"scumble.{len(materials):06d}"
        materials[copy_key] = {**entry, "material": copy, "exported": copy.name}
    return materials[copy_key]["material"]


def materials_for(mesh, keys, materials, complain):
    """The exporter's material of each slot of a mesh, whose maps become those that they read."""
    drop_unread(mesh, {name for key in keys for name in maps_of(materials[key]["material"])})
    taken = set()
    return [material_for(mesh, key, materials, taken, complain) for key in keys]
