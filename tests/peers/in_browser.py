"""Draws pictures by a page in Chromium without a window.

A page has `canvas`, `load(job)`, which answers when the scene is loaded and sorted, and `draw(picture)`, which draws a
frame by WebGL. It finds npm's modules under /modules and the cases under /cases.
"""

import base64
import functools
import http.server
import json
import os
import posixpath
import sys
import threading
import urllib.parse

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "browser"))
from chromium import Chromium, program  # noqa: E402

# Reading a pixel waits for the frame.
FRAME = """(() => {
  const gl = canvas.getContext("webgl2"), start = performance.now();
  draw(%s);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  return [performance.now() - start, canvas.toDataURL()];
})()"""


def installed():
    return program() is not None


class Files(http.server.SimpleHTTPRequestHandler):
    def __init__(self, roots, *args):
        self.roots = roots
        super().__init__(*args)

    def translate_path(self, path):
        path = posixpath.normpath(urllib.parse.unquote(urllib.parse.urlparse(path).path))
        root, _, name = path.lstrip("/").partition("/")
        return os.path.join(self.roots.get(root, os.devnull), name)

    def log_message(self, *_):
        pass


def milliseconds(page, folder, modules, job):
    """Of the second frame of each of the job's pictures, by file; writes them to `folder` as PNG."""
    roots = {"cases": folder, "modules": modules, "page": os.path.dirname(page)}
    ms = {}
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, roots)) as server, \
            Chromium() as browser:
        threading.Thread(target=server.serve_forever, args=[0.05], daemon=True).start()
        browser.patience_s = 600  # a software renderer needs minutes for a strong blur
        try:
            browser.visit(f"http://127.0.0.1:{server.server_port}/page/{os.path.basename(page)}")
            browser.run(f"load({json.dumps(job)})")
            for picture in job["pictures"]:
                for _ in range(2):
                    ms[picture["file"]], url = browser.run(FRAME % json.dumps(picture))
                with open(os.path.join(folder, picture["file"]), "wb") as file:
                    file.write(base64.b64decode(url.partition(",")[2]))
        finally:
            server.shutdown()
    return ms
