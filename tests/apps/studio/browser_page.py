"""A studio and its page in a browser, for browser_test.py, whose arguments this takes."""
import atexit
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from selenium.webdriver import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from chromium import chromium

SCUMBLE, SOURCE, WORK = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
AXE = "axe-core@4.10.2"
SIZE = "320x180"
PATIENCE = 60  # seconds that a loaded machine is waited for


def axe_source():
    """The text of axe-core, which npm fetches once."""
    file = WORK / "node_modules" / "axe-core" / "axe.min.js"
    if not file.is_file():
        WORK.mkdir(parents=True, exist_ok=True)
        subprocess.run(["npm", "install", "--no-save", "--no-audit", "--no-fund", "--prefix", str(WORK), AXE],
                       check=True, stdout=subprocess.DEVNULL, timeout=300)
    return file.read_text()


class Studio:
    """The program, on a copy of a bundled style in a folder of its own."""

    def __init__(self, folder, scene="suzanne", port=None):
        self.folder = folder
        words = [str(SCUMBLE), "studio", str(SOURCE / "scenes" / f"{scene}.glb"), "--style", str(folder / "my"),
                 "--style", "toon", "--size", SIZE, "--no-browser", "--save-to", str(folder)]
        self.process = subprocess.Popen(words + (["--port", str(port)] if port else []), stdout=subprocess.PIPE,
                                        text=True)
        self.address = self.process.stdout.readline().strip()
        self.port = int(self.address.split(":")[2].split("/")[0])

    def stop(self):
        self.process.terminate()
        self.process.stdout.close()
        return self.process.wait(PATIENCE)


def shared_browser():
    browser = chromium("1500,950")
    atexit.register(browser.quit)
    browser.set_page_load_timeout(PATIENCE)
    browser.set_script_timeout(PATIENCE)
    return browser


class Page(unittest.TestCase):
    """Each test has a studio and a tab of its own, in one browser."""
    scene = "suzanne"
    shared = None

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        shutil.copytree(SOURCE / "exemplars" / "oil", self.folder / "my")
        self.studio = Studio(self.folder, self.scene)
        self.browser = Page.shared = Page.shared or shared_browser()
        before = self.browser.window_handles
        self.browser.switch_to.new_window("tab")
        fresh = self.browser.current_window_handle
        for handle in before:
            self.browser.switch_to.window(handle)
            self.browser.close()
        self.browser.switch_to.window(fresh)
        self.browser.get(self.studio.address)
        self.settled()

    def tearDown(self):
        self.studio.stop()
        self.temporary.cleanup()

    def js(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def until(self, condition, what):
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                self.browser.save_screenshot(str(WORK / "failed.png"))
                self.fail(f"{what} did not happen; the page says {self.find('#status').text!r}, "
                          f"{self.find('#problem-text').text!r}")
            time.sleep(0.03)

    def call(self, method, path, body=None):
        """A call from the page's own origin: (status, JSON or text)."""
        status, text = self.browser.execute_async_script(
            "const [method, path, body, done] = arguments;"
            "fetch(path, {method, body, headers: {'X-Scumble': '1', 'Content-Type': 'application/json'}})"
            ".then(async (r) => done([r.status, await r.text()]))", method, path, body and json.dumps(body))
        return status, json.loads(text) if text[:1] in "{[" else text

    def state(self):
        return self.call("GET", "/api/state")[1]

    def settled(self):
        """Waits for the final of the server's newest state on the screen."""
        def is_there():
            # In one look: between two, a draft of the newest state may take the place of the final of the one before.
            drawn, revision = self.js("const {drawn, revision} = document.documentElement.dataset;"
                                      "return [drawn, Number(revision)]")
            return drawn == "final" and revision >= self.state()["revision"]

        self.until(is_there, "the final")

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def pixels(self):
        """A number that changes with the picture on the screen."""
        return self.js("const c = document.getElementById('picture');"
                       "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                       "let h = 0; for (let i = 0; i < d.length; i += 1) h = (h * 31 + d[i]) | 0; return h")

    def choose(self, kind, name):
        self.js("document.querySelector(`[data-${arguments[0]}='${arguments[1]}'] input`).click()", kind, name)
        self.until(lambda: self.state()[kind] == name, f"the choice of {name}")
        self.settled()

    def drag(self, element, dx, dy):
        chain = ActionChains(self.browser, duration=20).move_to_element(element).click_and_hold()
        for _ in range(4):
            chain.move_by_offset(dx // 4, dy // 4)
        chain.release().perform()

    def type_into(self, field, text):
        """Instead of what stands there."""
        self.find(field).send_keys(Keys.CONTROL + "a")
        self.find(field).send_keys(text, Keys.TAB)
