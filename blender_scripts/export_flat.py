"""The scene as a render sees it, as a flat list of meshes in the world: part of export_scene.py."""

from dataclasses import dataclass, field

import bpy

import export_hair
import export_maps
import export_normals
import export_rest
import export_styles
import export_viewport
from blend_common import camera_names, cameras_of, can_be_looked_through, has_direction, note_crooked_camera, why_lost

MESH_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
SHAPE_TYPES = MESH_TYPES | {"CURVES"}
SHOWN_BY_MESHES = {"CURVE", "SURFACE", "FONT"}  # renders show the meshes that Blender makes of them, as instances
LAST_LEVEL = 0x7FFFFFFF  # fills up the numbers of an instance that is nested less deeply
SILENT_TYPES = {"EMPTY", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}
RAYS = {"visible_diffuse": "diffuse", "visible_glossy": "glossy",
        "visible_shadow": "shadow"}


@dataclass
class Placed:
    """Something at a place: `matrix` is Blender's world matrix, `source` the original object, `shown` the object in the
    scene that shows it: the source itself, or the instancer."""
    name: str
    source: object
    matrix: object
    shown: object
    mesh: object = None
    slots: tuple = ()  # original materials, None where there is none
    exported: str = ""  # the name that the exporter sees
    hair: list = field(default_factory=list)  # export_hair.Hair
    is_own_shape: bool = False  # the mesh is the source's, and no geometry nodes made it up for an instance


@dataclass
class FlatScene:
    meshes: list = field(default_factory=list)
    lamps: list = field(default_factory=list)
    cameras: list = field(default_factory=list)  # the active one first
    lost_camera: str = ""  # why the active one is not among them
    materials: dict = field(default_factory=dict)  # by material_key
    shown_maps: dict = field(default_factory=dict)  # by material_key: its meshes' UV maps that renders take
    normals: dict = field(default_factory=dict)  # of metaballs' vertices, by the object's full name
    uv_readers: set = field(default_factory=set)  # export_maps.instancer_readers
    corners: dict = field(default_factory=dict)  # how many each mesh had before its faces were cut, by its name


def material_key(material):
    return material.name_full if material else ""


def is_made_of_itself(instance):
    """Whether it is the mesh that Blender makes of a curve in the scene. What its nodes instance is nested deeper."""
    thing = instance.object.original
    if not instance.is_instance or thing.type not in SHOWN_BY_MESHES or instance.parent.original != thing:
        return False
    return instance.persistent_id[1] == LAST_LEVEL


def particle_number(instance):
    """"", "#2", "#3", … by the particle's own number, which it keeps when others die or are born; "#2.3": the third one
    of its object's second system, and further numbers before these where the emitter is an instance."""
    levels = [number + 1 for number in instance.persistent_id if number != LAST_LEVEL][::-1]
    while len(levels) > 1 and levels[0] == 1:
        del levels[0]
    return "" if levels == [1] else "#" + ".".join(str(number) for number in levels)


def name_of(instance, taken):
    """The object's name; of an instance "Instancer/Object", and a number. Repeated ones count on in Blender's own
    order."""
    name = instance.object.original.name
    if instance.is_instance and instance.parent and not is_made_of_itself(instance):
        name = instance.parent.original.name + "/" + name
        if instance.particle_system:
            name += particle_number(instance)
    taken[name] = taken.get(name, 0) + 1
    return name if taken[name] == 1 else f"{name}#{taken[name]}"


def is_only_template(instance):
    """Whether a render leaves the object itself out: what is set on the vertices or faces of its parent."""
    parent = instance.object.original.parent
    if parent is None or parent.instance_type not in {"VERTS", "FACES"}:
        return False
    return not instance.is_instance or is_made_of_itself(instance)


def every_instance(depsgraph):
    """The rendered objects that may be exported, with their names: pairs of an instance and a string. An instance is
    Blender's own and only lives until the next one."""
    taken = {}
    for instance in depsgraph.object_instances:
        thing = instance.object
        shown = instance.is_instance or instance.show_self or (instance.show_particles and thing.particle_systems)
        if not shown or thing.type in SILENT_TYPES or is_only_template(instance):
            continue
        if thing.type in SHOWN_BY_MESHES or (thing.type == "MESH" and thing.original.type == "META"):
            continue
        yield instance, name_of(instance, taken)


def is_generated(instance, depsgraph):
    """Whether geometry nodes made up the mesh of an instance: it is then shown as the object that made it."""
    thing = instance.object
    if not instance.is_instance or thing.type != "MESH":
        return False
    return thing.data.as_pointer() != thing.original.evaluated_get(depsgraph).data.as_pointer()


def mesh_key(instance, depsgraph, readers):
    """Equal for those that show the same triangles in the same materials. `readers`: export_maps.instancer_readers."""
    thing = instance.object
    slots = tuple(material_key(slot.material) for slot in thing.material_slots)
    if export_maps.reads_instancer(instance, readers):
        slots += tuple(instance.uv)
    original = thing.original
    if thing.type != "MESH":
        return ("made", original.name_full, slots)  # each object has triangles of its own, whoever shares the curve
    plain = original.type == "MESH" and original.data is not None and not original.modifiers
    if plain and not original.data.shape_keys and not is_generated(instance, depsgraph):
        return ("plain", original.data.name_full, slots)
    return ("evaluated", thing.data.as_pointer(), slots)


def new_mesh(instance, depsgraph):
    """The evaluated mesh as one of the file's."""
    thing = instance.object
    if not is_generated(instance, depsgraph):
        return bpy.data.meshes.new_from_object(thing, preserve_all_data_layers=True, depsgraph=depsgraph)
    mesh = thing.data.copy()  # new_from_object would give the mesh of the object that made it
    for number, material in enumerate(mesh.materials):
        mesh.materials[number] = material.original if material else None
    return mesh


def new_shape(instance, depsgraph):
    """(mesh, hair): the mesh is empty where only the hair is shown, or there is no mesh. A view layer's filter may
    leave out all surfaces, or all curves."""
    thing, layer = instance.object, depsgraph.view_layer
    if thing.type == "CURVES":
        return bpy.data.meshes.new("scumble"), export_hair.curves_hair(thing) if layer.use_strand else []
    shown = layer.use_solid and (instance.is_instance or instance.show_self)
    mesh = new_mesh(instance, depsgraph) if shown else bpy.data.meshes.new("scumble")
    drawn = (layer.use_strand and not is_generated(instance, depsgraph)
             and (instance.is_instance or instance.show_particles))
    return mesh, export_hair.particle_hair(thing) if drawn and thing.type == "MESH" else []


def seen_by_camera(thing, shown, view_layer):
    """`shown` is the object in the scene: the thing itself, or its instancer."""
    return thing.visible_camera and shown.visible_camera and not shown.indirect_only_get(view_layer=view_layer)


def note_limits(thing, shown, view_layer, unsupported):
    for owner in (thing, shown):  # an instance has its instancer's limits, too
        rays = [name for key, name in RAYS.items() if not getattr(owner, key, True)]
        if rays:
            unsupported.add(f"object '{owner.name}': is invisible to {', '.join(rays)} rays, which is ignored")
    if thing.is_holdout or shown.holdout_get(view_layer=view_layer):
        owner = thing if thing.is_holdout else shown
        unsupported.add(f"object '{owner.name}': is a holdout, which is ignored")
    levels = export_viewport.diced_levels(thing.original, view_layer.id_data)
    if levels is not None:
        more = f"{levels} levels more than its modifier's" if levels > 0 else "its modifier's own levels"
        unsupported.add(f"object '{thing.name}': its adaptive subdivision is taken for {more}")
    catcher = next((owner for owner in (thing, shown) if export_styles.is_catcher(owner)), None)
    if catcher is not None and export_styles.style_of(thing, shown) in ("catcher", export_styles.TICKED):
        unsupported.add(f"object '{catcher.name}': is a shadow catcher: pictures leave it out, and with --set "
                        "transfer.shadow=paint they have the shadows on it")


def note_seen_lamp(thing, unsupported):
    """A lamp with a size, which a render shows itself."""
    lamp = thing.data
    is_dark = lamp.energy == 0.0 or getattr(getattr(lamp, "cycles", None), "is_portal", False)
    size = lamp.size if lamp.type == "AREA" else lamp.shadow_soft_size
    if thing.visible_camera and lamp.type != "SUN" and size > 0.0 and not is_dark:
        unsupported.add(f"lamp '{thing.name}': is visible to the camera, which is ignored: take a surface that emits")


def flatten(scene, view_layer, unsupported):
    export_viewport.show_as_rendered(scene, view_layer)
    depsgraph = view_layer.depsgraph
    depsgraph.update()
    flat, meshes = FlatScene(normals=export_normals.of_metaballs(depsgraph)), {}
    flat.uv_readers = export_maps.instancer_readers(depsgraph, unsupported)
    for instance, name in every_instance(depsgraph):
        place_object(flat, meshes, instance, name, depsgraph, unsupported)
    order_cameras(flat, scene, unsupported)
    export_styles.note_nested(depsgraph, unsupported)
    if abs(scene.render.pixel_aspect_x - scene.render.pixel_aspect_y) > 1e-6:
        unsupported.add("the render's pixels are not square, which is ignored")
    return flat


def order_cameras(flat, scene, unsupported):
    """The scene's cameras, hidden ones too, and instances; blend_common has their order."""
    usable = cameras_of(scene, unsupported)
    placed = {camera.shown for camera in flat.cameras}
    flat.cameras += [Placed(thing.name, thing, thing.matrix_world.copy(), thing) for thing in usable
                     if thing not in placed]
    flat.cameras = [camera for camera in flat.cameras if can_be_looked_through(camera.source)]
    names = camera_names([camera.source for camera in flat.cameras if camera.shown == camera.source])
    for camera in flat.cameras:
        if camera.shown == camera.source:
            camera.name = names[camera.source]
    flat.cameras = [camera for camera in flat.cameras if has_direction(camera.name, camera.matrix, unsupported)]
    if scene.camera is not None and all(camera.shown != scene.camera for camera in flat.cameras):
        flat.lost_camera = f"'{scene.camera.name}' {why_lost(scene.camera)}"
    flat.cameras.sort(key=lambda camera: (camera.shown != scene.camera, camera.name))
    for camera in flat.cameras:
        note_crooked_camera(camera.name, camera.matrix, unsupported)


def place_object(flat, meshes, instance, name, depsgraph, unsupported):
    thing = instance.object
    if thing.type not in SHAPE_TYPES | {"CAMERA", "LIGHT"}:
        unsupported.add(f"object '{thing.original.name}': is of type {thing.type}, left out")
        return
    shown = instance.parent.original if instance.is_instance else thing.original
    placed = Placed(name, thing.original, instance.matrix_world.copy(), shown)
    if thing.type == "LIGHT":
        note_seen_lamp(thing.original, unsupported)
        flat.lamps.append(placed)
    elif thing.type == "CAMERA":
        flat.cameras.append(placed)
    else:
        if not seen_by_camera(thing.original, shown, depsgraph.view_layer):
            owner = shown if thing.original.visible_camera else thing.original
            unsupported.add(f"object '{owner.name}': is not seen by the camera, so it is left out, with its "
                            "shadows and the light from it")
            return
        note_limits(thing.original, shown, depsgraph.view_layer, unsupported)
        place_mesh(flat, meshes, placed, instance, depsgraph, unsupported)


def changes_shape(thing):
    """Whether another frame may have the same faces in another shape."""
    nodes = any(modifier.type == "NODES" and modifier.show_viewport for modifier in thing.modifiers)
    return nodes or export_rest.is_deformed(thing)


def add_mesh(flat, number, instance, depsgraph, unsupported):
    """The export's own copy of a mesh, and its hair; None where there is neither."""
    original = instance.object.original
    mesh, hair = new_shape(instance, depsgraph)
    if export_maps.reads_instancer(instance, flat.uv_readers):
        export_maps.add_instancer_map(mesh, instance.uv)
    corners = len(mesh.loops)
    if not export_normals.match_cycles(mesh, flat.normals.get(original.name_full), changes_shape(original)):
        unsupported.add(f"object '{original.name}': its normals are made from its faces, because its mesh has other "
                        "vertices than the one that renders show")
    if not mesh.polygons and hair:
        export_hair.stand_for_hair(mesh)
    if not mesh.polygons:
        return None
    mesh.name = f"scumble.{number:06d}"
    flat.corners[mesh.name] = corners
    return mesh, hair


def add_material(flat, material, mesh):
    flat.materials.setdefault(material_key(material), material)
    shown = flat.shown_maps.setdefault(material_key(material), set())
    if export_maps.shown_map(mesh):  # what has no map shows none
        shown.add(export_maps.shown_map(mesh))


def place_mesh(flat, meshes, placed, instance, depsgraph, unsupported):
    thing = instance.object
    key = mesh_key(instance, depsgraph, flat.uv_readers)
    if key not in meshes:
        meshes[key] = add_mesh(flat, len(meshes) + 1, instance, depsgraph, unsupported)
    if meshes[key] is None:
        return
    placed.mesh, placed.hair = meshes[key]
    for hair in placed.hair:
        add_material(flat, hair.material, placed.mesh)
    placed.is_own_shape = thing.type == "MESH" and not is_generated(instance, depsgraph)
    materials = [slot.material.original if slot.material else None for slot in thing.material_slots]
    placed.slots = tuple(materials or [None])
    for material in placed.slots:
        add_material(flat, material, placed.mesh)
    flat.meshes.append(placed)


def fill_export_scene(flat, materials, unsupported):
    """A new scene that holds one object for each mesh at a place, at the origin: places are written afterwards, because
    the exporter would drop the shear of a matrix. `materials` are export_materials.py's, by key."""
    scene = bpy.data.scenes.new("scumble")
    clear_other_slots({placed.mesh.as_pointer() for placed in flat.meshes})
    done, strands = set(), 0
    for number, placed in enumerate(flat.meshes):
        mesh = placed.mesh
        if mesh.name not in done:
            done.add(mesh.name)
            def complain(what, name=placed.name):
                unsupported.add(f"object '{name}': {what}")
            keys = [material_key(slot) for slot in placed.slots]
            fill_slots(mesh, export_maps.materials_for(mesh, keys, materials, complain))
            for hair in placed.hair:
                strands += 1
                stand_in = export_hair.stand_in(materials[material_key(hair.material)]["material"], strands)
                scene.collection.objects.link(stand_in)
                hair.exported = stand_in.name
        copy = bpy.data.objects.new(f"scumble.{number:06d}", mesh)
        scene.collection.objects.link(copy)
        placed.exported = copy.name
    bpy.context.window.scene = scene


def clear_other_slots(ours):
    """The exporter looks for UV maps in every mesh of the file, and fails at empty slots."""
    for mesh in bpy.data.meshes:
        if mesh.as_pointer() not in ours:
            mesh.materials.clear()


def fill_slots(mesh, materials):
    indices = [min(polygon.material_index, len(materials) - 1) for polygon in mesh.polygons]
    mesh.materials.clear()
    for material in materials:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", indices)
