# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that leave their files in a folder of their own."""

import os
import signal
import subprocess
import tempfile
import time
import unittest


class InFolder(unittest.TestCase):
    def setUp(self):
        self.before = os.getcwd()
        self.folder = tempfile.TemporaryDirectory()
        os.chdir(self.folder.name)

    def tearDown(self):
        os.chdir(self.before)
        self.folder.cleanup()

    def stop_when(self, has_begun, *words):
        """Ctrl-C for a command that can be continued, when has_begun() is true."""
        process = subprocess.Popen([os.environ["SUTURE_PROGRAM"], *words],
                                   stderr=subprocess.PIPE, text=True, start_new_session=True)
        while not has_begun():
            self.assertIsNone(process.poll(), "it ends before it is stopped")
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate()
        self.assertEqual(process.returncode, 130, said)
        self.assertIn("the same command continues", said)
        self.assertNotIn("Traceback", said)
