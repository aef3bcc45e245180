"""Has Blender's compositor read a guide file, without help: what its nodes offer, and the mattes and passes they give.

    blender -b -noaudio --factory-startup -P tests/blender/read_guides.py -- --input guides.exr --output FOLDER
                                                                         --matte CryptoObject:NAME …

Writes FOLDER/read.json (the outputs of an Image node, of another one with its Layer lpe, and the layers of a
Cryptomatte node) and FOLDER/read0001.exr, with a layer matte0, matte1, … for each matte and one for each output of the
Image nodes, by its number: pass0, pass1, ….
"""

import argparse
import json
import sys
import traceback
from pathlib import Path

import bpy


def matte_node(tree, image, layer, name):
    node = tree.nodes.new("CompositorNodeCryptomatteV2")
    node.source, node.image, node.layer_name = "IMAGE", image, layer
    node.matte_id = name
    return node


def main():
    parser = argparse.ArgumentParser(prog="read_guides.py", description="Reads guides in Blender's compositor.")
    parser.add_argument("--input", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--matte", required=True, nargs="+")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    image = bpy.data.images.load(arguments.input)
    scene.camera = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x, scene.render.resolution_y = image.size
    scene.render.resolution_percentage = 100
    scene.render.filepath = str(arguments.output / "composite.png")
    scene.view_settings.view_transform = "Raw"
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    plain, light = (tree.nodes.new("CompositorNodeImage") for _ in range(2))
    plain.image = light.image = image
    light.layer = "lpe"
    shown = [(output.name, output) for output in plain.outputs]
    shown += [("lpe." + output.name, output) for output in light.outputs]
    target = tree.nodes.new("CompositorNodeOutputFile")
    target.format.file_format, target.format.color_depth = "OPEN_EXR_MULTILAYER", "32"
    target.base_path = str(arguments.output / "read")
    target.layer_slots.clear()
    mattes = [matte_node(tree, image, *text.split(":", 1)) for text in arguments.matte]
    for number, node in enumerate(mattes):
        target.layer_slots.new(f"matte{number}")
        tree.links.new(node.outputs["Matte"], target.inputs[-1])
    for number, (_, output) in enumerate(shown):
        target.layer_slots.new(f"pass{number}")
        tree.links.new(output, target.inputs[-1])
    tree.links.new(mattes[0].outputs["Matte"], tree.nodes.new("CompositorNodeComposite").inputs["Image"])
    bpy.ops.render.render(write_still=True)
    found = {"passes": [name for name, _ in shown],
             "kinds": [output.type for _, output in shown],
             "mattes": [item.identifier for item in mattes[0].bl_rna.properties["layer_name"].enum_items],
             "multilayer": image.type}
    (arguments.output / "read.json").write_text(json.dumps(found))


if __name__ == "__main__":
    try:
        main()
    except Exception:
        traceback.print_exc()
        sys.exit(1)
