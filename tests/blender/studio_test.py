#!/usr/bin/python3
"""A .blend in the studio: its first picture, a frame, an orbit and the copied command are the bytes of `scumble
stylize`; a save by Blender is seen.

    studio_test.py PROGRAM SOURCE [BLENDER]
"""

import subprocess
import sys
import tempfile
import threading
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "apps" / "studio"))
from studio_client import Studio  # noqa: E402

# A cube that moves from frame 1 to 20, before a camera.
MAKE = """
import bpy, sys
path, shift = sys.argv[-2], float(sys.argv[-1])
cube = bpy.data.objects["Cube"]
cube.location.z = shift
for frame, x in ((1, 0.0), (20, 2.0)):
    cube.location.x = x
    cube.keyframe_insert("location", index=0, frame=frame)
bpy.context.scene.frame_end = 20
bpy.ops.wm.save_as_mainfile(filepath=path)
"""
PATIENCE = 120


def expect(holds, *what):
    if not holds:
        sys.exit("studio_test.py: " + "\n".join(str(part) for part in what))


def save(blender, folder, shift):
    script = folder / "make.py"
    script.write_text(MAKE)
    done = subprocess.run([blender, "-b", "-noaudio", "--factory-startup", "-P", script, "--", folder / "cube.blend",
                           str(shift)], capture_output=True, text=True)
    expect(done.returncode == 0 and (folder / "cube.blend").is_file(), done.stdout, done.stderr)


def picture(studio):
    status, _, body = studio.call("POST", "/api/export", {"what": "picture", "format": "png"})
    expect(status == 200, status, body[:500])
    return body


def by_command(program, studio, folder):
    """The bytes of the command that the page would copy."""
    command = studio.json("POST", "/api/export", {"what": "command"})["command"]
    expect(command.startswith("scumble stylize "), command)
    command = f"'{program}' stylize -q " + command.removeprefix("scumble stylize ")
    done = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True)
    expect(done.returncode == 0, command, done.stderr)
    return (folder / "picture.png").read_bytes()


def main():
    program, source = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    blender = sys.argv[3] if len(sys.argv) > 3 else "blender"
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        save(blender, folder, 0.0)
        changed = threading.Event()
        studio = Studio(program, folder / "cube.blend", "--style", source / "exemplars" / "oil", "--size", "160x90",
                        "--blender", blender)
        studio.listen(lambda name, data: changed.set() if name == "state" and data["why"] == "files" else None)
        status, _, body = studio.call("GET", "/api/frame", quality="final", format="png")
        expect(status == 200, status, body[:500])
        state = studio.json("GET", "/api/state")
        expect(state["objects"] == ["Cube"] and state["cameras"] == ["Camera"], state)
        expect(state["animation"] == {"first": 1, "last": 20, "fps": 24.0, "saved": 1}, state["animation"])
        seen = {"at first": picture(studio)}
        expect(by_command(program, studio, folder) == seen["at first"], "the first picture is not the command's")
        studio.json("PATCH", "/api/state", {"frame": 20})
        seen["frame 20"] = picture(studio)
        expect(by_command(program, studio, folder) == seen["frame 20"], "frame 20 is not the command's")
        studio.json("PATCH", "/api/state", {"view": {"azimuth": 40, "elevation": 20}})
        expect(studio.call("GET", "/api/frame", quality="draft")[0] == 200, "a draft of an orbit")
        seen["orbit"] = picture(studio)
        expect(by_command(program, studio, folder) == seen["orbit"], "an orbit is not the command's")
        studio.json("PATCH", "/api/state", {"view": None, "frame": None})
        expect(picture(studio) == seen["at first"], "the way back")
        save(blender, folder, 1.0)
        expect(changed.wait(PATIENCE), "a save by Blender was not seen")
        seen["saved"] = picture(studio)
        expect(by_command(program, studio, folder) == seen["saved"], "the saved scene is not the command's")
        expect(len(set(seen.values())) == len(seen), "pictures are equal", {k: hash(v) for k, v in seen.items()})
        expect(studio.end() == 0, "the studio's exit code")
    print(f"{len(seen)} pictures of a .blend are those of the command line")


main()
