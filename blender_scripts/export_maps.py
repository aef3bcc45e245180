"""UV maps that materials name: part of export_scene.py.

glTF's textures give the number of a map, and Blender's exporter takes it from any one of the meshes that share the
material. So each order of the maps gets a copy of the material. A map that a mesh lacks is zero everywhere in Cycles.
"""

from export_nodes import coordinates_of

MOST_MAPS = 8  # of a mesh in Blender


def named_maps(material):
    """The UV maps that the images of a simplified material name, in order."""
    if not material.use_nodes or not material.node_tree:
        return []
    names = {coordinates_of(node.inputs["Vector"])[0] for node in material.node_tree.nodes if node.type == "TEX_IMAGE"}
    return sorted(names - {""})


def number_of(mesh, name):
    """The number of a map, which is added if it is missing; None where there is no room."""
    number = mesh.uv_layers.find(name)
    if number < 0 and len(mesh.uv_layers) < MOST_MAPS:
        shown = next((layer.name for layer in mesh.uv_layers if layer.active_render), None)
        mesh.uv_layers.new(name=name, do_init=False)
        if shown is not None:
            mesh.uv_layers[shown].active_render = True
        number = mesh.uv_layers.find(name)
    return None if number < 0 else number


def material_for(mesh, key, materials, complain):
    """The exporter's material for that key on that mesh; `materials` gets an entry for each copy."""
    entry = materials[key]
    names = named_maps(entry["material"])
    if not names:
        return entry["material"]
    numbers = tuple(number_of(mesh, name) for name in names)
    if None in numbers:
        complain(f"has no room for UV map '{names[numbers.index(None)]}', which material '{entry['name']}' reads")
    if entry.setdefault("maps", numbers) == numbers:
        return entry["material"]
    if (key, numbers) not in materials:
        copy = entry["material"].copy()
        copy.name = f"scumble.{len(materials):06d}"
        materials[key, numbers] = {**entry, "material": copy, "exported": copy.name}
    return materials[key, numbers]["material"]
