# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that leave their files in a folder of their own."""

import os
import tempfile
import unittest


class InFolder(unittest.TestCase):
    def setUp(self):
        self.before = os.getcwd()
        self.folder = tempfile.TemporaryDirectory()
        os.chdir(self.folder.name)

    def tearDown(self):
        os.chdir(self.before)
        self.folder.cleanup()
