#!/usr/bin/python3
"""A picture of the studio's page, for README: screenshot.py SCUMBLE SCENE STYLE OUTPUT.png [--dark]"""
import subprocess
import sys
import time

from chromium import chromium

scumble, scene, style, output = sys.argv[1:5]
studio = subprocess.Popen([scumble, "studio", scene, "--style", style, "--size", "1920x1080", "--no-browser"],
                          stdout=subprocess.PIPE, text=True)
page = chromium("1600,1040")
try:
    page.get(studio.stdout.readline().strip())
    end = time.monotonic() + 120
    while page.execute_script("return document.documentElement.dataset.drawn") != "final":
        if time.monotonic() > end:
            sys.exit("screenshot.py: the page has drawn no picture in 120 s")
        time.sleep(0.1)
    if "--dark" in sys.argv[5:]:
        page.execute_script("document.documentElement.dataset.theme = 'dark'")
    time.sleep(4)  # thumbnails come after the picture
    page.save_screenshot(output)
finally:
    page.quit()
    studio.terminate()
    studio.wait()
