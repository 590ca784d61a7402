#!/usr/bin/env python3
"""Pictures of a page that needs no viewer. Skipped without Chromium."""

import os
import struct
import sys
import tempfile
import unittest
import zlib

import in_browser

PAGE = """<canvas id="canvas" width="4" height="3"></canvas><script>
const gl = canvas.getContext("webgl2");
window.load = async (job) => {
  if ((await fetch("/cases/..%2foutside")).ok) throw new Error("serves what lies outside");
  if (await (await fetch("/cases/" + job.scene)).text() !== "a scene") throw new Error("no scene");
};
window.draw = () => { gl.clearColor(1, 0, 0, 1); gl.clear(gl.COLOR_BUFFER_BIT); };
</script>"""


class InBrowser(unittest.TestCase):
    def test_a_picture_is_kept_with_its_time(self):
        with tempfile.TemporaryDirectory() as folder:
            page, cases = os.path.join(folder, "page", "page.html"), os.path.join(folder, "cases")
            os.mkdir(os.path.dirname(page))
            os.mkdir(cases)
            for name, text in ((page, PAGE), (os.path.join(cases, "scene"), "a scene"), (os.path.join(folder, "outside"), "")):
                with open(name, "w", encoding="utf-8") as file:
                    file.write(text)
            ms = in_browser.milliseconds(page, cases, folder, {"scene": "scene", "pictures": [{"file": "red.png"}]})
            with open(os.path.join(cases, "red.png"), "rb") as file:
                png = file.read()
        self.assertEqual(list(ms), ["red.png"])
        self.assertGreater(ms["red.png"], 0.0)
        self.assertEqual(struct.unpack(">2I", png[16:24]), (4, 3))
        data = png.index(b"IDAT")
        length, = struct.unpack(">I", png[data - 4:data])
        row = zlib.decompressobj().decompress(png[data + 4:data + 4 + length])  # its first byte is a filter
        self.assertEqual(row[1:4], b"\xff\0\0")


if __name__ == "__main__":
    if not in_browser.installed():
        print("skipped: there is no Chromium")
        sys.exit(77)
    unittest.main()
