"""Hair as Cycles draws it, as curves beside the triangles of its object: part of export_scene.py.

A curves primitive has mode 0 (points), so that other readers show something, and extras.scumble.curves. POSITION are
control points, the first and the last of each curve twice; `_SCUMBLE_RADIUS` their radii; TEXCOORD_0, the place of the
curve's root in its emitter's textures; the indices give the first of the four control points of each Catmull-Rom
segment.
"""

from dataclasses import dataclass

import bpy
import numpy as np

FLOAT, UNSIGNED = 5126, 5125


@dataclass
class Hair:
    """Curves of one material in the object's space, Blender's axes."""
    points: np.ndarray
    radii: np.ndarray
    lengths: np.ndarray  # in points, of each curve
    material: object
    uvs: np.ndarray = None  # of each curve's root, Blender's axes
    exported: str = ""  # the material's name for the exporter


def particle_hair(thing):
    """The evaluated object's particle systems that are drawn as hair."""
    found = []
    for modifier in thing.modifiers:
        if modifier.type != "PARTICLE_SYSTEM" or not modifier.show_render:
            continue
        system = modifier.particle_system
        settings = system.settings
        if settings.type == "HAIR" and settings.render_type == "PATH":
            found.append(strands_of(thing, modifier, settings))
    return [hair for hair in found if hair is not None]


def strands_of(thing, modifier, settings):
    system = modifier.particle_system
    parents, children = len(system.particles), len(system.child_particles)
    first = parents if settings.child_type != "NONE" and children > 0 else 0
    steps = (1 << settings.render_step) + 1
    if settings.kink == "SPIRAL":
        steps += settings.kink_extra_steps
    count = parents + children - first
    if count == 0:
        return None
    world = np.empty((count * steps, 3))
    row = 0
    for number in range(first, parents + children):
        for step in range(steps):
            world[row] = system.co_hair(object=thing, particle_no=number, step=step)
            row += 1
    to_object = np.array(thing.matrix_world.inverted_safe())
    points = (world @ to_object[:3, :3].T + to_object[:3, 3]).reshape(count, steps, 3)
    along = np.cumsum(np.linalg.norm(np.diff(points, axis=1), axis=2), axis=1)
    lengths = along[:, -1]
    keep = lengths > 0
    if not keep.any():
        return None
    share = np.concatenate([np.zeros((count, 1)), along], axis=1)[keep] / lengths[keep, None]
    radii = radius_at(settings, np.clip(share, 0, 1))
    slots = [slot.material for slot in thing.material_slots]
    material = slots[min(settings.material, len(slots)) - 1] if slots else None
    uvs = root_uvs(thing, modifier, range(first, parents + children))
    return Hair(points[keep].reshape(-1, 3), radii.ravel(), np.full(keep.sum(), steps),
                material.original if material else None, None if uvs is None else uvs[keep])


def root_uvs(thing, modifier, numbers):
    """Where the hairs grow, in the emitter's active UV map; None where it has none."""
    if not thing.data.uv_layers:
        return None
    layer = max(thing.data.uv_layers.active_index, 0)
    particles = modifier.particle_system.particles
    return np.array([modifier.particle_system.uv_on_emitter(
        modifier, particle=particles[min(number, len(particles) - 1)], particle_no=number, uv_no=layer)
        for number in numbers])


def radius_at(settings, share):
    root, tip = (0.5 * settings.radius_scale * r for r in (settings.root_radius, settings.tip_radius))
    left = 1.0 - share
    if settings.shape < 0:
        left = left ** (1.0 + settings.shape)
    elif settings.shape > 0:
        left = left ** (1.0 / max(1.0 - settings.shape, 1e-6))
    radii = left * (root - tip) + tip
    if settings.use_close_tip:
        radii[:, -1] = 0.0
    return radii


def curves_hair(thing):
    """The hair of an object of the type CURVES."""
    data = thing.data
    points = np.empty(3 * len(data.points), np.float32)
    data.points.foreach_get("position", points)
    radii = np.full(len(data.points), 0.005, np.float32)
    if "radius" in data.attributes:
        data.attributes["radius"].data.foreach_get("value", radii)
    lengths = np.array([curve.points_length for curve in data.curves], np.int64)
    slots = [slot.material for slot in thing.material_slots]
    drawn = lengths >= 2  # a single point has no length
    if not drawn.any():
        return []
    kept = np.repeat(drawn, lengths)
    return [Hair(points.reshape(-1, 3)[kept], radii[kept], lengths[drawn],
                 slots[0].original if slots and slots[0] else None)]


def curve_settings(scene):
    """Cycles gives Embree one piece more than a power of two."""
    curves = scene.cycles_curves
    return {"ribbons": curves.shape == "RIBBONS", "pieces": min(max(1 << curves.subdivisions, 1), 16) + 1}


# ---- The file -------------------------------------------------------------------------------------------------------


def with_ends_twice(hair):
    """(points, radii, segments): each curve's first and last point repeated."""
    ends = np.cumsum(hair.lengths)
    starts = ends - hair.lengths
    order = np.concatenate([np.concatenate([[start], np.arange(start, end), [end - 1]])
                            for start, end in zip(starts, ends)])
    first = starts + 2 * np.arange(len(starts))
    segments = np.concatenate([np.arange(f, f + n - 1) for f, n in zip(first, hair.lengths)])
    return hair.points[order], hair.radii[order], segments


def stand_for_hair(mesh):
    """Fills an empty mesh, which the exporter would leave out; the triangle goes in the end."""
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh["scumble_hair_alone"] = True


def stands_for_hair(mesh):
    return "scumble_hair_alone" in mesh


def append(document, binary, values, component, kind):
    """Adds an accessor; returns its number."""
    binary.extend(b"\0" * (-len(binary) % 4))
    data = values.tobytes()
    document.setdefault("bufferViews", []).append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
    binary.extend(data)
    accessor = {"bufferView": len(document["bufferViews"]) - 1, "componentType": component, "count": len(values),
                "type": kind}
    if kind == "VEC3":
        accessor["min"], accessor["max"] = values.min(0).tolist(), values.max(0).tolist()
    document.setdefault("accessors", []).append(accessor)
    return len(document["accessors"]) - 1


def primitive_of(document, binary, hair, material, settings):
    points, radii, segments = with_ends_twice(hair)
    turned = np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1).astype(np.float32)
    primitive = {"mode": 0, "attributes": {"POSITION": append(document, binary, turned, FLOAT, "VEC3"),
                                           "_SCUMBLE_RADIUS": append(document, binary, radii.astype(np.float32), FLOAT,
                                                                     "SCALAR")},
                 "indices": append(document, binary, segments.astype(np.uint32), UNSIGNED, "SCALAR"),
                 "extras": {"scumble": {"curves": settings}}}
    if hair.uvs is not None:
        uvs = np.repeat(np.stack([hair.uvs[:, 0], 1.0 - hair.uvs[:, 1]], axis=1), hair.lengths + 2, axis=0)
        primitive["attributes"]["TEXCOORD_0"] = append(document, binary, uvs.astype(np.float32), FLOAT, "VEC2")
    if material is not None:
        primitive["material"] = material
    return primitive


def stand_in(material, number):
    """An object of one triangle that makes the exporter write a material."""
    mesh = bpy.data.meshes.new(f"scumble.hair.{number:06d}")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.materials.append(material)
    return bpy.data.objects.new(mesh.name, mesh)
