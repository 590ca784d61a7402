#!/usr/bin/env python3
"""What in_browser.py does with the answers of a page, which a script in Chromium's place gives."""

import os
import sys
import tempfile
import unittest
from unittest import mock

import in_browser

CHROMIUM = """#!{python}
import sys
import urllib.error
import urllib.request

base = sys.argv[-1].rsplit("/", 2)[0]


def ask(path, body=None):
    return urllib.request.urlopen(base + path, body).read()


{page}
"""
JOB = {"pictures": [{"file": "sharp.png"}]}


class InBrowser(unittest.TestCase):
    def answered(self, page):
        """Milliseconds, and the folder's files with their bytes, after a page that runs these lines."""
        with tempfile.TemporaryDirectory() as folder:
            chromium = os.path.join(folder, "chromium")
            with open(chromium, "w", encoding="utf-8") as file:
                file.write(CHROMIUM.format(python=sys.executable, page=page))
            os.chmod(chromium, 0o755)
            cases = os.path.join(folder, "cases")
            os.mkdir(cases)
            with mock.patch.dict(os.environ, {"PATH": folder}):
                ms = in_browser.milliseconds("spark.html", cases, folder, JOB)
            files = {}
            for name in os.listdir(cases):
                with open(os.path.join(cases, name), "rb") as file:
                    files[name] = file.read()
            return ms, files

    def test_a_picture_is_kept_with_its_time(self):
        ms, files = self.answered("""
assert b'sharp.png' in ask('/job') and b'<script' in ask('/peers/spark.html')
ask('/picture?file=sharp.png&ms=12.5', b'PNG')
ask('/done', b'')""")
        self.assertEqual(ms, {"sharp.png": 12.5})
        self.assertEqual(files, {"sharp.png": b"PNG"})

    def test_no_file_outside_is_served(self):
        self.answered("""
try:
    ask('/cases/../chromium')
    ask('/done', b'served')
except urllib.error.HTTPError as error:
    ask('/done', b'' if error.code == 404 else b'other')""")

    def test_a_fault_of_the_page_is_named(self):
        with self.assertRaisesRegex(RuntimeError, "spark.html: no WebGL"):
            self.answered("ask('/done', b'no WebGL')")

    def test_a_browser_that_ends_early_is_no_endless_wait(self):
        with self.assertRaisesRegex(RuntimeError, "ended"):
            self.answered("")


if __name__ == "__main__":
    unittest.main()
