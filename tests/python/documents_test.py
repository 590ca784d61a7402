"""Every Python example of the documents runs, in the order of its page.

    PYTHONPATH=build/python/python python3 -m unittest discover -s tests/python -p "*_test.py"
"""

import importlib.util
import os
import pathlib
import re
import shlex
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import types
import unittest
from unittest import mock

import numpy as np

import foci

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S)


def write_inputs(folder):
    """What the page's examples name: a square of points at the origin, and a recording of two fixations."""
    side = [0.05 * i - 0.5 for i in range(21)]
    (folder / "lion.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 441\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        + "".join(f"{x:.2f} {y:.2f} 0\n" for x in side for y in side))
    (folder / "gaze.asc").write_text("time_s\tx_px\ty_px\n" + "".join(
        f"{0.004 * i:.3f}\t{300 if i < 250 else 700}\t{400 + i % 2}\n" for i in range(500)))


class DocumentsTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        self.folder = pathlib.Path(temporary.name)
        os.chdir(self.folder)

    def run_page(self, page, names):
        for number, code in enumerate(blocks(page), 1):
            exec(compile(code, f"{page.name}, example {number}", "exec"), names)

    def test_no_page_has_examples_that_are_not_run(self):
        self.assertEqual({page.name: len(blocks(page)) for page in PAGES if blocks(page)},
                         {"python.md": 5, "experiments.md": 2})

    @unittest.skipUnless(importlib.util.find_spec("pandas"), "pandas is not installed")
    def test_python_md(self):
        write_inputs(self.folder)
        for name in ("study.toml", "scan.ply", "gaze.tsv"):
            shutil.copy(ROOT / "configs/sample" / name, self.folder)
        t = 0.004 * np.arange(500)
        x, y = np.where(t < 1.0, 500.0, 1400.0), np.full(500, 540.0)
        target = np.array([(a, b) for a in (300.0, 960.0, 1600.0) for b in (200.0, 540.0, 900.0)])
        names = {"t": t, "x": x, "y": y, "gaze": target + 20.0, "target": target, "now_s": 2.0,
                 "next_t": t + 2.004, "next_x": x, "next_y": y}
        with mock.patch("builtins.print"):
            self.run_page(ROOT / "docs/python.md", names)
        self.assertEqual((self.folder / "lion.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(names["fixations"]["x_px"].round().tolist(), [500.0, 1400.0])
        self.assertEqual(list(names["table"]["event"]).count("fixation"), 2)
        # 20 px of the map's screen, 0.5313 m over 1920 px at 0.6 m, as an angle on the recording's screen.
        offset_px = 20 * 0.5313 / 1920 / 0.6 * 0.67 / (0.38 / 1024)
        np.testing.assert_allclose(names["mapped"].x[0], 300.0 - offset_px, atol=0.05)
        self.assertEqual(len(names["states"]), 500)
        self.assertEqual(names["frame"].shape, (180, 320, 3))
        self.assertGreater(len(names["looks"]), 3)

    def test_commands_of_python_md(self):
        """The one-liners; the other commands build, or run what examples_test.py runs."""
        lines = re.findall(r"^    PYTHONPATH=\S+ python3 (-c .*)$", (ROOT / "docs/python.md").read_text(), re.M)
        self.assertEqual(len(lines), 1)
        run = subprocess.run([sys.executable, *shlex.split(lines[0])], capture_output=True, text=True, timeout=60)
        self.assertEqual((run.returncode, run.stdout.strip()), (0, str(foci.methods())), run.stderr)

    def test_experiments_md(self):
        """Against modules as the makers of the trackers document them, and a socket in foci's place."""
        heard = []

        def answer(server):
            while heard[-1:] != ["end"]:
                text, sender = server.recvfrom(4096)
                heard.append(text.decode())
                server.sendto(f"ok {text.count(b';') + 1}".encode(), sender)

        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
            server.bind(("127.0.0.1", 0))
            server.settimeout(30)
            thread = threading.Thread(target=answer, args=(server,))
            thread.start()
            self.run_trackers(server.getsockname()[1], heard)
            thread.join()
        self.assertEqual(heard[:-1], ["gaze 1.500000 10 20;1.502000 nan nan", "gaze 2.000000 960 540 3.5"])

    def run_trackers(self, port, heard):
        sample = types.SimpleNamespace
        words = [sample(getTime=lambda ms=ms: ms, getRightEye=lambda: None,
                        getLeftEye=lambda gaze=gaze: sample(getGaze=lambda: gaze))
                 for ms, gaze in ((1500, (10, 20)), (1500, (10, 20)), (1502, (-32768, -32768)))]
        eyelink = mock.Mock()
        eyelink.getNextData.side_effect = [200, 200, 200, 5, 0]
        eyelink.getFloatData.side_effect = words
        tobii = mock.Mock()
        tobii.find_all_eyetrackers.return_value = [tracker := mock.Mock()]
        modules = {"pylink": mock.Mock(SAMPLE_TYPE=200, MISSING_DATA=-32768, getEYELINK=lambda: eyelink),
                   "tobii_research": tobii}
        with mock.patch.dict(sys.modules, modules), mock.patch.object(sys, "path", [str(ROOT / "docs"), *sys.path]):
            for code in blocks(ROOT / "docs/experiments.md"):
                names = {}
                exec(code.replace("Foci(5005)", f"Foci({port})"), names)
                if tracker.subscribe_to.called:
                    take = tracker.subscribe_to.call_args.args[1]
                    take({"right_gaze_point_on_display_area": (0.5, 0.5), "device_time_stamp": 2e6,
                          "right_pupil_diameter": 3.5})
                names["push_new"]()
                if len(heard) == 2:
                    names["foci"].ask("end")
                names["foci"].socket.close()


if __name__ == "__main__":
    unittest.main()
