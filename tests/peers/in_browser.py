"""Runs a page that draws Gaussians in Chromium without a window, and takes its pictures.

The page finds npm's modules under /modules, the cases under /cases, and its job under /job.
"""

import functools
import http.server
import json
import os
import posixpath
import shutil
import subprocess
import tempfile
import threading
import time
import urllib.parse

HERE = os.path.dirname(os.path.abspath(__file__))
TIMEOUT_S = 900  # a software renderer needs minutes for a strong blur


class Handler(http.server.SimpleHTTPRequestHandler):
    def __init__(self, run, *args):
        self.run = run
        super().__init__(*args)

    def translate_path(self, path):
        path = posixpath.normpath(urllib.parse.unquote(urllib.parse.urlparse(path).path))
        root, _, name = path.lstrip("/").partition("/")
        return os.path.join(self.run.roots.get(root, os.devnull), name)

    def log_message(self, *_):
        pass

    def answer(self, body=b""):
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self):
        if self.path == "/job":
            self.answer(json.dumps(self.run.job).encode())
        else:
            super().do_GET()

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        url = urllib.parse.urlparse(self.path)
        if url.path == "/picture":
            query = urllib.parse.parse_qs(url.query)
            self.run.take(query["file"][0], float(query["ms"][0]), body)
        else:
            self.run.end(body.decode())
        self.answer()


class Run:
    def __init__(self, folder, modules, job):
        self.roots = {"cases": folder, "modules": modules, "peers": HERE}
        self.folder, self.job = folder, job
        self.ms, self.fault, self.ended = {}, "", threading.Event()

    def take(self, file, ms, png):
        if file not in {picture["file"] for picture in self.job["pictures"]}:
            raise ValueError(f"{file}: was not asked for")
        with open(os.path.join(self.folder, file), "wb") as out:
            out.write(png)
        self.ms[file] = ms

    def end(self, fault):
        self.fault = fault
        self.ended.set()


def milliseconds(page, folder, modules, job):
    """Of one frame, for each of the job's pictures, which the page draws into `folder`."""
    run = Run(folder, modules, job)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, run))
    threading.Thread(target=server.serve_forever, args=[0.05], daemon=True).start()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = subprocess.Popen(
            [shutil.which("chromium"), "--headless", "--no-sandbox", "--no-first-run", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", f"--user-data-dir={profile}",
             f"http://127.0.0.1:{server.server_port}/peers/{page}"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            end = time.monotonic() + TIMEOUT_S
            while not run.ended.wait(0.1) and browser.poll() is None and time.monotonic() < end:
                pass
        finally:
            browser.terminate()
            browser.wait()
            server.shutdown()
            server.server_close()
    if run.fault or not run.ended.is_set():
        raise RuntimeError(f"{page}: {run.fault or 'Chromium ended, or took too long'}")
    return run.ms
