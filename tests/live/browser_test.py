#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A hand in Chromium cuts a hanging bar, whose lower half falls, and a liver. Exit code 77: there is no browser.

usage: browser_test.py PROGRAM FOLDER [SERIES]
FOLDER: for recordings and pictures. SERIES: a file for those of the liver, side by side (needs python3-pil)."""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

try:
    from selenium import webdriver
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    webdriver = None

import liver

PROGRAM, FOLDER, SERIES = (*sys.argv[1:4], "")[:3]

BAR = {
    "suture": 1,
    "title": "a hanging bar",
    "mesh": {"box": {"size": [1, 0.2, 0.2], "cells": [30, 6, 6]}},
    "models": [{"model": "tm-faure", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
    "gravity": [9.8, 0, 0],
    "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
    "solver": {"dt": "auto", "end": 1, "damping": 2},
    "output": {"every": 0.1, "fields": ["displacement"]},
}

# The sizes of the connected parts of the picture that are not background, largest first.
BLOBS = """
  const from = document.querySelector('#picture'), to = document.createElement('canvas');
  const w = to.width = Math.floor(from.width / 4), h = to.height = Math.floor(from.height / 4);
  const pen = to.getContext('2d');
  pen.drawImage(from, 0, 0, w, h);
  const pixels = pen.getImageData(0, 0, w, h).data, sizes = [];
  const is_body = (i) => pixels[4 * i] < 235 || pixels[4 * i + 1] < 235 || pixels[4 * i + 2] < 235;
  const seen = new Uint8Array(w * h);
  for (let start = 0; start < w * h; ++start) {
    if (seen[start] || !is_body(start)) continue;
    const stack = [start];
    let size = 0;
    seen[start] = 1;
    while (stack.length) {
      const i = stack.pop(), x = i % w;
      ++size;
      for (const j of [x > 0 ? i - 1 : -1, x < w - 1 ? i + 1 : -1, i - w, i + w])
        if (j >= 0 && j < w * h && !seen[j] && is_body(j)) { seen[j] = 1; stack.push(j); }
    }
    sizes.push(size);
  }
  return sizes.filter((size) => size > 50).sort((a, b) => b - a);
"""


def open_browser():
    options = webdriver.ChromeOptions()
    for option in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle",
                   "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=900,700"):
        options.add_argument(option)
    options.add_experimental_option("prefs", {"download.default_directory": os.path.abspath(FOLDER)})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options)


def join(files, name):
    """The middles of pictures, side by side."""
    from PIL import Image

    middles = []
    for file in files:
        picture = Image.open(file).convert("RGB")
        middles.append(picture.crop((picture.width // 4, 80, picture.width * 3 // 4, picture.height - 30)))
    width, height = middles[0].size
    row = Image.new("RGB", (width * len(middles), height))
    for i, middle in enumerate(middles):
        row.paste(middle, (width * i, 0))
    row.save(name, optimize=True)


class Live(unittest.TestCase):
    def setUp(self):
        os.makedirs(FOLDER, exist_ok=True)

    def open(self, name, scene):
        """Starts the run of a scene, and a page."""
        with open(os.path.join(FOLDER, f"{name}.json"), "w") as file:
            json.dump(scene, file)
        self.recording = f"{name}-recording.jsonl"
        for file in os.listdir(FOLDER):  # of an earlier test
            if file.startswith((f"{name}-done", scene["title"].replace(" ", "-"), self.recording)):
                os.remove(os.path.join(FOLDER, file))
        self.run_ = subprocess.Popen([PROGRAM, "-q", "live", f"{name}.json", "-o", self.recording],
                                     cwd=FOLDER, stdout=subprocess.PIPE, text=True)
        self.addCleanup(self.end_run)
        self.address = re.search(r"http://\S+", self.run_.stdout.readline()).group()
        self.page = open_browser()
        self.addCleanup(self.page.quit)
        self.page.get(self.address)
        self.wait("live.control && live.drawn > 0")

    def end_run(self):
        if self.run_.poll() is None:
            self.run_.send_signal(signal.SIGINT)
        self.run_.communicate(timeout=20)

    def js(self, text):
        return self.page.execute_script(text)

    def wait(self, condition, seconds=40):
        end = time.monotonic() + seconds
        while not self.js(f"return Boolean(window.live && {condition})"):
            self.assertLess(time.monotonic(), end, f"{condition}: {self.js('return JSON.stringify([live.state, live.messages])')}")
            time.sleep(0.02)

    def click(self, selector):
        self.page.find_element(By.CSS_SELECTOR, selector).click()

    def drag(self, tool, start, way, holds=False):
        self.click(f"input[value={tool}]")
        canvas = self.page.find_element(By.ID, "picture")
        mouse = ActionChains(self.page).move_to_element_with_offset(canvas, *start).click_and_hold()
        mouse.move_by_offset(*way).move_by_offset(*way)
        (mouse if holds else mouse.release()).perform()

    def wait_for_message(self, pattern):
        self.wait(f"live.messages.some((m) => /{pattern}/.test(m.text))")

    def view(self, name):
        """Saves the picture with what is written on it, without messages."""
        self.js("document.querySelector('#messages').hidden = true")
        self.page.find_element(By.TAG_NAME, "main").screenshot(os.path.join(FOLDER, name))

    def wait_for_file(self, start, content):
        """For a file of the browser, which begins so."""
        end = time.monotonic() + 20
        while time.monotonic() < end:
            for name in os.listdir(FOLDER):
                if not name.startswith(start) or name.endswith(".crdownload"):
                    continue
                with open(os.path.join(FOLDER, name), "rb") as file:
                    if file.read(len(content)) == content:
                        return
            time.sleep(0.05)
        self.fail(f"there is no file {start}* in {os.listdir(FOLDER)}")

    def picture(self, name):
        self.page.save_screenshot(os.path.join(FOLDER, name))

    def press(self, *keys):
        ActionChains(self.page).send_keys(*keys).perform()

    def use_keys(self):
        self.press("k", "?")
        self.assertEqual(self.js("return document.querySelector('.tools input:checked').value"), "knife")
        self.assertGreater(len(self.js("return document.querySelector('#help[open] table')?.innerText ?? ''")), 200)
        self.press(Keys.ESCAPE)
        self.drag("knife", (-250, 60), (250, 0), holds=True)
        self.press(Keys.ESCAPE)  # which ends the drag
        ActionChains(self.page).release().perform()
        self.press(".", ".")
        self.wait("live.state.step == 2 && !live.surface.laid_open && !document.querySelector('#help').open")
        before = self.js("return live.picture.camera.position.x")
        self.drag("look", (0, 0), (30, 10))
        self.assertNotEqual(self.js("return live.picture.camera.position.x"), before)
        self.press("f")
        self.assertAlmostEqual(self.js("return live.picture.camera.position.x"), before, delta=0.02)
        self.press("z")
        self.wait_for_message("no action to take back")
        self.click("#reset")
        self.wait("live.state.step == 0")

    def make(self, steps):
        """Steps of a run that is paused."""
        until = self.js("return live.state.step") + steps
        for _ in range(0, steps, 50):
            self.js("for (let i = 0; i < 50; ++i) document.querySelector('#step').click()")
        self.wait(f"live.state.step == {until} && !live.picture.is_due")
        return until

    def test_a_hand_cuts_a_liver(self):
        with open(os.path.join(FOLDER, "liver.obj"), "w") as file:
            file.write(liver.surface())
        self.open("liver", liver.SCENE)
        self.click("#edges")
        self.js("live.picture.turn(-0.35, 0.25)")
        self.make(400)
        self.view("liver-1.png")
        self.drag("grab", (-165, 30), (-16, 6), holds=True)
        self.make(600)
        self.assertGreater(self.js("return Math.hypot(...live.state.hand.force)"), 0.5)
        self.view("liver-2.png")
        ActionChains(self.page).release().perform()
        self.click("#along-blade")
        self.drag("knife", (-50, -140), (20, 140))
        self.wait_for_message("2 islands")
        self.wait("live.surface.laid_open > 0")
        steps = self.make(150)
        self.view("liver-3.png")
        self.end_run()
        self.wait("!live.control")
        self.repeat(steps)
        if SERIES:
            join([os.path.join(FOLDER, f"liver-{i}.png") for i in (1, 2, 3)], SERIES)

    def test_a_hand_cuts_a_bar(self):
        self.open("bar", BAR)
        self.assertEqual(len(self.js(BLOBS)), 1)
        self.use_keys()
        self.click("#save-video")
        self.click("#speed option[value='0.25']")
        self.click("#play")
        self.wait("live.state.playing && live.state.time > 0.05")
        self.click("#show-side")
        self.drag("grab", (0, 60), (15, 0), holds=True)
        self.wait("live.state.hand && Math.hypot(...live.state.hand.force) > 0.1")
        self.assertRegex(self.page.find_element(By.ID, "force").text, r"^[\d.]+ N$")
        ActionChains(self.page).release().perform()
        self.wait_for_message("grasped .* node")
        self.wait_for_message("released .* node")
        self.click("#save-video")
        self.wait_for_file("a-hanging-bar-", b"\x1aE\xdf\xa3")  # Matroska: webm
        self.click("#play")
        self.wait("!live.state.playing")
        self.drag("knife", (-250, 60), (250, 0))
        self.wait_for_message("2 islands")
        self.wait("live.surface.laid_open > 0")
        self.click("#back")
        self.wait_for_message("cut was taken back")
        self.wait("live.surface.laid_open == 0 && live.kept.length == 1")
        self.click("#cut option[value='path']")
        self.drag("knife", (-250, 15), (250, -10))
        self.wait("live.surface.laid_open > 0")
        # The lower piece falls by as many steps as its way takes, however slow this computer is.
        paused = self.make(200)
        self.picture("two-pieces.png")
        self.click("#save-picture")
        self.wait_for_file("a-hanging-bar-", b"\x89PNG")
        self.click("#scene")
        self.wait_for_file("bar-done", b'{')
        sizes = self.js(BLOBS)
        self.assertEqual(len(sizes), 2, sizes)
        self.assertGreater(sizes[1], sizes[0] / 10)

        self.page.switch_to.new_window("tab")
        self.page.get(self.address)
        self.wait("live.drawn > 0 && live.greeting")
        self.assertFalse(self.js("return live.control"))
        self.assertFalse(self.page.find_element(By.ID, "play").is_enabled())
        self.page.close()
        self.page.switch_to.window(self.page.window_handles[0])

        self.click("#step")
        self.wait(f"live.state.step == {paused + 1}")
        self.assertEqual([entry for entry in self.page.get_log("browser") if entry["level"] == "SEVERE"], [])
        self.end_run()
        self.wait("!live.control")
        self.repeat(paused + 1)

    def repeat(self, steps):
        for threads in ("1", "2"):
            done = subprocess.run([PROGRAM, "run", self.recording, "--threads", threads],
                                  cwd=FOLDER, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"{steps} steps", done.stdout)
            self.assertNotIn("warning", done.stderr)


if __name__ == "__main__":
    if webdriver is None or not shutil.which("chromium") or not shutil.which("chromedriver"):
        print("skipped: needs chromium, chromium-driver and python3-selenium (./dev install-deps browser)")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
