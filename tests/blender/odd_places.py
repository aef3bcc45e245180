"""What moves, is flat, or takes its limits and places from what instances it: part of make_oddities.py."""

import bpy
from odd_materials import diffuse, fill_map, picture, plane, shader, textured
from odd_objects import nodes

LAST = 10  # frame


def move(owner, path, first, last):
    for frame, value in ((1, first), (LAST, last)):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)


def rig():
    """A camera of the name that the scene's own has, in a file of its own."""
    group = bpy.data.collections.new("Rig")
    camera = bpy.context.scene.camera
    bpy.context.scene.collection.objects.unlink(camera)
    group.objects.link(camera)
    bpy.context.scene.collection.children.link(group)


def link(path, name):
    with bpy.data.libraries.load(str(path), link=True, relative=True) as (_, wanted):
        wanted.collections = [name]
    group = next(one for one in bpy.data.collections if one.name == name and one.library)
    bpy.context.scene.collection.children.link(group)
    return group


def cameras(path):
    """The linked one is active, in a collection that the view layer excludes; the others look at nothing. One has the
    name that the linked one would get."""
    scene = bpy.context.scene
    scene.camera.location.x = 100
    scene.camera = link(path, "Rig").objects[0]
    bpy.context.view_layer.layer_collection.children["Rig"].exclude = True
    third = bpy.data.objects.new("Above#2", scene.camera.data)
    third.location.x = 200
    scene.collection.objects.link(third)


def asset():
    """What wants a style beside this file, one that is bundled, and none, though folders are called so."""
    group = bpy.data.collections.new("Styled")
    bpy.context.scene.collection.children.link(group)
    paint = diffuse("styled", (0, 1, 0))
    paint["scumble_style"] = "ink"
    for name, cell, style in (("Beside", 30, "paints/ink"), ("Bundled", 31, "oil"), ("Reserved", 32, "catcher")):
        plane(name, cell, paint, group)["scumble_style"] = style


def animated():
    image = picture("Scrolled")
    for name, cell in (("Keyed", 0), ("Driven", 1)):
        material = textured(name.lower(), image, ("Mapping", {}), ("TexCoord", {}))
        at = material.node_tree.nodes["Mapping"].inputs["Location"]
        if name == "Keyed":
            move(at, "default_value", (0, 0, 0), (0.5, 0.25, 0))
        else:
            driver = at.driver_add("default_value", 0).driver
            driver.type = "SUM"
            target = driver.variables.new().targets[0]
            target.id, target.data_path = bpy.context.scene.objects["Clock"], "location[0]"
        plane(name, cell, material)
    fade, _, surface = shader("fade", "ShaderNodeBsdfPrincipled")
    move(surface.inputs["Alpha"], "default_value", 1, 0)
    plane("Fade", 2, fade)


def flat():
    red = diffuse("red", (1, 0, 0))
    plane("Flat", 3, red).scale = (1, 1, 0)
    tilted = plane("Tilted", 4, red)
    tilted.scale, tilted.rotation_euler = (-1, 0.6, 0), (0.5, 0.3, 0.2)
    plane("Line", 5, red).scale = (1, 0, 0)


def flat_instances():
    """Objects of one mesh. Cycles casts rays without a direction at them, for which some builds of Embree abort."""
    shared = plane("Shared", 5, diffuse("red", (1, 0, 0)))
    shared.scale = (0.4, 0.4, 0)
    bpy.context.scene.collection.objects.link(shared.copy())


def short_hair(name, place):
    """Two curves of three points, and one of a point."""
    data = bpy.data.hair_curves.new(name)
    thing = bpy.data.objects.new(name, data)
    thing.location = place
    bpy.context.scene.collection.objects.link(thing)

    def build(tree, _):
        join = tree.nodes.new("GeometryNodeJoinGeometry")
        for number, points in enumerate((3, 1, 3)):
            line, resample = (tree.nodes.new("GeometryNode" + kind) for kind in ("CurvePrimitiveLine", "ResampleCurve"))
            line.inputs["Start"].default_value = (-0.3, 0.2 * number - 0.2, 0)
            line.inputs["End"].default_value = (0.3, 0.2 * number - 0.2, 0)
            resample.inputs["Count"].default_value = points
            tree.links.new(line.outputs[0], resample.inputs["Curve"])
            radius = tree.nodes.new("GeometryNodeSetCurveRadius")
            radius.inputs["Radius"].default_value = 0.05
            tree.links.new(resample.outputs[0], radius.inputs["Curve"])
            tree.links.new(radius.outputs[0], join.inputs[0])
        return join.outputs[0]
    nodes(thing, build)
    return thing


def lamps():
    """Of each kind one that is flattened, and two that shine. Their names say the axes with a scale."""
    for kind in ("POINT", "SUN", "SPOT", "AREA"):
        for axes in ("", "xy", "z", "yz", "xyz"):
            lamp = bpy.data.lights.new(kind, kind)
            lamp.energy, lamp.use_shadow = 1, True
            thing = bpy.data.objects.new(f"{kind} {axes}".strip(), lamp)
            thing.visible_camera = False
            thing.scale = [float(axis in axes) for axis in "xyz"]
            thing.location, thing.rotation_euler = (50, 0, 5), (0.3, 0.2, 0.1)
            bpy.context.scene.collection.objects.link(thing)
    parent = bpy.data.objects.new("Parent", None)
    parent.scale = (1, 0.4, 1)
    thing = bpy.data.objects.new("Sheared", bpy.data.lights.new("Sheared", "AREA"))
    thing.visible_camera = False
    thing.parent, thing.rotation_euler = parent, (0.6, 0.5, 0.4)
    for one in (parent, thing):
        bpy.context.scene.collection.objects.link(one)


def panel(material, **values):
    mapping = material.node_tree.nodes["Image Texture"].texture_mapping
    for name, value in values.items():
        setattr(mapping, name, value)
    return material


def coordinates():
    """Images at places that few nodes say."""
    image = picture("Places")
    plane("Panel", 8, panel(textured("panel", image), scale=(0.5, 2, 1), translation=(0.3, 0.1, 0)))
    below = textured("panel below", image, ("Mapping", {"Rotation": (0, 0, 0.3)}), ("TexCoord", {}))
    plane("PanelBelow", 9, panel(below, scale=(2, 2, 1), rotation=(0, 0, 0.4)))
    named = textured("vector", image, ("UVMap", {"uv_map": "place"}))
    thing = plane("Vector", 10, named)
    data = thing.data.attributes.new("place", "FLOAT_VECTOR", "POINT").data
    for vertex, item in zip(thing.data.vertices, data):
        item.vector = (vertex.co.y + 0.45, vertex.co.x + 0.45, 1)
    # Maps that are added, on meshes whose first material takes the map that renders take: there is none.
    for cell, reads in ((19, {"uv_map": "tint"}), (20, {"from_instancer": True})):
        thing = plane(f"NoMap{cell}", cell, textured(f"no map {cell}", image, ("TexCoord", {})))
        thing.data.uv_layers.remove(thing.data.uv_layers[0])
        thing.data.materials.append(textured(f"added {cell}", image, ("UVMap", reads)))
        for polygon in thing.data.polygons:
            polygon.material_index = int(polygon.index % 4 > 0)
    tinted = bpy.data.objects["NoMap19"]
    data = tinted.data.attributes.new("tint", "FLOAT_COLOR", "POINT").data
    for vertex, item in zip(tinted.data.vertices, data):
        item.color = (vertex.co.y + 0.45, vertex.co.x + 0.45, 1, 1)
    ground = plane("GroundNoMap", 20, diffuse("ground", (0.2, 0.2, 0.2)))
    ground.instance_type, ground.show_instancer_for_render = "FACES", False
    stone = bpy.data.objects["NoMap20"]
    stone.parent, stone.scale, stone.location = ground, (0.2, 0.2, 0.2), (0, 0, 0)
    for cell, kind in ((16, "TexCoord"), (18, "UVMap")):
        chain = {"from_instancer": True} | ({"uv_map": "UVMap"} if kind == "UVMap" else {})
        stone = plane("Stone" + kind, 39, textured("instancer " + kind, image, (kind, chain)))
        ground = plane("Ground" + kind, cell, diffuse("ground", (0.2, 0.2, 0.2)))
        fill_map(ground.data, "UVMap", 1.0)
        ground.instance_type, ground.show_instancer_for_render = "FACES", False
        stone.parent, stone.scale, stone.location = ground, (0.2, 0.2, 0.2), (0, 0, 0)
    plane("OwnUV", 17, bpy.data.materials["instancer TexCoord"])


def flat_camera():
    camera = bpy.data.objects.new("Flat", bpy.data.cameras.new("Flat"))
    camera.scale = (1, 1, 0)
    bpy.context.scene.collection.objects.link(camera)


def scattered():
    """More instances that take their instancer's UV than meshes may be made for that."""
    seed = plane("Seed", 39, textured("scattered", picture("Scattered"), ("TexCoord", {"from_instancer": True})))
    ground = plane("Field", 39, diffuse("ground", (0.2, 0.2, 0.2)))
    smooth = ground.modifiers.new("Smooth", "SUBSURF")
    smooth.subdivision_type, smooth.levels, smooth.render_levels = "SIMPLE", 3, 3
    ground.instance_type, ground.show_instancer_for_render = "FACES", False
    seed.parent = ground


def instancers():
    group = bpy.data.collections.new("Group")
    plane("Member", 0, diffuse("member", (0, 0, 1)), group)
    plane("Own", 8, diffuse("own", (0, 1, 1)), group)["scumble_style"] = "oil"
    for number, (name, values) in enumerate((("Plain", {}), ("Dark", {"visible_shadow": False}),
                                             ("Catch", {"is_shadow_catcher": True}), ("Wish", {}),
                                             ("Unseen", {"visible_camera": False}))):
        empty = bpy.data.objects.new(name, None)
        empty.instance_type, empty.instance_collection = "COLLECTION", group
        empty.location = (number, -4, 0)
        for key, value in values.items():
            setattr(empty, key, value)
        bpy.context.scene.collection.objects.link(empty)
    bpy.data.objects["Wish"]["scumble_style"] = "ink"
    inner, outer = (bpy.data.objects.new(name, None) for name in ("Inner", "Outer"))
    nest = bpy.data.collections.new("Nest")
    for empty, instanced, holder in ((inner, group, nest), (outer, nest, bpy.context.scene.collection)):
        empty.instance_type, empty.instance_collection = "COLLECTION", instanced
        holder.objects.link(empty)
    inner["scumble_style"] = "ink"


def build(folder):
    clock = bpy.data.objects.new("Clock", None)
    bpy.context.scene.collection.objects.link(clock)
    move(clock, "location", (0, 0, 0), (0.3, 0, 0))
    bpy.context.view_layer.update()
    for part in (animated, flat, coordinates):
        part()
    short_hair("Short", (7, 0, 0))
    cameras(folder / "rig.blend")


def build_limits(folder):
    lamps()
    flat_instances()
    scattered()
    short_hair("FlatHair", (7, 0, 0)).scale = (1, 1, 0)
    flat_camera()
    instancers()
    link(folder / "assets" / "styled.blend", "Styled")
