#!/usr/bin/python3
"""A picture of the studio's page, for README: screenshot.py SCUMBLE SCENE STYLE OUTPUT.png [--dark]"""
import os
import subprocess
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

scumble, scene, style, output = sys.argv[1:5]
options = webdriver.ChromeOptions()
for word in ("--headless=new", "--disable-dev-shm-usage", "--window-size=1600,1040", "--hide-scrollbars"):
    options.add_argument(word)
if os.geteuid() == 0:
    options.add_argument("--no-sandbox")
studio = subprocess.Popen([scumble, "studio", scene, "--style", style, "--size", "1920x1080", "--no-browser"],
                          stdout=subprocess.PIPE, text=True)
page = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
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
