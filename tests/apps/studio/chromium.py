"""Debian's chromium, headless, by chromium-driver and selenium."""
import os

from selenium import webdriver
from selenium.webdriver.chrome.service import Service


def chromium(size):
    """A browser whose window has this size, "WIDTH,HEIGHT"."""
    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                 f"--window-size={size}"):
        options.add_argument(word)
    if os.geteuid() == 0:
        options.add_argument("--no-sandbox")  # Chromium's sandbox does not run as root
    # Named, so that selenium looks for no other on the network.
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
