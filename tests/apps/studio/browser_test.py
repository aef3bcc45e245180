#!/usr/bin/python3
"""The studio in a real browser: Debian's chromium, headless, through chromium-driver and selenium.

Usage: browser_test.py SCUMBLE SOURCE_FOLDER WORK_FOLDER [unittest's arguments]

WORK_FOLDER takes axe-core, which npm installs there.
"""
import os
import shutil
import subprocess
import sys
import time
import unittest

from PIL import Image, ImageCms
from selenium.webdriver import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

from browser_changing import Changing  # noqa: F401 (unittest finds it here)
from browser_page import Page, SCUMBLE, SOURCE, Studio, WORK, axe_source


class Pictures(Page):
    def test_the_first_picture_is_the_command_lines(self):
        size = self.js("const c = document.getElementById('picture'); return [c.width, c.height]")
        self.assertEqual(size, [320, 180])
        command = self.call("POST", "/api/export", {"what": "command"})[1]["command"]
        file = self.folder / "cli.png"
        command = command.replace("scumble stylize", f"{SCUMBLE} stylize --quiet", 1).replace("picture.png", str(file))
        subprocess.run(command, shell=True, check=True)
        told = self.browser.execute_async_script(
            "const done = arguments[0]; fetch('/api/export', {method: 'POST', headers: {'X-Scumble': '1', "
            "'Content-Type': 'application/json'}, body: JSON.stringify({what: 'picture', format: 'png'})})"
            ".then(async (r) => done([...new Uint8Array(await r.arrayBuffer())]))")
        self.assertEqual(bytes(told), file.read_bytes())

    def saved(self, write, what):
        before, revision = self.pixels(), self.state()["revision"]
        write()
        self.until(lambda: self.state()["revision"] > revision and self.pixels() != before, what)

    def test_saving_by_rename_and_in_place(self):
        painting = self.folder / "my" / "lit.png"
        other = SOURCE / "exemplars" / "gouache" / "lit.png"

        def rename():
            shutil.copy(other, self.folder / "my" / "new.png")
            os.replace(self.folder / "my" / "new.png", painting)

        self.saved(rename, "a picture after a save by rename")
        oil = (SOURCE / "exemplars" / "oil" / "lit.png").read_bytes()
        self.saved(lambda: painting.write_bytes(oil), "a picture after a save in place")

    def test_half_a_file_waits_for_the_rest(self):
        painting, whole = self.folder / "my" / "lit.png", (SOURCE / "exemplars" / "gouache" / "lit.png").read_bytes()

        def write():
            with painting.open("wb") as file:
                file.write(whole[:len(whole) // 2])
                file.flush()
                time.sleep(0.7)
                file.write(whole[len(whole) // 2:])

        self.saved(write, "a picture after two halves")
        self.assertFalse(self.find("#problem").is_displayed())

    def test_a_broken_file_is_told_and_the_picture_stays(self):
        painting, before = self.folder / "my" / "lit.png", self.pixels()
        whole = painting.read_bytes()
        painting.write_bytes(whole[:5000])
        self.until(lambda: self.find("#problem").is_displayed(), "the problem")
        self.assertIn("lit.png", self.find("#problem-text").text)
        self.assertEqual(self.pixels(), before)
        painting.write_bytes((SOURCE / "exemplars" / "gouache" / "lit.png").read_bytes())
        self.until(lambda: not self.find("#problem").is_displayed() and self.pixels() != before, "its end")

    def test_a_mended_file_takes_its_problem_away_after_a_look_elsewhere(self):
        painting = self.folder / "my" / "lit.png"
        whole = painting.read_bytes()
        painting.write_bytes(whole[:5000])
        self.until(lambda: self.find("#problem").is_displayed(), "the problem")
        self.choose("style", "gouache")
        self.assertFalse(self.find("#problem").is_displayed())
        self.js("document.querySelector(\"[data-style='my'] input\").click()")
        self.until(lambda: self.find("#problem").is_displayed(), "the problem again")
        painting.write_bytes(whole)
        self.until(lambda: not self.find("#problem").is_displayed(), "its end")

    def test_orbit_and_undo(self):
        before, eye = self.pixels(), self.state()["eye"]
        self.drag(self.find("#stage"), 80, 20)
        self.until(lambda: self.state()["view"], "an orbit")
        self.settled()
        self.assertNotEqual(self.pixels(), before)
        self.assertNotEqual(self.state()["view"]["azimuth"], eye["azimuth"])
        self.find("#undo").click()
        self.until(lambda: self.state()["view"] is None, "the undo")
        self.settled()
        self.assertEqual(self.pixels(), before)

    def test_a_page_as_narrow_as_a_telephone(self):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": 360, "height": 740, "deviceScaleFactor": 1, "mobile": False})
        self.until(lambda: self.js("return innerWidth") == 360, "a narrow page")
        right = self.js("return document.getElementById('download').getBoundingClientRect().right")
        wide = self.js("return document.documentElement.scrollWidth")
        self.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        self.assertLessEqual(max(right, wide), 360)

    def test_a_finish_and_its_dials(self):
        before = self.pixels()
        Select(self.find("#finish-name")).select_by_value("comic")
        self.until(lambda: self.state()["finish"], "a finish")
        self.settled()
        comic = self.pixels()
        self.assertNotEqual(comic, before)
        size = self.browser.get_window_size()
        self.browser.set_window_size(1290, size["height"])
        self.until(lambda: self.js("return innerWidth") == 1290, "a narrow window")
        edges = self.js("return ['status', 'middle'].map((id) => "
                        "document.getElementById(id).getBoundingClientRect().right)")
        self.browser.set_window_size(size["width"], size["height"])
        self.assertLess(edges[0], edges[1], "the line below the picture ends before the right column")
        self.find("#dial-lines").send_keys(Keys.HOME)
        self.until(lambda: self.state()["finish"]["lines"] == 0, "no lines")
        self.settled()
        self.assertNotEqual(self.pixels(), comic)
        self.find("#undo").click()
        self.until(lambda: self.state()["finish"]["lines"] == 0.5, "the undo")
        self.settled()
        self.assertEqual(self.pixels(), comic)
        Select(self.find("#finish-name")).select_by_value("")
        self.until(lambda: self.state()["finish"] is None, "no finish")
        self.settled()
        self.assertEqual(self.pixels(), before)

    def test_a_slider_and_its_reset(self):
        before = self.pixels()
        self.find("[data-key='transfer.threshold'] [data-slider]").send_keys(Keys.ARROW_RIGHT * 10)
        self.until(lambda: "transfer.threshold" in self.state()["keys"], "a changed key")
        self.settled()
        self.assertNotEqual(self.pixels(), before)
        self.assertIn("changed", self.find("[data-key='transfer.threshold']").get_attribute("class"))
        text = (self.folder / "my" / "style.toml").read_text()
        self.find("#save").click()
        self.until(lambda: (self.folder / "my" / "style.toml").read_text() != text, "the save")
        now = (self.folder / "my" / "style.toml").read_text()
        changed = [line for line in now.splitlines() if line not in text.splitlines()]
        self.assertEqual(len(changed), 1, changed)
        self.assertTrue(changed[0].startswith("threshold"), changed)
        self.settled()


class Understanding(Page):
    def test_picking_says_what_the_source_field_says(self):
        stage = self.find("#stage")
        ActionChains(self.browser).move_to_element(stage).perform()
        self.until(lambda: "Suzanne" in self.find("#pick").text, "a pick")
        asked = self.js("return performance.getEntriesByType('resource').map((r) => r.name)"
                        ".filter((name) => name.includes('/api/pick')).pop()")
        status, pick = self.call("GET", asked[asked.index("/api/"):])
        self.assertEqual(status, 200)
        self.assertTrue(pick["covered"])
        self.assertEqual(pick["object"], "Suzanne")
        text = self.find("#pick").text
        self.assertIn(f"level {pick['level']}", text)
        self.assertIn(f"chunk of {pick['chunk']['area']} px", text)

    def test_show_pictures_by_key(self):
        before = self.pixels()
        self.find("#stage").send_keys("2")
        self.until(lambda: self.js("return document.documentElement.dataset.shown") == "chunks", "chunks")
        self.assertNotEqual(self.pixels(), before)
        self.find("#stage").send_keys("0")
        self.until(lambda: self.pixels() == before, "the picture")

    def test_assigning_by_a_click(self):
        ActionChains(self.browser).move_to_element(self.find("#stage")).click().perform()
        self.until(lambda: self.find("#popover").is_displayed(), "the styles for an object")
        self.js("document.querySelector(\"#popover [data-assign='ink']\").click()")
        self.until(lambda: self.state()["assignments"] == [{"name": "Suzanne", "style": "ink"}], "the assignment")
        self.settled()
        self.assertIn("--assign Suzanne=ink", self.call("POST", "/api/export", {"what": "command"})[1]["command"])

    def test_wipe_between_two_pictures(self):
        self.choose("style", "ink")
        self.find("#stage").send_keys("w")
        self.until(lambda: self.js("return document.documentElement.dataset.compare") == "wipe", "the wipe")
        wipe = self.find("#wipe")
        self.until(wipe.is_displayed, "the wipe's handle, which waits for the other picture")
        before = wipe.get_attribute("aria-valuenow")
        wipe.send_keys(Keys.ARROW_LEFT)
        self.assertNotEqual(wipe.get_attribute("aria-valuenow"), before)
        self.js("const b = document.getElementById('beside'); b.value = 'style:gouache';"
                "b.dispatchEvent(new Event('change', {bubbles: true}))")
        self.until(lambda: not self.find("#problem").is_displayed() and "gouache" in self.js(
            "return document.getElementById('beside').value"), "another style beside it")

    def test_a_style_without_a_painting(self):
        self.choose("style", "toon")
        self.until(lambda: self.find("#exemplar-none").is_displayed(), "no painting")
        self.assertFalse(self.find("#exemplar").is_displayed() or self.find("#problem").is_displayed())
        self.assertFalse(self.find("#paint").is_enabled())
        self.choose("style", "my")
        self.until(lambda: self.find("#exemplar").is_displayed() and self.find("#paint").is_enabled(), "a painting")

    def test_letters_never_act_in_fields(self):
        self.find("#keys-find").send_keys("wsd2")
        self.assertEqual(self.js("return document.documentElement.dataset.compare"), "off")
        self.assertEqual(self.find("#keys-find").get_attribute("value"), "wsd2")

    def test_axe_finds_nothing(self):
        self.js(axe_source())
        for theme in ("light", "dark"):
            self.js("document.documentElement.dataset.theme = arguments[0]", theme)
            time.sleep(0.6)  # colours fade from one theme to the other
            found = self.browser.execute_async_script(
                "const done = arguments[0]; axe.run(document, {runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa']})"
                ".then((r) => done(r.violations.map((v) => v.id + ' ' + v.nodes[0].target)))")
            self.assertEqual(found, [], theme)

    def test_by_keyboard_alone(self):
        self.js("document.activeElement.blur()")
        ActionChains(self.browser).send_keys(Keys.TAB, Keys.ENTER).perform()
        self.until(lambda: self.js("return document.activeElement.id") == "stage", "the way past the panels")
        reached = set()
        for _ in range(160):
            ActionChains(self.browser).send_keys(Keys.TAB).perform()
            reached.add(self.js("return document.activeElement.id"))
        for wanted in ("stage", "save-as", "copy-command", "download", "camera", "seed", "paint"):
            self.assertIn(wanted, reached)
        self.assertEqual(self.js("return document.scrollingElement.scrollTop"), 0, "the header is on the screen")
        self.find("#stage").send_keys(Keys.ARROW_LEFT)
        self.until(lambda: self.state()["view"], "an orbit by keys")


class Lasting(Page):
    scene = "toys"

    def test_the_timeline(self):
        before = self.pixels()
        self.assertEqual(self.state()["frame"], 0)
        slider = self.find("#frame-slider")
        slider.send_keys(Keys.ARROW_RIGHT * 6)
        self.until(lambda: self.state()["frame"] > 0, "a frame")
        self.settled()
        self.assertNotEqual(self.pixels(), before)
        frame = self.state()["frame"]
        self.find("#play").click()
        self.until(lambda: self.state()["frame"] != frame, "another frame")
        self.find("#play").click()
        for _ in range(20):
            if self.state()["frame"] == 0:
                break
            self.find("#undo").click()
            self.settled()
        self.assertEqual(self.state()["frame"], 0)
        self.assertEqual(self.pixels(), before)

    def test_a_reload_loses_nothing_also_of_a_new_server(self):
        self.choose("style", "gouache")
        self.find("#stage").send_keys(Keys.ARROW_LEFT)
        self.until(lambda: self.state()["view"], "an orbit")
        self.settled()
        view, before = self.state()["view"], self.pixels()
        self.browser.refresh()
        self.settled()
        self.assertEqual((self.state()["style"], self.state()["view"]), ("gouache", view))
        self.until(lambda: self.pixels() == before, "the picture before")
        self.assertEqual(self.studio.stop(), 0)
        self.until(lambda: self.find("#gone").is_displayed(), "the banner of a server that is gone")
        self.studio = Studio(self.folder, self.scene, self.studio.port)
        self.browser.get(self.studio.address)
        self.settled()
        self.assertEqual(self.state()["scene"], "toys")

    def test_a_reload_in_the_middle_of_changes_keeps_them(self):
        for seed in (3, 5, 7):
            self.js("const input = document.getElementById('seed');"
                    "for (let i = 0; i <= arguments[0]; i += 1) {"
                    "  input.value = String(i); input.dispatchEvent(new Event('change', {bubbles: true})); }"
                    "location.reload()", seed)
            self.until(lambda: self.state()["seed"] == seed, "the last seed")
            self.settled()

    def test_a_studio_for_another_scene_is_left_as_it_is(self):
        self.choose("style", "gouache")
        self.assertEqual(self.studio.stop(), 0)
        self.studio = Studio(self.folder, "snail", self.studio.port)
        self.browser.switch_to.new_window("tab")
        self.browser.get(self.studio.address)
        self.settled()
        self.browser.switch_to.window(self.browser.window_handles[0])
        self.settled()
        self.assertEqual((self.state()["scene"], self.state()["style"]), ("snail", "my"))

    def test_two_tabs(self):
        one = self.browser.current_window_handle
        self.js("window.open('/')")
        two = next(handle for handle in self.browser.window_handles if handle != one)
        self.browser.switch_to.window(two)
        self.settled()
        self.choose("style", "ink")
        self.browser.switch_to.window(one)
        self.settled()
        self.assertTrue(self.js("return document.querySelector(\"[data-style='ink'] input\").checked"))

    def test_painting_on_the_page(self):
        file = self.folder / "my" / "lit.png"
        before, bytes_before = self.pixels(), file.read_bytes()
        self.find("#paint").click()
        self.until(lambda: self.js("return document.body.hasAttribute('data-paint')"), "the brush")
        self.drag(self.find("#exemplar"), 60, 40)
        self.until(lambda: self.find("#paint-save").is_enabled(), "a stroke")
        self.find("#brush-undo").click()
        self.assertFalse(self.find("#paint-save").is_enabled(), "there is nothing to save")
        self.drag(self.find("#exemplar"), 60, 40)
        self.until(lambda: self.find("#paint-save").is_enabled(), "a stroke")
        self.find("#paint-save").click()
        self.until(lambda: file.read_bytes() != bytes_before, "the paint in the file")
        self.until(lambda: self.pixels() != before, "the paint in the picture")

    def begin_to_paint(self):
        if self.find("#paint").get_attribute("aria-pressed") != "true":
            self.find("#paint").click()
        self.until(lambda: self.js("return document.body.hasAttribute('data-paint')"), "the brush")

    def test_a_png_with_another_profile_is_not_painted_on(self):
        file = self.folder / "my" / "lit.png"
        plain = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
        other = plain.replace(b"rXYZ", b"old ").replace(b"gXYZ", b"rXYZ").replace(b"old ", b"gXYZ")
        for profile, is_painted in ((plain, True), (other, False)):
            with Image.open(SOURCE / "exemplars" / "oil" / "lit.png") as picture:
                picture.save(self.folder / "new.png", icc_profile=profile)
            os.replace(self.folder / "new.png", file)
            self.until(lambda: self.call("GET", "/api/paintable?exemplar=0")[1]["ok"] == is_painted,
                       f"painting allowed: {is_painted}")
        why = self.call("GET", "/api/paintable?exemplar=0")[1]["why"]
        self.assertTrue("lit.png" in why and "sRGB" in why, why)

    def test_painting_begins_with_a_copy_of_a_bundled_style(self):
        self.choose("style", "ink")
        self.find("#paint").click()
        self.until(lambda: self.find("#paint-why").is_displayed(), "why it is not painted over")
        self.find("#paint-why button").click()
        name = self.find("#save-as-dialog input")
        name.send_keys(Keys.CONTROL + "a")
        name.send_keys("mine", Keys.ENTER)
        self.until(lambda: self.state()["style"] == "mine", "the copy")
        self.begin_to_paint()

    def test_a_file_event_takes_no_stroke_away(self):
        layer = ("const c = document.getElementById('exemplar-layer');"
                 "return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((byte) => byte > 0)")
        paper = self.folder / "my" / "paper.png"

        def touch(name):
            revision = self.state()["revision"]
            shutil.copy(SOURCE / "exemplars" / name / "paper.png", self.folder / "new.png")
            os.replace(self.folder / "new.png", paper)
            self.until(lambda: self.state()["revision"] > revision, "another paper")
            self.settled()
            time.sleep(0.5)  # the panel asks what the file is now

        self.begin_to_paint()
        stroke = ActionChains(self.browser, duration=20).move_to_element(self.find("#exemplar"))
        stroke.click_and_hold().move_by_offset(30, 20).perform()
        self.until(lambda: self.js(layer), "the beginning of a stroke")
        touch("charcoal")
        self.assertTrue(self.js(layer), "a stroke that is being drawn")
        ActionChains(self.browser, duration=20).move_by_offset(20, 20).release().perform()
        self.until(lambda: self.find("#brush-undo").is_enabled(), "the end of the stroke")
        self.find("#brush-undo").click()
        self.assertFalse(self.js(layer))
        touch("oil")
        self.find("#brush-redo").click()
        self.assertTrue(self.js(layer), "a stroke that was undone")

    def test_strokes_stay_with_their_exemplar(self):
        style = self.folder / "my" / "style.toml"
        shutil.copy(self.folder / "my" / "lit.png", self.folder / "my" / "dark.png")
        style.write_text(style.read_text() + '\n[[exemplar]]\nimage = "dark.png"\nluminance = 0.1\n')
        self.until(lambda: len(self.state()["exemplars"]) == 2, "two exemplars")
        bytes_before = (self.folder / "my" / "dark.png").read_bytes()
        self.until(lambda: self.find("#exemplar-select").is_displayed(), "the choice")
        self.begin_to_paint()
        self.drag(self.find("#exemplar"), 60, 40)
        self.until(lambda: self.find("#paint-save").is_enabled(), "a stroke")
        choose = ("const s = document.getElementById('exemplar-select'); s.value = arguments[0];"
                  "s.dispatchEvent(new Event('change', {bubbles: true}))")
        self.js(choose, "0/1")
        self.until(lambda: "lit.png of my " in self.find("#paint-why").text, "where the strokes lie")
        self.assertFalse(self.find("#exemplar-layer").is_displayed())
        self.js(choose, "0/0")
        self.begin_to_paint()
        self.assertTrue(self.find("#exemplar-layer").is_displayed())
        lit = (self.folder / "my" / "lit.png").read_bytes()
        self.find("#paint-save").click()
        self.until(lambda: (self.folder / "my" / "lit.png").read_bytes() != lit, "the paint in its file")
        self.assertEqual((self.folder / "my" / "dark.png").read_bytes(), bytes_before)


if __name__ == "__main__":
    WORK.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=[sys.argv[0]] + sys.argv[4:], verbosity=2)
