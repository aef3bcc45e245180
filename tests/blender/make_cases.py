"""Makes the .blend files of export_test.cpp, and expected.json with Blender's own numbers.

    blender -b -noaudio --factory-startup -P tests/blender/make_cases.py -- --output FOLDER
"""

import argparse
import json
import sys
import traceback
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))  # Blender does not put a script's own folder on the path
from export_cases.broken import broken, old  # noqa: E402
from export_cases.lights import lamps  # noqa: E402
from export_cases.materials import materials  # noqa: E402
from export_cases.objects import deformed, objects  # noqa: E402
from export_cases.parts import clear, save  # noqa: E402
from export_cases.views import bordered, cameras, layers, panorama, rendered  # noqa: E402

CASES = {"lamps": lamps, "materials": materials, "objects": objects, "deformed": deformed, "cameras": cameras,
         "rendered": rendered, "bordered": bordered, "layers": layers, "panorama": panorama}
FILES = {"broken": broken, "old": old}  # these write their files themselves


def main():
    parser = argparse.ArgumentParser(prog="make_cases.py", description="Makes the scenes of export_test.cpp.")
    parser.add_argument("--output", required=True, type=Path)
    folder = parser.parse_args(sys.argv[sys.argv.index("--") + 1:]).output
    expected = {}
    for name, build in CASES.items():
        clear()
        expected[name] = build()
        save(folder, name)
    for name, build in FILES.items():
        expected[name] = build(folder)
    (folder / "expected.json").write_text(json.dumps(expected))


if __name__ == "__main__":
    try:
        main()
    except Exception:
        traceback.print_exc()
        sys.exit(1)
