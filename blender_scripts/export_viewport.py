"""Gives the viewport the render's settings, because scripts see a scene as the viewport does: part of export_scene.py.

The file is opened anew for each frame, so nothing is put back.
"""

import math
import re

import bpy

from blend_common import release

# Of a modifier, by its type: the viewport's property and the render's.
MODIFIERS = {"SUBSURF": ("levels", "render_levels"), "MULTIRES": ("levels", "render_levels"),
             "SCREW": ("steps", "render_steps"), "OCEAN": ("viewport_resolution", "resolution")}
DATA = (("resolution_u", "render_resolution_u"), ("resolution_v", "render_resolution_v"),
        ("resolution", "render_resolution"))
DICED = "scumble.diced"  # the modifier that stands for an adaptive subdivision
MOST_DICED, MOST_LEVELS = 40_000, 6  # its faces, unless the object's own modifier makes more
MOST_DICED_IN_ALL = 250_000  # of all objects of the scene
# Modifiers that leave as many faces as there were.
KEEPS_FACES = {"ARMATURE", "CAST", "CLOTH", "CORRECTIVE_SMOOTH", "CURVE", "DATA_TRANSFER", "DISPLACE", "HOOK",
               "LAPLACIANDEFORM", "LAPLACIANSMOOTH", "LATTICE", "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE",
               "NORMAL_EDIT", "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "SOFT_BODY", "SURFACE", "SURFACE_DEFORM",
               "UV_PROJECT", "UV_WARP", "VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX", "VERTEX_WEIGHT_PROXIMITY", "WARP",
               "WAVE", "WEIGHTED_NORMAL"}
# Paths of properties that are the viewport's. The resolution of an Ocean is the render's.
OF_VIEWPORT = re.compile(r"(hide_viewport|show_viewport|\.levels|\.steps|viewport_resolution|^resolution(_u|_v)?"
                         r"|show_instancer_for_viewport|display_percentage|display_step|child_nbr|child_percent)$")


def put(owner, name, value):
    """Each change costs an evaluation."""
    if getattr(owner, name) != value:
        setattr(owner, name, value)


def use_render_particles(settings):
    release(settings, OF_VIEWPORT)
    put(settings, "display_percentage", 100)
    if settings.child_type != "NONE":
        shown = "child_nbr" if hasattr(settings, "child_nbr") else "child_percent"  # from Blender 4.0 on
        put(settings, shown, settings.rendered_child_count)
    put(settings, "display_step", settings.render_step)


def is_adaptive(thing, scene):
    of_scene, of_object = getattr(scene, "cycles", None), getattr(thing, "cycles", None)
    if getattr(of_scene, "feature_set", "") != "EXPERIMENTAL" or not getattr(of_object, "use_adaptive_subdivision", 0):
        return False
    own = [modifier for modifier in thing.modifiers if modifier.name != DICED]
    if thing.type != "MESH" or not own or own[-1].type != "SUBSURF" or not own[-1].show_render:
        return False
    return own[-1].subdivision_type == "CATMULL_CLARK"  # the other kind makes more faces, and no other surface


def diced_levels(thing, scene):
    """The levels that stand for Cycles' adaptive subdivision of an object, whatever its view, so that all frames have
    equal triangles; None where there is none. Cycles subdivides what the modifier has subdivided once more."""
    if not is_adaptive(thing, scene):
        return None
    own = [modifier for modifier in thing.modifiers if modifier.name != DICED]
    if any(modifier.show_render and modifier.type not in KEEPS_FACES for modifier in own[:-1]):
        return 0  # nobody knows how many faces there are
    render = scene.render
    allowed = render.simplify_subdivision_render if render.use_simplify else MOST_LEVELS
    faces = max(len(thing.data.polygons), 1) * 4 ** min(own[-1].render_levels, allowed)
    others = sum(is_adaptive(other, scene) for other in scene.objects)
    most = min(MOST_DICED, MOST_DICED_IN_ALL / max(others, 1))
    return min(max(math.floor(math.log(most / faces, 4)), 0), allowed, MOST_LEVELS)


def dice(thing, levels):
    last = thing.modifiers[-1]
    more = thing.modifiers.new(DICED, "SUBSURF")
    more.levels = more.render_levels = levels
    more.uv_smooth, more.boundary_smooth = last.uv_smooth, last.boundary_smooth
    more.use_creases, more.use_limit_surface = last.use_creases, last.use_limit_surface


def use_render_modifiers(thing, scene):
    for modifier in thing.modifiers:
        put(modifier, "show_viewport", modifier.show_render)
        if modifier.type in MODIFIERS:
            viewport, render = MODIFIERS[modifier.type]
            put(modifier, viewport, getattr(modifier, render))
    levels = diced_levels(thing, scene)
    if levels and DICED not in thing.modifiers:
        dice(thing, levels)
    for system in thing.particle_systems:
        use_render_particles(system.settings)


def use_render_data(data):
    release(data, OF_VIEWPORT)
    for viewport, render in DATA:
        if getattr(data, render, 0) and hasattr(data, viewport):
            put(data, viewport, getattr(data, render))


def use_render_nodes(tree):
    """The node Is Viewport answers no."""
    for node in [node for node in tree.nodes if node.type == "IS_VIEWPORT"]:
        no = tree.nodes.new("FunctionNodeInputBool")
        no.boolean = False
        for link in list(node.outputs[0].links):
            tree.links.new(no.outputs[0], link.to_socket)


def unhide(view_layer):
    pending = [view_layer.layer_collection]
    while pending:
        layer = pending.pop()
        pending += layer.children
        put(layer, "hide_viewport", False)
        put(layer.collection, "hide_viewport", layer.collection.hide_render)
    for collection in bpy.data.collections:
        put(collection, "hide_viewport", collection.hide_render)


def take_settings(scene, view_layer):
    render = scene.render
    put(render, "simplify_subdivision", render.simplify_subdivision_render)
    put(render, "simplify_child_particles", render.simplify_child_particles_render)
    unhide(view_layer)
    for tree in bpy.data.node_groups:
        if tree.type == "GEOMETRY":
            use_render_nodes(tree)
    cameras = {thing for thing in scene.objects if thing.type == "CAMERA"}
    for thing in bpy.data.objects:
        release(thing, OF_VIEWPORT)
        # Cameras are never rendered; those of instanced collections stay hidden.
        is_camera = thing in cameras
        put(thing, "hide_viewport", thing.hide_render and not is_camera)
        put(thing, "show_instancer_for_viewport", thing.show_instancer_for_render)
        use_render_modifiers(thing, scene)
        if thing.data is not None:
            use_render_data(thing.data)
    for thing in view_layer.objects:
        if thing.hide_get(view_layer=view_layer):
            thing.hide_set(False, view_layer=view_layer)
    view_layer.update()


def hidden_objects(view_layer):
    """Those that the viewport does not show, though an instance may."""
    in_layer = set(view_layer.objects)
    return [thing for thing in bpy.data.objects
            if thing.hide_viewport or any(collection.hide_viewport for collection in thing.users_collection)
            or (thing in in_layer and not thing.visible_get(view_layer=view_layer))]


def bring_in(cameras, scene, view_layer):
    """Cameras that the view layer leaves out or does not show, so that the frame moves them as well."""
    for camera in cameras:
        held = camera in set(view_layer.objects) and camera.visible_get(view_layer=view_layer)
        if not held and scene.library is None and camera not in set(scene.collection.objects):
            scene.collection.objects.link(camera)


def show_as_rendered(scene, view_layer):
    """Animation of what was hidden only reaches the file's data once that was evaluated, and it may be that of the
    render's settings. What became visible has stale places until it is tagged. The others keep theirs: an emitter that
    is tagged would throw its particles away."""
    hidden = hidden_objects(view_layer)
    take_settings(scene, view_layer)
    if not hidden:
        return
    scene.frame_set(scene.frame_current)
    take_settings(scene, view_layer)
    for thing in hidden:
        thing.update_tag(refresh={"OBJECT"})
    view_layer.update()
