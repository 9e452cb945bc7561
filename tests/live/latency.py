#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How long after the mouse a picture shows what it did, in Chromium: a table of medians and 99th percentiles.

usage: latency.py PROGRAM FOLDER [N ...]
For cubes of N^3 elements (default: 27 100): a knife that cuts 40 times, ten times each body, and a hand that is dragged 40 times.
message: from the event of the mouse to the message of the run; picture: to the end of its drawing."""
import os
import statistics
import sys
import time

from browser_test import Live
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

ROUNDS = 40

# Without a change of the page: when a state that shows an action has come, and when it is drawn.
HOOKS = """
  const picture = live.picture, gl = picture.renderer.getContext(), pixel = new Uint8Array(4);
  window.shown = {is_new: () => false, message: 0, picture: 0};
  let is_awaited = false;
  document.querySelector('#picture').addEventListener('pointermove', (e) => shown.moved = e.timeStamp, true);
  document.querySelector('#picture').addEventListener('pointerup', (e) => shown.up = e.timeStamp, true);
  const set_state = picture.set_state.bind(picture), render = picture.renderer.render.bind(picture.renderer);
  picture.set_state = (head, ...arrays) => {
    if (!shown.message && shown.is_new(head)) { shown.message = performance.now(); is_awaited = true; }
    set_state(head, ...arrays);
  };
  picture.renderer.render = (...given) => {
    render(...given);
    if (!is_awaited) return;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);  // ends when all is drawn
    is_awaited = false;
    shown.picture = performance.now();
  };
"""


def scene(side):
    return {
        "suture": 1,
        "title": f"a cube of {side ** 3} elements",
        "mesh": {"box": {"size": [1, 1, 1], "cells": [side] * 3}},
        "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.4, "rho": 1000}}],
        "gravity": [0, -2, 0],
        "constraints": [{"fix": "xyz", "where": {"set": "y0"}}],
        "solver": {"dt": "auto", "end": 1, "damping": 2, "threads": 1},
        "output": {"every": 1, "fields": ["displacement"]},
    }


class Stopwatch(Live):
    def runTest(self):
        pass

    def expect(self, is_new):
        self.js(f"shown.message = shown.picture = 0; const before = live.state, surface = live.surface;"
                f"shown.is_new = (head) => {is_new}")

    def since(self, event):
        """Times of the message and of the picture, ms after an event."""
        self.wait("shown.picture")
        return self.js(f"return [shown.message - shown.{event}, shown.picture - shown.{event}]")

    def cuts(self):
        times = []
        for i in range(ROUNDS):
            if i % 10 == 0 and i > 0:  # each cut lays open what has to be drawn from then on
                self.restart()
            self.expect("head.surface !== before.surface")
            self.drag("knife", (-120 + 6 * i, -60 + 3 * (i % 7)), (10, 15))
            times.append(self.since("up"))
        return times

    def restart(self):
        self.expect("head.surface !== before.surface")
        self.click("#reset")
        self.wait("shown.picture")

    def drags(self):
        """From the last motion of the mouse: the hand is on its way."""
        self.drag("grab", (0, -40), (2, 0), holds=True)
        self.wait("live.state.hand")
        times, canvas = [], self.page.find_element(By.ID, "picture")
        for i in range(ROUNDS):
            time.sleep(0.1)
            self.expect("head.hand && Math.hypot(...head.hand.place.map((x, k) => x - before.hand.place[k])) > 1e-6")
            ActionChains(self.page, duration=0).move_to_element_with_offset(canvas, (-1) ** i * 12, -40).perform()
            times.append(self.since("moved"))
        ActionChains(self.page).release().perform()
        return times

    def rate(self, seconds=3):
        count = lambda: self.js("return [live.drawn, performance.now()]")
        before = count()
        time.sleep(seconds)
        after = count()
        return 1e3 * (after[0] - before[0]) / (after[1] - before[1])


def columns(times):
    at = lambda part, kind: sorted(each[kind] for each in times)[min(int(part * len(times)), len(times) - 1)]
    return "".join(f"{at(part, kind):9.0f}" for kind in (0, 1) for part in (0.5, 0.99))


def measure(side):
    live = Stopwatch()
    live.setUp()
    try:
        live.open("cube", scene(side))
        live.js(HOOKS)
        cut = live.cuts()
        live.restart()
        live.click("#play")
        live.wait("live.state.playing && live.state.step > 3")
        drag, rate = live.drags(), live.rate()
    finally:
        live.doCleanups()
    for name, times in (("cut", cut), ("drag", drag)):
        print(f"{side ** 3:9}  {name:5}{columns(times)}{rate:12.0f}", flush=True)


if __name__ == "__main__":
    print(" elements  input  message: median, p99  picture: median, p99 [ms]  pictures/s")
    for each in sys.argv[3:] or ["27", "100"]:
        measure(int(each))
