"""The style that an object or material asks for: part of export_scene.py."""

import os

import bpy

PROPERTY = "scumble_style"
TICKED = "catcher-or-rendered"  # what the box Shadow Catcher asks for
RESERVED = {"rendered", "catcher", TICKED}


def owner_of(thing):
    """The data-block that the property's value is from: of a library override perhaps the linked one."""
    override = getattr(thing, "override_library", None)
    linked = override.reference if override else None
    return linked if linked is not None and linked.get(PROPERTY) == thing.get(PROPERTY) else thing


def is_style(path):
    """A picture may be one, too."""
    return os.path.isfile(path) or os.path.isfile(os.path.join(path, "style.toml"))


def own_style(thing):
    """The property's text, None without one. The path of a style beside the library that the property is from, is that
    path, whichever file links it."""
    style = thing.get(PROPERTY)
    if not isinstance(style, str):
        return None
    library = owner_of(thing).library
    if library is not None and style and style not in RESERVED:
        folder = os.path.dirname(bpy.path.abspath(library.filepath, library=library.parent))
        path = os.path.normpath(os.path.join(folder, style))
        if is_style(path):
            return path
    return style


def is_catcher(thing):
    return getattr(thing, "is_shadow_catcher", False)


def style_of(thing, shown=None):
    """What an object or material asks for, None without a request. `shown` is the object in the scene that shows it.
    An Empty's request holds for its instances that have none of their own. Catchers instance catchers, as in
    Cycles."""
    style = own_style(thing)
    if style is None and shown is not None and shown.type == "EMPTY":
        style = own_style(shown)
    if style is None and (is_catcher(thing) or (shown is not None and is_catcher(shown))):
        style = TICKED
    return style


def note_nested(depsgraph, unsupported):
    """Blender says of an instance which object in the scene shows it, and not what is between the two."""
    requested = {thing for thing in bpy.data.objects
              if thing.type == "EMPTY" and thing.instance_type == "COLLECTION" and own_style(thing) is not None}
    for instance in depsgraph.object_instances if requested else ():
        if instance.is_instance and instance.object.original in requested:
            unsupported.add(f"object '{instance.object.original.name}': its style does not hold in the instances of "
                            f"'{instance.parent.original.name}': set it on an Empty in the scene itself")
