#!/usr/bin/python3
"""How quick the studio is in a real browser: from the save of a painting to the picture on the screen, and drafts a
second while the scene is orbited.

Usage: studio.py --scumble build/scumble [--runs 15] [--size 1920x1080]

Prints one line each: median, least and most. The save is a rename, as painting programs do it; its time runs to the
moment at which the page has drawn the final picture.
"""
import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(SOURCE / "tests" / "apps" / "studio"))
from chromium import chromium  # noqa: E402

# Notes when the page has drawn what: the moment, the quality, and a number that changes with the paint in the middle.
WATCH = """
window.drawn = [];
window.paint = () => {
  const canvas = document.getElementById('picture');
  const bytes = canvas.getContext('2d').getImageData(canvas.width / 2, canvas.height / 2, 8, 8).data;
  return bytes.reduce((sum, byte) => (sum * 31 + byte) | 0, 0);
};
new MutationObserver(() => window.drawn.push([Date.now(), document.documentElement.dataset.drawn, window.paint()]))
    .observe(document.documentElement, {attributeFilter: ['data-revision']});
"""
IS_NEW = "(one) => one[1] === 'final' && one[2] !== window.before"

# Moves the pointer over the picture at 60 steps a second, held down.
ORBIT = """
const done = arguments[arguments.length - 1], seconds = arguments[0];
const stage = document.getElementById('stage'), box = stage.getBoundingClientRect();
const at = (i) => ({bubbles: true, pointerId: 1, isPrimary: true, button: 0, buttons: 1,
                    clientX: box.left + box.width / 2 + i, clientY: box.top + box.height / 2});
window.drawn = [];
stage.dispatchEvent(new PointerEvent('pointerdown', at(0)));
let i = 0;
const timer = setInterval(() => stage.dispatchEvent(new PointerEvent('pointermove', at(++i))), 16);
setTimeout(() => {
  clearInterval(timer);
  stage.dispatchEvent(new PointerEvent('pointerup', at(i)));
  done(window.drawn.filter((one) => one[1] === 'draft').length / seconds);
}, seconds * 1000);
"""


def until(condition, seconds=30):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise SystemExit("studio.py: the page has not drawn a picture in 30 s")
        time.sleep(0.02)


def measure(page, folder, style, runs):
    """Milliseconds from save to screen."""
    paintings = [SOURCE / "exemplars" / name / "lit.png" for name in ("gouache", style)]  # the first is another one
    times = []
    for run in range(runs + 1):
        time.sleep(1.0)
        shutil.copy(paintings[run % 2], folder / "new.png")
        page.execute_script("window.drawn = []; window.before = window.paint()")
        begun = time.time()
        os.replace(folder / "new.png", folder / "lit.png")
        until(lambda: page.execute_script(f"return window.drawn.some({IS_NEW})"))
        shown = page.execute_script(f"return window.drawn.find({IS_NEW})[0]")
        times.append(shown - begun * 1000.0)
    return times[1:]  # the first one warms up


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scumble", default=SOURCE / "build" / "scumble")
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--styles", nargs="+", default=["oil", "charcoal"])
    given = parser.parse_args()
    for style in given.styles:
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary) / "painted"
            shutil.copytree(SOURCE / "exemplars" / style, folder)
            studio = subprocess.Popen([str(given.scumble), "studio", str(SOURCE / "scenes" / "suzanne.glb"), "--style",
                                       str(folder), "--size", given.size, "--no-browser"],
                                      stdout=subprocess.PIPE, text=True)
            page = chromium("1600,1000")
            try:
                page.set_script_timeout(60)
                page.get(studio.stdout.readline().strip())
                until(lambda: page.execute_script("return document.documentElement.dataset.drawn") == "final")
                page.execute_script(WATCH)
                times = measure(page, folder, style, given.runs)
                print(f"{style}: save to picture, ms: median {statistics.median(times):.0f}, least {min(times):.0f}, "
                      f"most {max(times):.0f}")
                rates = [page.execute_async_script(ORBIT, 3.0) for _ in range(4)][1:]
                print(f"{style}: drafts a second: median {statistics.median(rates):.1f}, least {min(rates):.1f}, most "
                      f"{max(rates):.1f}")
            finally:
                page.quit()
                studio.terminate()
                studio.wait()


if __name__ == "__main__":
    main()
