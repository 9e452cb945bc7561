# SPDX-License-Identifier: GPL-3.0-or-later
"""The live view of a script: what a page sees and does, and what the recording repeats."""
import base64
import json
import os
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request

import numpy

import suture
from scenes import bar

PROGRAM = os.environ["SUTURE_PROGRAM"]


class Page:
    """A web socket (RFC 6455) without fragments, which answers every state."""

    def __init__(self, address):
        host, path = address[len("http://"):].split("/", 1)
        name, port = host.split(":")
        self.socket = socket.create_connection((name, int(port)))
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /{path}socket HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
            f"Sec-WebSocket-Version: 13\r\n\r\n".encode())
        self.file = self.socket.makefile("rb")
        assert b" 101 " in self.file.readline()
        while self.file.readline().strip():
            pass

    def close(self):
        self.file.close()
        self.socket.close()

    def send(self, data):
        self.write(*((0x82, b"") if data is None else (0x81, json.dumps(data).encode())))

    def write(self, kind, payload):
        size = (bytes([0x80 | len(payload)]) if len(payload) < 126
                else bytes([0x80 | 126]) + struct.pack(">H", len(payload)))
        self.socket.sendall(bytes([kind]) + size + bytes(4) + payload)  # a mask of zeros

    def next(self):
        kind, size = self.file.read(2)
        if size >= 126:
            size = int.from_bytes(self.file.read(2 if size == 126 else 8), "big")
        payload = self.file.read(size)
        if kind & 15 == 9:  # a ping, which wants its payload back
            self.write(0x8a, payload)
            return self.next()
        if kind & 15 == 1:
            return json.loads(payload)
        head = json.loads(payload[4:4 + struct.unpack("<I", payload[:4])[0]])
        if head["kind"] == "state":
            self.send(None)
        return head

    def until(self, key):
        while key not in (message := self.next()):
            pass
        return message

    def state_after(self, step):
        while (state := self.until("step"))["step"] < step:
            pass
        return state


class LiveTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.recording = pathlib.Path(folder.name) / "recording.jsonl"

    def open_page(self, view):
        page = Page(view.address)
        self.addCleanup(page.close)
        return page

    def repeat(self):
        done = subprocess.run([PROGRAM, "run", self.recording], cwd=self.recording.parent,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("differs", done.stderr)
        return done.stdout

    def lines(self):
        return [json.loads(line) for line in self.recording.read_text().splitlines()]

    def test_a_page_and_a_script_share_a_run_and_its_recording(self):
        sim = suture.Simulation(bar(end=100))
        sim.run_to(0.01)
        sim.gravity = [0, -5, 1]  # before there is a view
        sim.step(3)
        with sim.live(recording=self.recording) as view:
            self.assertIn(view.address, view._repr_html_())
            page = self.open_page(view)
            self.assertEqual(page.until("live")["elements"], len(sim.element_ids))
            before = sim.steps
            sim.step(20)
            page.state_after(before + 1)
            page.send({"do": "play"})  # refused while the script makes steps
            time.sleep(0.1)
            sim.step()
            self.assertIn("the script makes the steps", page.until("error")["error"])

            def play():
                page.send({"do": "play"})
                start = page.until("step")["step"]
                page.state_after(start + 50)
                page.send({"do": "apply", "event": {"cut": {"plane": {
                    "point": [1.5, 0, 0], "normal": [1, 0, 0]}}}})
                page.until("message")
                page.send({"do": "reset"})
                self.assertIn("only it can", page.until("error")["error"])

            player = threading.Thread(target=play)
            player.start()
            while player.is_alive():
                view.run(0.2)
            self.assertTrue(any("cut" in line for line in sim.messages))
            self.assertEqual(view.recording, self.recording)
            sim.parameters["tm-faure"]["E"] = 3e5
            sim.grasp("tip", {"set": "x1"})
            sim.move_grasp("tip", [0, 0.01, 0], at=sim.time + 0.02)
            sim.step(30)
            steps = sim.steps
        devices = [line["device"] for line in self.lines() if "device" in line]
        self.assertEqual(devices, ["script", "page", "script", "script", "script"])
        self.assertIn(f"{steps} steps", self.repeat())
        self.assertEqual(view.recording, self.recording)
        with self.assertRaisesRegex(RuntimeError, "closed"):
            view.run(1)

    def test_what_cannot_be_repeated_ends_the_recording(self):
        sim = suture.Simulation(bar(end=100))
        view = sim.live(recording=self.recording)
        page = self.open_page(view)
        page.until("live")
        sim.gravity = [0, -5, 1]
        sim.velocity = numpy.zeros_like(sim.velocity)
        self.assertIn("velocities were assigned", page.until("warning")["warning"])
        sim.gravity = [0, 0, 0]
        view.close()
        self.assertEqual(len(self.lines()), 2)
        with self.assertRaises(suture.InputError), sim.live(port=0), sim.live():
            pass

    def test_a_view_needs_no_page(self):
        sim = suture.Simulation(bar(end=100))
        with sim.live(recording=False) as view:
            sim.step(10)
            self.assertIsNone(view.recording)
            with self.assertRaisesRegex(ValueError, "seconds"):
                view.run(0)
            with self.assertRaisesRegex(RuntimeError, "close"):
                sim.restore(sim.copy())
            page = urllib.request.urlopen(view.address).read()
        self.assertIn(b"<canvas", page)

    def test_a_page_sees_the_last_state_whenever_it_comes(self):
        sim = suture.Simulation(bar(end=100))
        with sim.live(recording=False) as view:
            sim.step(10)
            pages = [self.open_page(view)]
            self.assertEqual(pages[0].until("step")["step"], sim.steps)

            @sim.every(1)
            def fail(sim):
                if sim.steps > 15:
                    raise ValueError

            with self.assertRaises(ValueError):
                sim.step(10)
            pages[0].state_after(sim.steps)
            pages.append(self.open_page(view))
            self.assertEqual(pages[1].until("step")["step"], sim.steps)

    def test_the_module_is_loaded_by_a_view_only(self):
        program = ("import suture; from scenes import bar; sim = suture.Simulation(bar()); sim.step();"
                   "loaded = lambda: 'libsuture-live' in open('/proc/self/maps').read();"
                   "print(loaded()); sim.live(recording=False).close(); print(loaded())")
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True,
                              cwd=pathlib.Path(__file__).parent)
        self.assertEqual(done.stdout.split(), ["False", "True"], done.stderr)


if __name__ == "__main__":
    unittest.main()
