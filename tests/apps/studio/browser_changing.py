"""Changes on the studio's page: what is changed comes back. A part of browser_test.py."""
import os
import shutil
import time

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

from browser_page import Page, SOURCE


class Changing(Page):
    """What is changed comes back: by the strip, by undo, after a save."""

    def threshold(self):
        return self.state()["keys"].get("transfer.threshold")

    def set_threshold(self, value):
        self.js("const field = document.getElementById('key-transfer.threshold'); field.value = arguments[0];"
                "field.dispatchEvent(new Event('change', {bubbles: true}))", str(value))
        self.until(lambda: self.threshold() == value, f"a threshold of {value}")
        self.settled()

    def seen(self, number):
        self.until(lambda: self.browser.find_elements(By.CSS_SELECTOR, f"[data-seen='{number}']"), f"picture {number}")

    def test_the_strip_brings_settings_back_and_a_reload_keeps_it(self):
        self.seen(1)
        before = self.pixels()
        self.set_threshold(0.5)
        self.seen(2)
        self.find("[data-seen='1'] .restore").click()
        self.until(lambda: self.threshold() is None, "the settings of the first picture")
        self.settled()
        self.assertEqual(self.pixels(), before)
        self.find("#undo").click()
        self.until(lambda: self.threshold() == 0.5, "what was before the first picture came back")
        self.browser.refresh()
        self.settled()
        self.seen(2)
        self.find("#undo").click()
        self.until(lambda: self.threshold() is None, "the undo of a change before the reload")
        self.find("[data-seen='2'] .restore").click()
        self.until(lambda: self.threshold() == 0.5, "the settings of a picture from before the reload")
        self.js("document.querySelector(\"[data-seen='1'] [data-side='b']\").click()")
        self.until(self.find("#wipe").is_displayed, "a comparison with a picture from before the reload")
        self.assertIn("anew", self.find("#tag-b").text)

    def test_undo_goes_on_after_a_save(self):
        file = self.folder / "my" / "style.toml"
        own, before = self.state()["file_keys"]["transfer.threshold"], self.pixels()
        self.set_threshold(0.5)
        self.type_into("#key-transfer\\.paper", "#ff8888")
        self.until(lambda: "transfer.paper" in self.state()["keys"], "a paper of one colour")
        self.find("#save").click()
        self.until(lambda: "0.5" in file.read_text() and not self.state()["keys"], "the save")
        self.find("#undo").click()
        self.until(lambda: self.state()["keys"] == {"transfer.paper": "paper.png"}, "the picture of paper")
        self.find("#undo").click()
        self.until(lambda: self.threshold() == own, "the value from before the save")
        self.settled()
        self.assertEqual(self.pixels(), before)
        self.find("#redo").click()
        self.until(lambda: self.threshold() is None, "the saved value")

    def other_tab(self):
        """A second page of the studio, that is looked at: (the first one's handle, its own)."""
        one = self.browser.current_window_handle
        self.js("window.open('/')")
        two = next(handle for handle in self.browser.window_handles if handle != one)
        self.browser.switch_to.window(two)
        self.settled()
        return one, two

    def says(self, *texts):
        self.until(lambda: all(text in self.find("#status").text for text in texts), f"the words {texts}")

    def test_undo_goes_on_after_a_save_in_another_tab(self):
        file = self.folder / "my" / "style.toml"
        own, before = self.state()["file_keys"]["transfer.threshold"], self.pixels()
        self.set_threshold(0.5)
        one, two = self.other_tab()
        self.find("[data-key='transfer.scale'] [data-slider]").send_keys(Keys.ARROW_RIGHT * 10)
        self.until(lambda: self.state()["keys"].get("transfer.scale") == 1.5, "a change of the other tab")
        self.settled()
        self.find("#save").click()
        self.until(lambda: not self.state()["keys"], "the save")
        self.browser.switch_to.window(one)
        self.until(lambda: not self.find("#save").is_enabled(), "news of the save")
        self.settled()
        self.find("#undo").click()
        self.until(lambda: self.state()["keys"] == {"transfer.threshold": own}, "the value from before the save")
        self.says("undone: threshold", str(own), "saved is 0.5")
        self.assertTrue("0.5" in file.read_text() and "scale = 1.5" in file.read_text(), file.read_text())
        self.find("#redo").click()
        self.until(lambda: not self.state()["keys"], "the saved value again")
        self.find("#undo").click()
        self.until(lambda: self.threshold() == own, "the value from before the save again")
        self.browser.switch_to.window(two)
        self.settled()
        self.find("#undo").click()  # the other tab's own step
        self.until(lambda: self.state()["keys"] == {"transfer.threshold": own, "transfer.scale": 1}, "its scale")
        self.settled()
        self.assertEqual(self.pixels(), before)

    def test_undo_goes_on_after_a_save_while_the_page_was_away(self):
        own = self.state()["file_keys"]["transfer.threshold"]
        self.set_threshold(0.5)
        one, two = self.other_tab()
        self.browser.switch_to.window(one)
        self.browser.get("about:blank")
        self.browser.switch_to.window(two)
        self.find("#save").click()
        self.until(lambda: self.threshold() is None, "the save")
        self.browser.switch_to.window(one)
        self.browser.get(self.studio.address)
        self.settled()
        self.find("#undo").click()
        self.until(lambda: self.threshold() == own, "the value from before the save")

    def test_undo_goes_on_after_another_tab_has_saved_a_copy(self):
        own, before = self.state()["file_keys"]["transfer.threshold"], self.pixels()
        self.set_threshold(0.5)
        one, _ = self.other_tab()
        self.find("#save-as").click()
        name = self.find("#save-as-name")
        name.send_keys(Keys.CONTROL + "a")
        name.send_keys("copy", Keys.ENTER)
        self.until(lambda: self.state()["style"] == "copy", "the copy")
        self.browser.switch_to.window(one)
        self.until(lambda: "copy" in self.find("#title").text, "news of the copy")
        self.find("#undo").click()
        self.until(lambda: (self.state()["style"], self.threshold()) == ("copy", own), "the value in the copy")
        self.settled()
        self.assertEqual(self.pixels(), before)

    def test_what_another_tab_has_changed_is_not_lost_without_a_word(self):
        self.set_threshold(0.5)
        one, _ = self.other_tab()
        self.set_threshold(0.7)
        self.browser.switch_to.window(one)
        self.settled()
        self.find("#undo").click()
        self.until(lambda: self.threshold() is None, "the file's value")
        self.says("undone", "another page had changed threshold: redo brings that back")
        self.find("#redo").click()
        self.until(lambda: self.threshold() == 0.7, "the other tab's value")

    def test_a_save_meets_a_change_that_is_on_its_way(self):
        own = self.state()["file_keys"]["transfer.threshold"]
        self.set_threshold(0.5)
        self.js("const own = window.fetch; window.fetch = async (path, options) => {"
                "if (options?.method === 'PATCH') await new Promise((go) => { window.go = go; });"
                "return own(path, options); }")
        for number in ("0.6", "0.5"):  # the second waits until the first was answered
            self.js("const field = document.getElementById('key-transfer.threshold'); field.value = arguments[0];"
                    "field.dispatchEvent(new Event('change', {bubbles: true}))", number)
        self.until(lambda: self.js("return !!window.go"), "the change on its way")
        self.assertEqual(self.call("POST", "/api/save")[0], 200)
        self.assertIsNone(self.threshold())
        self.js("const go = window.go; window.go = null; go()")
        self.until(lambda: self.threshold() == 0.6, "the first change")
        self.until(lambda: self.js("return !!window.go"), "the second change")
        self.js("window.go()")
        self.until(lambda: self.threshold() == 0.5, "the second change, which is the saved value")
        for value in (0.6, None, own):
            self.js("window.go = null; document.getElementById('undo').click()")
            self.until(lambda: self.js("return !!window.go"), "the undo on its way")
            self.js("window.go()")
            self.until(lambda: self.threshold() == value, f"undo to {value}")

    def test_key_frames_stay_when_their_key_is_changed(self):
        file = self.folder / "my" / "style.toml"
        lines = ["threshold = [[1, 0.02], [24, 0.6]]" if line.startswith("threshold =") else line
                 for line in file.read_text().splitlines()]
        file.write_text("\n".join(lines))
        row = self.find("[data-key='transfer.threshold']")
        self.until(lambda: "moves" in row.get_attribute("class"), "a key that changes over time")
        self.settled()
        self.assertEqual(self.find("#key-transfer\\.threshold").get_attribute("value"), "0.02")
        before = self.pixels()
        self.set_threshold(0.3)
        self.find("#save").click()
        self.until(lambda: "[[1, 0.02], [24, 0.6]]" in self.find("#save-as-error").text, "why it is not saved")
        name = self.find("#save-as-name")
        name.send_keys(Keys.CONTROL + "a")
        name.send_keys("still", Keys.ENTER)
        self.until(lambda: self.state()["style"] == "still", "the copy")
        self.find("#undo").click()
        self.until(lambda: (self.state()["style"], self.threshold()) == ("my", 0.3), "the style with the changed key")
        self.find("#undo").click()
        self.until(lambda: self.threshold() is None, "the key frames")
        self.settled()
        self.assertEqual(self.pixels(), before)

    def test_a_save_leaves_the_undo_of_other_styles_alone(self):
        self.choose("style", "ink")
        self.set_threshold(0.5)
        self.choose("style", "my")
        self.set_threshold(0.5)
        self.find("#save").click()
        self.until(lambda: self.threshold() is None, "the save")
        for _ in range(2):  # the key, the choice of the style
            self.find("#undo").click()
            self.settled()
        self.assertEqual((self.state()["style"], self.threshold()), ("ink", 0.5))
        self.find("#undo").click()
        self.until(lambda: self.threshold() is None, "ink as its file has it")
        self.find("#redo").click()
        self.until(lambda: self.threshold() == 0.5, "ink as it was changed")

    def test_the_strip_shows_what_it_showed_after_a_save(self):
        self.seen(1)
        before, own = self.pixels(), self.state()["file_keys"]["transfer.threshold"]
        self.set_threshold(0.5)
        self.seen(2)
        self.find("#save").click()
        self.until(lambda: self.threshold() is None, "the save")
        self.find("[data-seen='1'] .restore").click()
        self.until(lambda: self.threshold() == own, "the value from before the save")
        self.settled()
        self.assertEqual(self.pixels(), before)

    def test_the_strip_keeps_new_paint_of_the_same_settings(self):
        self.seen(1)
        painting, before = self.folder / "my" / "lit.png", self.pixels()
        thumbnail = self.find("[data-style='my'] img").get_attribute("src")
        shutil.copy(SOURCE / "exemplars" / "gouache" / "lit.png", self.folder / "new.png")
        os.replace(self.folder / "new.png", painting)
        self.seen(2)
        self.assertNotEqual(self.pixels(), before)
        self.assertNotEqual(self.find("[data-style='my'] img").get_attribute("src"), thumbnail)
        self.set_threshold(0.5)
        self.seen(3)
        self.find("#save").click()
        self.until(lambda: self.threshold() is None, "the save")
        self.settled()
        time.sleep(1)  # the saved file is read, and paints the same
        self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, "[data-seen]")), 3)

    def test_numbers_that_are_no_use_give_way(self):
        def typed(field, text):
            self.type_into(field, text)
            return self.find(field).get_attribute("value")

        self.assertEqual(typed("#size-width", Keys.DELETE), "320")
        self.assertEqual(typed("#size-width", "0"), "320")
        self.assertEqual(typed("#seed", "-5"), "0")
        self.assertEqual(self.state()["size"], [320, 180])
        for field, text in (("#seed", "1.5"), ("#seed", "-1"), ("#seed", Keys.DELETE), ("#size-width", "0"),
                            ("#size-height", "20000")):
            before = self.find(field).get_attribute("value")
            self.find(field).send_keys(Keys.CONTROL + "a")
            self.find(field).send_keys(text, Keys.ENTER)  # the field stays the active one
            self.assertEqual(self.find(field).get_attribute("value"), before, f"{field} after {text}")
        width = self.find("#size-width")
        width.send_keys(Keys.CONTROL + "a")
        width.send_keys("400", Keys.ENTER)
        self.until(lambda: self.state()["size"] == [400, 180], "another size")
        width.send_keys(Keys.CONTROL + "z")
        self.until(lambda: width.get_attribute("value") == "320", "the size from before in the field that was typed in")
        Select(self.find("#quality")).select_by_value("budget")
        self.until(lambda: self.state()["budget_ms"] == 50, "a budget")
        self.assertEqual(typed("#budget", "30"), "30")
        self.until(lambda: self.state()["budget_ms"] == 30, "another budget")

    def test_a_final_that_is_no_longer_asked_for_is_given_up(self):
        self.js("window.asked = [], window.drafts = 0; const own = window.fetch; window.fetch = (path, options) => {"
                "if (String(path).includes('quality=final')) window.asked.push(options.signal);"
                "if (String(path).includes('quality=draft')) ++window.drafts;"
                "return own(path, options); }")
        self.call("PATCH", "/api/state", {"size": [6000, 6000]})
        self.until(lambda: self.js("return window.asked.length"), "the request for a large final")
        self.type_into("#seed", "5")
        self.until(lambda: self.js("return window.asked[0].aborted"), "the end of a request for an old final")
        self.until(lambda: self.js("return window.drafts"), "a draft, so that changes in quick turn are seen")
        self.type_into("#size-width", "320")
        self.type_into("#size-height", "180")
        self.settled()
        self.assertEqual(self.js("return [document.getElementById('picture').width, window.asked.length > 1]"),
                         [320, True])

    def test_every_press_of_a_key_moves_a_slider_of_a_wide_range(self):
        self.find("[data-key='transfer.scale'] [data-slider]").send_keys(Keys.ARROW_RIGHT * 10)
        self.until(lambda: self.state()["keys"].get("transfer.scale") == 1.5, "ten steps")

    def test_a_number_that_is_being_typed_is_saved(self):
        field = self.find("[id='key-transfer.threshold']")
        field.send_keys(Keys.CONTROL + "a")
        field.send_keys("0.37")
        field.send_keys(Keys.CONTROL + "s")
        self.until(lambda: "0.37" in (self.folder / "my" / "style.toml").read_text(), "the save")
