"""Which versions of Blender the scripts accept, and what they say of files by a newer one. Python alone stands in for
Blender: python3 tests/blender/version_range_test.py"""

import contextlib
import io
import sys
import tempfile
import types
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "blender_scripts"))
bpy, mathutils = types.ModuleType("bpy"), types.ModuleType("mathutils")
mathutils.Matrix = tuple
sys.modules.update(bpy=bpy, mathutils=mathutils)
import blend_common  # noqa: E402


def run_as(version, file_version=None, libraries=()):
    bpy.app = types.SimpleNamespace(version=version, version_string=".".join(map(str, version)))
    bpy.data = types.SimpleNamespace(
        filepath="shot.blend" if file_version else "", version=file_version,
        libraries=[types.SimpleNamespace(filepath=name, version=theirs) for name, theirs in libraries])


def warnings():
    found = blend_common.Unsupported()
    blend_common.note_version(found)
    blend_common.note_newer_files(found)
    return found.lines


def refusal(call):
    """(exit code, what is said), or None."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            call()
    except SystemExit as end:
        return end.code, said.getvalue()
    return None


class VersionRange(unittest.TestCase):
    def test_those_outside_are_refused(self):
        for version in ((2, 93, 0), (3, 3, 21), (5, 0, 0), (5, 1, 2), (6, 0, 0)):
            run_as(version)
            code, said = refusal(blend_common.check_version)
            self.assertEqual(code, 5)
            for part in (".".join(map(str, version)), "3.4", "5.0", "3.4.1 and 4.3.2"):
                self.assertIn(part, said)

    def test_tested_ones_go_on_in_silence_and_others_with_one_line(self):
        for version, lines in (((3, 4, 1), 0), ((4, 3, 2), 0), ((3, 6, 23), 1), ((4, 2, 0), 1), ((4, 5, 9), 1)):
            run_as(version, version)
            self.assertIsNone(refusal(blend_common.check_version))
            self.assertEqual(len(warnings()), lines, version)
            for line in warnings():
                self.assertIn("3.4.1 and 4.3.2", line)
                self.assertIn(bpy.app.version_string, line)

    def test_files_by_a_newer_one_name_both(self):
        run_as((3, 4, 1), (4, 3, 32), [("//old.blend", (3, 0, 1)), ("//new.blend", (4, 2, 0))])
        file, library = warnings()
        self.assertRegex(file, "the file was saved by Blender 4.3 .* 3.4.1")
        self.assertRegex(library, "library '//new.blend' was saved by Blender 4.2 .* 3.4.1")
        run_as((4, 3, 2), (4, 3, 32), [("//old.blend", (3, 0, 1))])
        self.assertEqual(warnings(), [])

    def test_a_file_that_does_not_open_is_named_by_its_head(self):
        heads = {b"BLENDER-v403RENDH": "4.3", b"BLENDER_v410": "4.10", b"BLENDER17-01v0500": "5.0"}
        for head, version in heads.items():
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "shot.blend"
                path.write_bytes(head)
                run_as((3, 4, 1))
                sys.argv = ["blender", "-b", str(path)]
                code, said = refusal(lambda: blend_common.choose_scene(None))
                self.assertEqual(code, 3)
                self.assertRegex(said, f"saved by Blender {version}, .* 3.4.1")
                path.write_bytes(b"BLENDER-v304" if head != b"BLENDER_v410" else b"no scene")
                self.assertIn("no .blend file", refusal(lambda: blend_common.choose_scene(None))[1])


if __name__ == "__main__":
    unittest.main()
