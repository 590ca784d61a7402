"""The scripts of examples/python and docs/experiment.py, run as a user would run them.

    PYTHONPATH=build/python/python python3 -m unittest discover -s tests/python -p "*_test.py"
"""

import importlib.util
import os
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
# A window of its own would take the mouse for gaze.
WITHOUT_DISPLAY = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


def write_scene(file):
    """Two upright squares, the left one in front."""
    points = [(x + left, y, depth) for left, depth in ((-0.5, 0.5), (0.5, -0.5))
              for x in [0.05 * i - 0.45 for i in range(19)] for y in [0.05 * i - 0.45 for i in range(19)]]
    properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    rows = "".join(f"{x:.3f} {y:.3f} {z} 0 0 1\n" for x, y, z in points)
    file.write_text(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n{properties}end_header\n{rows}")


def write_recording(file):
    """Two fixations with a saccade between them, 250 Hz."""
    rows = "".join(f"{0.004 * i:.3f}\t{500 if i < 250 else 1400}\t{500 + i % 2}\n" for i in range(500))
    file.write_text("time_s\tx_px\ty_px\n" + rows)


class ExamplesTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.scene = self.folder / "scene.ply"
        write_scene(self.scene)

    def run_script(self, script, *words):
        return subprocess.run([sys.executable, ROOT / script, *map(str, words)], cwd=self.folder, env=WITHOUT_DISPLAY,
                              capture_output=True, text=True, timeout=60)

    def refuses(self, expected, script, *words):
        """One line that says what is wrong."""
        run = self.run_script(script, *words)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
        self.assertIn(expected, run.stderr)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_figure_writes_an_image(self):
        run = self.run_script("examples/python/figure.py", self.scene, 0.3, "out.png")
        self.assertEqual(run.returncode, 0, run.stderr)
        image = (self.folder / "out.png").read_bytes()
        self.assertEqual(image[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">2I", image[16:24]), (1200, 672))

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_figure_refuses_with_one_line(self):
        script = "examples/python/figure.py"
        self.refuses("usage: python3 examples/python/figure.py SCENE", script)
        self.refuses("nothing.ply: no such file", script, "nothing.ply", 0.3, "out.png")
        self.refuses("DISTANCE_M = near", script, self.scene, "near", "out.png")
        self.refuses("DISTANCE_M = -1", script, self.scene, -1, "out.png")
        self.refuses("UP = up", script, self.scene, 0.3, "out.png", "up")
        self.refuses("missing/out.png", script, self.scene, 0.3, "missing/out.png")
        self.refuses("foo", script, self.scene, 0.3, "out.foo")

    def test_the_view_fills_the_screen_from_every_side(self):
        code = ("import sys; sys.path.insert(0, sys.argv[1]); import foci, numpy as np; from view import view\n"
                "for up in ('x', '-x', 'y', '-y', 'z', '-z'):\n"
                "    scene, eye = view(sys.argv[2], 0.3, up, foci.Screen())\n"
                "    seen = foci.render(scene, eye, size_px=(320, 180), method='pinhole').depth_m > 0\n"
                "    inside = seen[1:-1, 1:-1].sum() == seen.sum()\n"
                "    print(up, inside, seen.any(axis=0).mean() > 0.5 or seen.any(axis=1).mean() > 0.5)\n")
        cube = self.folder / "cube.ply"
        side = [-0.5 + i / 50 for i in range(51)]
        points = [(a, b, c) for a in side for b in side for c in side if max(abs(a), abs(b), abs(c)) == 0.5]
        cube.write_text(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
                        "property float z\nend_header\n" + "".join(f"{a:.3f} {b:.3f} {c:.3f}\n" for a, b, c in points))
        run = subprocess.run([sys.executable, "-c", code, ROOT / "examples/python", cube], capture_output=True, text=True,
                             timeout=60)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(run.stdout.split(), [word for up in ("x", "-x", "y", "-y", "z", "-z")
                                              for word in (up, "True", "True")])

    def test_gaze_contingent_runs_without_a_display(self):
        run = self.run_script("examples/python/gaze_contingent.py", self.scene, 0.3, 0.5)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("headless: ", run.stdout)
        self.assertRegex(run.stdout, r"[1-9]\d* frames in 0\.\d s; at the end \w+, focus \d")

    def test_gaze_contingent_refuses_with_one_line(self):
        script = "examples/python/gaze_contingent.py"
        self.refuses("usage: python3 examples/python/gaze_contingent.py SCENE", script)
        self.refuses("nothing.ply: no such file", script, "nothing.ply", 0.3)
        self.refuses("SECONDS = 0", script, self.scene, 0.3, 0)

    def test_folder_lists_recordings_of_subfolders(self):
        (self.folder / "data/deeper").mkdir(parents=True)
        write_recording(self.folder / "data/one.tsv")
        write_recording(self.folder / "data/deeper/two.tsv")
        (self.folder / "data/notes.txt").write_text("no recording\n")
        run = self.run_script("examples/python/folder.py", "data", "table.tsv")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertRegex(run.stderr, r"^left out: data/notes\.txt.*\n$")
        rows = [line.split("\t") for line in (self.folder / "table.tsv").read_text().splitlines()]
        self.assertEqual([row[:4] for row in rows[1:]], [["deeper/two.tsv", "500", "250", "2"],
                                                         ["one.tsv", "500", "250", "2"]])

    def test_folder_refuses_with_one_line(self):
        script = "examples/python/folder.py"
        (self.folder / "empty").mkdir()
        self.refuses("usage: ", script)
        self.refuses("nowhere: is not a folder", script, "nowhere", "table.tsv")
        self.refuses("empty: no recording that foci reads", script, "empty", "table.tsv")
        self.refuses("missing: is not a folder", script, "empty", "missing/table.tsv")

    def test_experiment_refuses_with_one_line(self):
        script = "docs/experiment.py"
        self.refuses("usage: ", script)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as foci:
            foci.bind(("127.0.0.1", 0))
            port = foci.getsockname()[1]

            def answer():
                foci.sendto(b"error a record is running", foci.recvfrom(4096)[1])

            thread = threading.Thread(target=answer)
            thread.start()
            self.refuses("foci answers: error a record is running", script, port)
            thread.join()
        self.refuses("no answer at port", script, port)


if __name__ == "__main__":
    unittest.main()
