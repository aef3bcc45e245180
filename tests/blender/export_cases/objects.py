"""Objects: instances, modifiers, shape keys, texts, and what is hidden."""

import math

import bmesh
import bpy
from mathutils import Euler

from export_cases.parts import cube, link, new_material
import versions


def objects():
    scene = bpy.context.scene
    plain = new_material("Grey", "ShaderNodeBsdfDiffuse")[0]
    plain["scumble_style"] = "rendered"
    one = cube("One", (0, 0, 0), plain)
    one.pass_index = 5
    one["scumble_style"] = "oil"
    cube("Two", (3, 0, 0), data=one.data)
    cube("Mirrored", (6, 0, 0), data=one.data).scale = (-1, 1, 1)
    stretched = cube("Stretched", (9, 0, 0), data=one.data)
    stretched.scale = (1, 2, 0.5)
    stretched.rotation_euler = Euler((0, 0, 0.7))
    sheared = cube("Sheared", (0.5, 0.5, 0.25), plain)
    sheared.parent = stretched
    sheared.rotation_euler = Euler((0.3, 0.5, 0.2))
    cube("Hidden", (0, 5, 0), plain).hide_render = True
    only_viewport = cube("ViewportHidden", (3, 5, 0), plain)
    only_viewport.hide_viewport = True
    unrendered = bpy.data.collections.new("Unrendered")
    scene.collection.children.link(unrendered)
    unrendered.hide_render = True
    cube("InHidden", (6, 5, 0), plain, unrendered)
    smooth = cube("Smooth", (0, 8, 0), plain)
    modifier = smooth.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 0, 2
    rows = cube("Rows", (3, 8, 0), plain).modifiers.new("Array", "ARRAY")
    rows.count = 3
    off = cube("Off", (12, 8, 0), plain).modifiers.new("Array", "ARRAY")
    off.show_render = False
    group = bpy.data.collections.new("Group")
    cube("Member", (0, 0, 1), plain, group)
    for name, x in (("First", 0.0), ("Second", 4.0)):
        instancer = link(bpy.data.objects.new(name, None))
        instancer.instance_type, instancer.instance_collection = "COLLECTION", group
        instancer.location, instancer.rotation_euler = (x, 12, 0), Euler((0, 0, 0.5))
    mover = cube("Mover", (0, 16, 0), plain)
    for frame, x in ((1, 0.0), (11, 10.0)):
        mover.location.x = x
        mover.keyframe_insert("location", index=0, frame=frame)
    for curve in versions.action_curves(mover):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    shaped = cube("Shaped", (3, 16, 0), plain)
    shaped.shape_key_add(name="Basis")
    shaped.shape_key_add(name="Up").data[0].co.z -= 2.0
    shaped.data.shape_keys.key_blocks["Up"].value = 0.5
    text = link(bpy.data.objects.new("Words", bpy.data.curves.new("Words", "FONT")))
    text.data.body, text.location = "A", (6, 16, 0)
    more = link(bpy.data.objects.new("MoreWords", text.data))  # the same text, other triangles
    more.location = (12, 16, 0)
    more.modifiers.new("Array", "ARRAY").count = 2
    scatter = cube("Scatter", (0, 20, 0), plain)
    cube("Leaf", (0, 0, 0), plain).parent = scatter
    scatter.instance_type = "VERTS"
    scatter.show_instancer_for_render = False
    link(bpy.data.objects.new("Smoke", bpy.data.volumes.new("Smoke"))).location = (9, 16, 0)
    scene.frame_set(1)
    result = {"1": bounds()}
    scene.frame_set(6)
    result["6"] = bounds()
    scene.frame_set(1)
    return result


def bounds():
    """Names, triangles, and corners of the boxes in Blender's world, as the render has them: evaluated with the
    render's modifiers set by hand, independently of the export."""
    layer = bpy.context.view_layer
    smooth, off = bpy.data.objects["Smooth"].modifiers[0], bpy.data.objects["Off"].modifiers[0]
    smooth.levels, off.show_viewport = 2, False
    bpy.data.objects["ViewportHidden"].hide_viewport = False
    layer.update()
    graph, result = bpy.context.evaluated_depsgraph_get(), {}
    for instance in graph.object_instances:
        name = instance.object.original.name
        if name in {"Hidden", "InHidden", "Strands"} or (name in {"Scatter", "Leaf"} and not instance.is_instance):
            continue
        if instance.object.type not in {"MESH", "FONT"} or (name.endswith("Words") and instance.is_instance):
            continue  # the text's mesh is listed again behind the text
        mesh = instance.object.to_mesh()
        points = [instance.matrix_world @ vertex.co for vertex in mesh.vertices]
        mesh.calc_loop_triangles()
        key = (instance.parent.original.name + "/" if instance.is_instance else "") + name
        entry = result.setdefault(key, {"triangles": 0, "low": [1e9] * 3, "high": [-1e9] * 3})
        entry["triangles"] += len(mesh.loop_triangles)
        for point in points:
            entry["low"] = [min(a, b) for a, b in zip(entry["low"], point)]
            entry["high"] = [max(a, b) for a, b in zip(entry["high"], point)]
        instance.object.to_mesh_clear()
    smooth.levels, off.show_viewport = 0, True
    bpy.data.objects["ViewportHidden"].hide_viewport = True
    layer.update()
    return result


def twisted_grid(location, material):
    """2 m wide, of 256 flat quads, plane at frame 1: a shape key turns each vertex about the y axis by y radians."""
    data, shape = bpy.data.meshes.new("Twisted"), bmesh.new()
    bmesh.ops.create_grid(shape, x_segments=16, y_segments=16, size=1.0)
    shape.to_mesh(data)
    shape.free()
    data.materials.append(material)
    thing = link(bpy.data.objects.new("Twisted", data))
    thing.location = location
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="Twist")
    for vertex in key.data:
        vertex.co = (vertex.co.x * math.cos(vertex.co.y), vertex.co.y, vertex.co.x * math.sin(vertex.co.y))
    for frame, value in ((1, 0.0), (6, 0.5)):
        key.value = value
        key.keyframe_insert("value", frame=frame)


def deformed():
    """Bent by a modifier behind one that adds vertices, and by a shape key; both move from frame 1 to 6."""
    plain = new_material("Grey", "ShaderNodeBsdfDiffuse")[0]
    cube("Plain", (0, 0, 0), plain)
    bent = cube("Bent", (4, 0, 0), plain)
    bent.scale = (1, 1, 2)
    bent.modifiers.new("Array", "ARRAY").count = 3
    bend = bent.modifiers.new("Bend", "SIMPLE_DEFORM")
    bend.deform_method = "BEND"
    for frame, angle in ((1, 0.3), (6, 1.2)):
        bend.angle = angle
        bend.keyframe_insert("angle", frame=frame)
    shaped = cube("Shaped", (0, 4, 0), plain)
    shaped.shape_key_add(name="Basis")
    key = shaped.shape_key_add(name="Up")
    for vertex in key.data:
        vertex.co.z += 2.0 * vertex.co.x
    for frame, value in ((1, 0.0), (6, 0.75)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    shaped.data.attributes.new("other", "FLOAT", "CORNER")
    twisted_grid((0, 0, 6), plain)
    bpy.context.scene.frame_set(1)
    return None
