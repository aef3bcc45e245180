"""What differs between the versions of Blender that the tests run with: part of the scripts that make scenes."""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "blender_scripts"))
from blend_common import action_curves  # noqa: E402,F401
from export_nodes import PRINCIPLED_INPUTS  # noqa: E402
from guide_instances import geometry_nodes  # noqa: E402,F401 the scenes take it from here


SHOWN_CHILDREN = "child_nbr" if bpy.app.version < (4, 0) else "child_percent"  # of a particle system, in the viewport

# The glTF exporter's option for all actions in use as one animation.
ONE_ANIMATION = ({"export_nla_strips": False} if bpy.app.version < (3, 6)
                 else {"export_animation_mode": "ACTIVE_ACTIONS"})


def smooth_by_angle(mesh, angle):
    """Auto Smooth, or from Blender 4.1 on sharp edges in its place."""
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, angle
    else:
        mesh.set_sharp_from_angle(angle=angle)


def input_of(node, name):
    """By its name in Blender 3.4."""
    if node.type == "BSDF_PRINCIPLED" and name not in node.inputs:
        name = PRINCIPLED_INPUTS[name]
    return node.inputs[name]
