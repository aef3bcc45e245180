"""Faults of a .blend file apart from its scene: lost textures and libraries, drivers and scripts that do not run,
overrides without effect. Shared by export_scene.py and render_guides.py, with equal messages, so that a cross-check's
report has each of them once."""

import os

import bpy

from blend_common import listed, note_newer_files, note_version

PICTURES = {"IMAGE", "MULTILAYER", "UV_TEST"}  # not the renders and compositions that other nodes leave behind


def check_file(layer, unsupported):
    """Call it at the frame that is rendered: drivers are only known to fail once they have been asked."""
    note_version(unsupported)
    note_newer_files(unsupported)
    check_images(unsupported)
    check_libraries(unsupported)
    check_drivers(unsupported)
    for text in bpy.data.texts:
        if text.use_module:
            unsupported.add(f"script '{text.name}' inside the file is not run")
    if layer.material_override is not None:
        unsupported.add(f"view layer '{layer.name}': its material override '{layer.material_override.name}' is ignored")


def is_used(thing):
    return thing.users > (1 if thing.use_fake_user else 0)


def kind_of(thing):
    return thing.bl_rna.name.lower()


def every_id():
    """Every data-block with the name of its collection in bpy.data."""
    for kind in bpy.data.bl_rna.properties:
        if kind.type == "COLLECTION":
            for thing in getattr(bpy.data, kind.identifier):
                yield kind.identifier, thing


# ---- Images ---------------------------------------------------------------------------------------------------------


def images_in(tree, seen):
    """Of a node tree and its groups; `seen` collects the trees."""
    seen.add(tree)
    for node in tree.nodes:
        if getattr(node, "image", None) is not None:
            yield node.image
        group = getattr(node, "node_tree", None)
        if group is not None and group not in seen:
            yield from images_in(group, seen)


def file_exists(path, library=None):
    """`path` as Blender writes it: "//" is the folder of the file, "<UDIM>" the number of a tile."""
    whole = bpy.path.abspath(path, library=library)
    if "<UDIM>" not in whole and "<UVTILE>" not in whole:
        return os.path.exists(whole)
    start = os.path.basename(whole).split("<")[0]
    folder = os.path.dirname(whole)
    return os.path.isdir(folder) and any(name.startswith(start) for name in os.listdir(folder))


def is_lost(image):
    if image.type not in PICTURES or image.source in {"GENERATED", "VIEWER"}:
        return False
    if image.source == "FILE":
        return min(image.size) == 0  # asking for the size loads the picture, packed ones too
    return image.packed_file is None and not file_exists(image.filepath, image.library)


def check_images(unsupported):
    users = {}
    for things in (bpy.data.materials, bpy.data.worlds, bpy.data.lights):
        for thing in things:
            if is_used(thing) and thing.use_nodes and thing.node_tree:
                for image in images_in(thing.node_tree, set()):
                    users.setdefault(image, {})[f"{kind_of(thing)} '{thing.name}'"] = True
    for image, names in users.items():
        if is_lost(image):
            first, *others = names
            more = f" and {len(others)} more" if others else ""
            unsupported.add(f"image '{image.name}' cannot be read from '{image.filepath}': {first}{more} is exported "
                            "without it, white where it was the colour; in Cycles it is magenta")


# ---- Libraries ------------------------------------------------------------------------------------------------------


def check_libraries(unsupported):
    """Blender replaces missing data-blocks by empty ones."""
    linked = {}
    for collection, thing in every_id():
        if thing.library is not None:
            linked.setdefault(thing.library, []).append((collection, thing))
    for library in bpy.data.libraries:
        things = linked.get(library, [])
        # Blender keeps an indirect library's path relative to either file.
        path = next((path for path in (bpy.path.abspath(library.filepath, library=library.parent),
                                       bpy.path.abspath(library.filepath)) if os.path.isfile(path)), None)
        if path is None:
            if library.packed_file is None and things:
                unsupported.add(f"library '{library.filepath}' is missing: what is linked from it is left out, "
                                + listed([thing.name for _, thing in things]))
            continue
        lacking = missing_from(path, things)
        if lacking:
            unsupported.add(f"library '{library.filepath}' has lost what is linked from it, which is left out: "
                            + listed(lacking))


def missing_from(path, things):
    """The names of those things that a .blend file does not hold."""
    try:
        with bpy.data.libraries.load(path, link=True) as (names, _):
            held = {kind: set(getattr(names, kind)) for kind in dir(names)}
    except OSError:
        return [thing.name for _, thing in things]
    return [thing.name for kind, thing in things if kind in held and thing.name not in held[kind]]


# ---- Drivers --------------------------------------------------------------------------------------------------------


def broken_drivers(thing):
    data = getattr(thing, "animation_data", None)
    return [curve for curve in data.drivers if not curve.mute and not curve.driver.is_valid] if data else []


def check_drivers(unsupported):
    for _, thing in every_id():
        if not isinstance(thing, bpy.types.ID) or not is_used(thing):
            continue
        curves = broken_drivers(thing)
        tree = getattr(thing, "node_tree", None)
        if tree is not None:
            curves += broken_drivers(tree)
        if not curves:
            continue
        first = curves[0]
        what = f"{first.data_path}[{first.array_index}]"
        if first.driver.type == "SCRIPTED":
            what += f" = {first.driver.expression[:60]}"
        more = f" and {len(curves) - 1} more" if len(curves) > 1 else ""
        unsupported.add(f"{kind_of(thing)} '{thing.name}': its driver {what}{more} does not work here, where scripts "
                        "inside the file are not run: its value may be wrong")


# ---- Nothing to draw ------------------------------------------------------------------------------------------------


DRAWN = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


def counted(things):
    """'1 mesh is', '3 objects are'."""
    noun, plural = ("mesh", "meshes") if all(thing.type == "MESH" for thing in things) else ("object", "objects")
    return f"1 {noun} is" if len(things) == 1 else f"{len(things)} {plural} are"


def could_be_drawn(thing):
    return thing.type in DRAWN or (thing.instance_type == "COLLECTION" and thing.instance_collection is not None)


def obstacles(view_layer):
    """Of each object the collections that keep it from being rendered, each with the reason; only where all ways to the
    object are barred."""
    barred, free = {}, set()
    pending = [(view_layer.layer_collection, None)]
    while pending:
        layer, above = pending.pop()
        bar = above
        if bar is None and layer.exclude:
            bar = f"in collection '{layer.collection.name}', which view layer '{view_layer.name}' excludes"
        if bar is None and layer.collection.hide_render:
            bar = f"hidden from render in collection '{layer.collection.name}'"
        # An excluded collection says nothing about those in it, which the view layer may include.
        pending += [(child, None if bar and layer.exclude else bar) for child in layer.children]
        for thing in layer.collection.objects:
            if bar is None:
                free.add(thing)
            else:
                barred.setdefault(thing, bar)
    return {thing: bar for thing, bar in barred.items() if thing not in free}


def check_emptiness(scene, view_layer, unsupported):
    """For a scene of which nothing was exported: why."""
    reasons, barred = {}, obstacles(view_layer)
    for thing in scene.objects:
        if not could_be_drawn(thing):
            continue
        reason = barred.get(thing)
        if reason is None and thing.hide_render:
            reason = "hidden from render"
        if reason is None and not view_layer.use_solid:
            reason = "without hair, in a view layer whose filter leaves out surfaces"
        reasons.setdefault(reason or "without a surface that the camera sees", []).append(thing)
    if reasons:
        ranked = sorted(reasons.items(), key=lambda item: -len(item[1]))
        unsupported.add("nothing is left to draw: " + ", ".join(f"{counted(things)} {reason}"
                                                                for reason, things in ranked[:4]))
        return
    others = [other.name for other in bpy.data.scenes
              if other != scene and any(could_be_drawn(thing) for thing in other.objects)]
    unsupported.add(f"nothing is left to draw: scene '{scene.name}' has no mesh"
                    + (f"; {listed(others)} of this file has: choose it with --scene" if others else ""))
