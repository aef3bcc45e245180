"""Shared by export_scene.py and render_guides.py: the choice of Blender, scene and camera, and the form of messages.

Both must choose alike, or a cross-check compares two different pictures. docs/blender.md states the rules.
"""

import os
import re
import sys

import bpy
from mathutils import Matrix

TESTED = "3.4.1 and 4.3.2"
KNOWN = {(3, 4), (4, 3)}  # their light formulas, node sockets and the glTF exporter's options
FIRST, BEYOND = (3, 4), (5, 0)
EXIT_INPUT, EXIT_VERSION = 3, 5

# Blender's axes (+Z up) to glTF's (+Y up): x, z, -y.
GLTF_FROM_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))

LONGEST_LINE = 380  # bytes; guidegen keeps 400 of a line in the extras, and the same line of both scripts counts once


class Unsupported:
    """Collects losses in export or rendering, each line once, in order."""

    def __init__(self):
        self.lines = []

    def add(self, line):
        """Names in it may hold anything; it stays one line of valid UTF-8."""
        text = "".join(" " if ord(c) < 32 or ord(c) == 127 else c for c in line).encode("utf-8", "replace")
        if len(text) > LONGEST_LINE:
            text = text[:LONGEST_LINE].decode("utf-8", "ignore").encode("utf-8") + "…".encode("utf-8")
        line = text.decode("utf-8")
        if line not in self.lines:
            self.lines.append(line)

    def say(self):
        for line in self.lines:
            say("unsupported: " + line)


def say(text):
    sys.stdout.flush()
    print("scumble: " + text, file=sys.stderr, flush=True)


def fail(message, code=EXIT_INPUT):
    say("error: " + message)
    sys.exit(code)


def dotted(version):
    return ".".join(str(number) for number in version)


def check_version(way_out=""):
    """Ends the program in a Blender that is not supported. `way_out`: the user's alternative."""
    if not FIRST <= bpy.app.version[:2] < BEYOND:
        fail(f"this is Blender {bpy.app.version_string}; versions from {dotted(FIRST)} up to, but not including, "
             f"{dotted(BEYOND)} are supported ({TESTED} are tested): name another one with --blender" + way_out,
             EXIT_VERSION)


def note_version(unsupported):
    """Of a supported version that nobody has tested."""
    if bpy.app.version[:2] not in KNOWN:
        unsupported.add(f"Blender {bpy.app.version_string} is not tested, Blender {TESTED} are: lamps, materials and "
                        "normals may mean something else in it")


def note_newer_files(unsupported):
    """A file keeps the version that saved it, but not the last number of it."""
    running = bpy.app.version[:2]
    files = [("the file", bpy.data.version)] if bpy.data.filepath else []
    files += [(f"library '{library.filepath}'", library.version) for library in bpy.data.libraries]
    for what, version in files:
        if tuple(version[:2]) > running:
            unsupported.add(f"{what} was saved by Blender {dotted(version[:2])} and is read by the older Blender "
                            f"{bpy.app.version_string}, which loses what it does not know: name a newer one with "
                            "--blender")


def action_curves(thing):
    """The animation curves of a data-block. From Blender 4.4 on an action has slots, each with curves of its own."""
    data = thing.animation_data
    action = data.action if data else None
    if action is None:
        return []
    slot = getattr(data, "action_slot", None)
    if slot is None:
        return list(getattr(action, "fcurves", []))
    bags = [strip.channelbag(slot) for layer in action.layers for strip in layer.strips if strip.type == "KEYFRAME"]
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def release(thing, paths):
    """Takes animation and drivers off the settings whose paths match: the next evaluation would bring them back."""
    data = getattr(thing, "animation_data", None)
    if data is None:
        return
    curves = list(action_curves(thing))
    for strip in (strip for track in data.nla_tracks for strip in track.strips if strip.action):
        curves += getattr(strip.action, "fcurves", [])
    for curve in curves:
        curve.mute = curve.mute or paths.search(curve.data_path) is not None
    for driver in [driver for driver in data.drivers if paths.search(driver.data_path)]:
        data.drivers.remove(driver)


def listed(names, most=3):
    """'a', 'b', 'c' and 4 more"""
    more = len(names) - most
    return ", ".join(f"'{name}'" for name in names[:most]) + (f" and {more} more" if more > 0 else "")


def why_not_opened():
    """From the head of the .blend among the arguments: "BLENDER-v403", from Blender 5 on "BLENDER17-01v0500". Blender 4
    leaves it readable in compressed files, too."""
    path = next((argument for argument in sys.argv if argument.lower().endswith(".blend")), None)
    head = b""
    if path is not None and os.path.isfile(path):
        with open(path, "rb") as file:
            head = file.read(64)
    match = re.search(rb"BLENDER(?:[-_][vV](\d)(\d\d)|\d\d-\d\d[vV](\d\d)(\d\d))", head)
    version = tuple(int(number) for number in match.groups() if number) if match else bpy.app.version[:2]
    if version > bpy.app.version[:2]:
        return (f"it was saved by Blender {dotted(version)}, and this is the older Blender {bpy.app.version_string}: "
                "name a newer one with --blender")
    return f"it is no .blend file, or one of a newer Blender than this {bpy.app.version_string}"


def choose_scene(name):
    if not bpy.data.filepath:
        fail("Blender did not open the file: " + why_not_opened())
    if name is None:
        return bpy.context.window.scene
    if name not in bpy.data.scenes:
        fail(f"there is no scene '{name}'; there are: " + ", ".join(f"'{scene.name}'" for scene in bpy.data.scenes))
    return bpy.data.scenes[name]


def choose_layer(scene, name=None):
    """The view layer of that name, rendered or not; without a name the first one that is rendered."""
    if name is None:
        return next((layer for layer in scene.view_layers if layer.use), scene.view_layers[0])
    if name not in scene.view_layers:
        fail(f"scene '{scene.name}' has no view layer '{name}'; there are: "
             + ", ".join(f"'{layer.name}'" for layer in scene.view_layers))
    return scene.view_layers[name]


# ---- Cameras --------------------------------------------------------------------------------------------------------


def camera_names(cameras):
    """The name of each camera. A linked one may have the name of a local one, and is then that name's #2, or the next
    one that is free."""
    named, others = {}, []
    for camera in sorted(cameras, key=lambda camera: camera.name_full):
        if named.setdefault(camera.name, camera) != camera:
            others.append(camera)
    for camera in others:
        number = 2
        while f"{camera.name}#{number}" in named:
            number += 1
        named[f"{camera.name}#{number}"] = camera
    return {camera: name for name, camera in named.items()}


def can_be_looked_through(thing):
    return thing.type == "CAMERA" and thing.data.type in {"PERSP", "ORTHO"}


def why_lost(thing):
    """Why nothing can be seen through this camera of a scene."""
    if thing.type != "CAMERA":
        return f"is of type {thing.type}"
    return "has no direction" if can_be_looked_through(thing) else "is panoramic"


def cameras_of(scene, unsupported):
    """The cameras of the scene, the active one first, the others by name. A hidden camera counts: cameras are never
    rendered."""
    found = {thing for thing in scene.objects if thing.type == "CAMERA"} | ({scene.camera} - {None})
    usable, names = [], camera_names(found)
    for thing in sorted(found, key=lambda thing: (thing != scene.camera, names[thing])):
        if can_be_looked_through(thing):
            usable.append(thing)
        else:
            unsupported.add(f"camera '{thing.name}': {why_lost(thing)}, left out")
    return usable


def has_direction(name, matrix, unsupported):
    """Whether a camera at this place looks somewhere: its axes up and backward have a length, and
    are not parallel."""
    up, backward = (matrix.col[axis].to_3d() for axis in (1, 2))
    if up.cross(backward).length > 1e-9 * up.length * backward.length:
        return True
    unsupported.add(f"camera '{name}': its scale leaves it no direction, left out")
    return False


def note_crooked_camera(name, matrix, unsupported):
    """Cycles takes the lengths of a camera's axes away and keeps their angles and their handedness."""
    axes = [matrix.col[i].to_3d().normalized() for i in range(3)]
    square = all(abs(axes[i].dot(axes[j])) < 1e-5 for i, j in ((0, 1), (0, 2), (1, 2)))
    mirrored = axes[0].cross(axes[1]).dot(axes[2]) < 0.0
    if mirrored or not square:
        what = "mirrors" if square else "shears" if not mirrored else "shears and mirrors"
        unsupported.add(f"camera '{name}': the scale of what it hangs on {what} Cycles' picture; guides are seen by a "
                        "straight camera instead: take the scale away")
