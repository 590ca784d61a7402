"""The Python module. Scenes are planes at known distances, so that focus, depth and blur have closed forms.

    PYTHONPATH=build/python/python python3 -m unittest discover -s tests/python -p "*_test.py"
"""

import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import foci

SIZE = (160, 90)
SCREEN = foci.Screen()


def plane(distance_m, half_m=1.0, points=61):
    """A grey square across the line of sight of an eye at the origin."""
    side = np.linspace(-half_m, half_m, points)
    x, y = np.meshgrid(side, side)
    position = np.stack([x.ravel(), y.ravel(), np.full(x.size, -distance_m)], axis=1)
    return foci.Scene.from_points(position, color=np.full(position.shape, 0.25), normal=np.tile((0, 0, 1), (x.size, 1)))


def fixations(rate_Hz=250.0, noise_px=1.0):
    """Half a second at (500, 500), a saccade of 40 ms, a second at (1400, 500)."""
    t = np.arange(0.0, 1.54, 1.0 / rate_Hz)
    x = np.interp(t, [0.5, 0.54], [500.0, 1400.0])
    noise = np.random.default_rng(1).normal(0.0, noise_px, (2, t.size))
    return t, x + noise[0], 500.0 + noise[1]


class NameTest(unittest.TestCase):
    def test_types_are_named_as_users_import_them(self):
        types = [getattr(foci, name) for name in foci.__all__ if isinstance(getattr(foci, name), type)]
        self.assertGreater(len(types), 8)
        self.assertEqual({each.__module__ for each in types}, {"foci"})

    def test_the_package_runs_as_a_command(self):
        """A wheel's command lies beside the module, and adds its commit; a module alone knows only its version."""
        def run(*words):
            return subprocess.run([sys.executable, "-m", "foci", *words], env={**os.environ, "PATH": ""},
                                  capture_output=True, text=True)

        self.assertRegex(run("--version").stdout, rf"^foci {re.escape(foci.__version__)}( \(.+\))?\n$")
        if not pathlib.Path(foci.__file__).with_name("foci").exists():
            self.assertIn("the command foci is not installed", run("methods").stderr)


class RenderTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = plane(1.0)
        cls.eye = foci.Eye(pupil_mm=4)

    def render(self, **options):
        return foci.render(self.scene, self.eye, SCREEN, size_px=SIZE, **options)

    def test_gives_linear_float_rgb_of_the_surface(self):
        image = np.asarray(self.render(focus_m=1.0))
        self.assertEqual((image.shape, image.dtype), ((90, 160, 3), np.float32))
        np.testing.assert_allclose(image[45, 80], 0.25, atol=0.01)

    def test_aberrations_blur_what_is_in_focus(self):
        typical = [0, 0, 0, 0, 0, 0, -0.11, 0.14, 0, 0, 0, 0, 0.13]
        eye = foci.Eye(pupil_mm=6, wavefront_um=[3 * um for um in typical], wavefront_pupil_mm=6)
        scene = foci.Scene.from_points(
            np.array([[x, y, -1.0] for x in np.linspace(-0.1, 0.1, 81) for y in np.linspace(-0.1, 0.1, 81)]),
            color=np.array([[x > 0] * 3 for x in np.linspace(-0.1, 0.1, 81) for _ in range(81)], dtype=float),
            normal=np.tile((0, 0, 1), (81 * 81, 1)))

        def contrast(of):
            image = np.asarray(foci.render(scene, of, SCREEN, size_px=(1920, 1080), focus_m=1.0, method="sweep:7"))
            return np.abs(np.diff(image[540, 900:1020, 1])).max()

        self.assertLess(contrast(eye), 0.9 * contrast(foci.Eye(pupil_mm=6)))
        with self.assertRaises(foci.InputError):
            foci.Eye(wavefront_um=typical)

    def test_arrays_share_the_memory_of_the_image_and_outlive_it(self):
        image = self.render(focus_m=1.0)
        rgb = np.asarray(image)
        self.assertTrue(np.shares_memory(rgb, image.rgba))
        self.assertFalse(rgb.flags.writeable)
        before = rgb.copy()
        del image
        for focus_m in (0.3, 0.5, 2.0, 5.0):
            self.render(focus_m=focus_m, background=(1, 0, 0))
        np.testing.assert_array_equal(rgb, before)

    def test_depth_is_the_distance_along_the_line_of_sight(self):
        depth = self.render(focus_m=1.0).depth_m
        x_m = (10.5 / SIZE[0] - 0.5) * SCREEN.size_m[0] / SCREEN.distance_m
        y_m = (45.5 / SIZE[1] - 0.5) * SCREEN.size_m[1] / SCREEN.distance_m
        self.assertAlmostEqual(depth[45, 80], 1.0, delta=2e-3)
        self.assertAlmostEqual(depth[45, 10], math.hypot(1.0, x_m, y_m), delta=2e-3)

    def test_defocus_is_the_difference_of_vergences(self):
        image = self.render(focus_m=0.5)
        self.assertAlmostEqual(image.focus_D, 2.0)
        self.assertAlmostEqual(image.defocus_D[45, 80], -1.0, delta=2e-3)
        # docs/formulas.md, section 1: C_px = (A/2) |1/U - 1/P| d_s R.
        px_per_m = SIZE[0] / SCREEN.size_m[0]
        self.assertAlmostEqual(image.blur_px[45, 80], 0.002 * 1.0 * SCREEN.distance_m * px_per_m, delta=2e-3)

    def test_maps_are_nan_where_there_is_no_surface(self):
        image = foci.render(plane(1.0, half_m=0.05), self.eye, SCREEN, size_px=SIZE)
        self.assertEqual(image.depth_m[2, 2], 0.0)
        self.assertTrue(np.isnan(image.defocus_D[2, 2]))

    def test_the_eye_focuses_the_surface_at_the_gaze(self):
        image = self.render(gaze_px=(960, 540))
        self.assertAlmostEqual(image.surface_distance_m, 1.0, delta=1e-3)
        self.assertAlmostEqual(image.focus_D, 1.0, delta=1e-3)

    def test_does_not_depend_on_earlier_images(self):
        first = np.array(self.render(focus_m=0.4))
        self.render(focus_m=3.0)
        foci.render(self.scene, foci.Eye(position_m=(0, 0, 0.2)), SCREEN, size_px=SIZE, focus_m=0.3)
        np.testing.assert_array_equal(np.asarray(self.render(focus_m=0.4)), first)

    def test_does_not_depend_on_the_number_of_threads(self):
        first = np.array(self.render(focus_m=0.4))
        foci.set_threads(1)
        try:
            np.testing.assert_array_equal(np.asarray(self.render(focus_m=0.4)), first)
        finally:
            foci.set_threads(64)

    def test_other_python_threads_run_meanwhile(self):
        """This thread notes the time while another renders: some notes lie in the middle of the render."""
        span, notes = [], []

        def render():
            start = time.perf_counter()
            try:
                foci.render(self.scene, self.eye, SCREEN, size_px=(1280, 720), focus_m=0.3, method="accumulate:32")
            finally:
                span.extend((start, time.perf_counter()))

        thread = threading.Thread(target=render)
        thread.start()
        while not span:
            notes.append(time.perf_counter())
            time.sleep(0)
        thread.join()
        length = span[1] - span[0]
        middle = [note for note in notes if 0.25 * length < note - span[0] < 0.75 * length]
        self.assertTrue(middle)

    def test_refuses_bad_arguments_with_one_line(self):
        cases = {
            "pupil_mm = 40": lambda: foci.Eye(pupil_mm=40),
            "Eye": lambda: foci.Eye(position_m=(0, 0, 0), look_at_m=(0, 1, 0)),
            "focus_m = 0": lambda: self.render(focus_m=0),
            "focus_m = nan": lambda: self.render(focus_m=math.nan),
            "give one of them": lambda: self.render(focus_m=1, gaze_px=(1, 1)),
            "gaze_px[0]": lambda: self.render(gaze_px=(-5, 1)),
            "method = sharp": lambda: self.render(method="sharp"),
            "size_px": lambda: foci.render(self.scene, self.eye, size_px=(4, 90)),
            "depth=True": lambda: self.render(depth=False).depth_m,
            "nowhere.ply": lambda: foci.Scene.open("nowhere.ply"),
            "expected (N, 3)": lambda: foci.Scene.from_points(np.zeros((4, 2))),
        }
        for words, call in cases.items():
            with self.subTest(words), self.assertRaises(foci.InputError) as caught:
                call()
            self.assertIn(words, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))
        self.assertTrue(issubclass(foci.InputError, ValueError))

    def test_saves_and_opens_files(self):
        with tempfile.TemporaryDirectory() as folder:
            png, ply = pathlib.Path(folder, "image.png"), pathlib.Path(folder, "points.ply")
            self.render().save(png)
            self.assertEqual(png.read_bytes()[1:4], b"PNG")
            ply.write_text("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                           "property float z\nend_header\n0 0 -1\n1 0 -1\n0 1 -1\n1 1 -1\n")
            self.assertEqual(len(foci.Scene.open(ply, scale_m=2.0)), 4)
            self.assertEqual(foci.Scene.open(ply, scale_m=2.0).bounds_m[1], (2.0, 2.0, -2.0))

    def test_a_lost_page_ends_the_program_unless_it_has_its_own_handler(self):
        with tempfile.TemporaryDirectory() as folder:
            ply = pathlib.Path(folder, "points.ply")
            ply.write_text("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                           "property float z\nend_header\n0 0 -1\n1 0 -1\n0 1 -1\n1 1 -1\n")

            def handles_bus_error(before):
                code = (f"import faulthandler, foci, os, signal\n{before}\nfoci.Scene.open({str(ply)!r})\n"
                        "caught = next(line for line in open('/proc/self/status') if line.startswith('SigCgt'))\n"
                        "print(int(caught.split()[1], 16) >> (signal.SIGBUS - 1) & 1)\n"
                        "os.kill(os.getpid(), signal.SIGBUS)\n")
                return subprocess.run([sys.executable, "-u", "-c", code], capture_output=True, text=True)

            foci_handles, own_handler = handles_bus_error(""), handles_bus_error("faulthandler.enable()")
            self.assertEqual((foci_handles.stdout, foci_handles.stderr), ("1\n", ""))
            self.assertEqual(foci_handles.returncode, -signal.SIGBUS)
            self.assertIn("Fatal Python error: Bus error", own_handler.stderr)


class GaussiansTest(unittest.TestCase):
    def test_a_capture_is_a_scene(self):
        # One opaque Gaussian, 0.1 m wide, a metre before the eye, as .splat: place, size, colour, rotation.
        record = np.array([0, 0, -1, 0.1, 0.1, 0.1], "<f4").tobytes() + bytes([255, 0, 0, 255, 255, 128, 128, 128])
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "one.splat"
            path.write_bytes(4 * record)
            scene = foci.Scene.open(path)
        self.assertEqual((len(scene), repr(scene)), (4, "<foci.Scene of 4 Gaussians>"))
        np.testing.assert_allclose(scene.bounds_m, [(0, 0, -1)] * 2)
        image = foci.render(scene, foci.Eye(), SCREEN, size_px=SIZE, focus_m=1.0)
        self.assertGreater(image.rgb[45, 80, 0], 0.9)
        with self.assertRaisesRegex(foci.InputError, "Gaussians"):
            foci.render(scene, foci.Eye(), SCREEN, size_px=SIZE, method="paper")


class EventsTest(unittest.TestCase):
    def test_finds_two_fixations_and_the_saccade_between_them(self):
        table = foci.events(*fixations())
        self.assertEqual([event for event in table["event"] if event != "pso"], ["fixation", "saccade", "fixation"])
        saccade = table[table["event"] == "saccade"][0]
        self.assertAlmostEqual(saccade["onset_s"], 0.5, delta=0.012)
        np.testing.assert_allclose(table["x_px"][table["event"] == "fixation"], (500, 1400), atol=2)
        self.assertTrue(np.isnan(table["amplitude_deg"][0]))

    def test_nan_is_data_loss(self):
        t, x, y = fixations()
        x[t > 1.0] = np.nan
        self.assertEqual(foci.events(t, x, y)["event"][-1], "lost")

    def test_labels_have_one_word_for_each_sample(self):
        recording = foci.Recording(*fixations())
        labels = recording.labels()
        self.assertEqual(labels.shape, recording.t.shape)
        self.assertEqual(labels[50], "fixation")
        self.assertEqual(recording.rate_Hz, 250.0)

    def test_gives_a_data_frame_where_pandas_is_there(self):
        try:
            import pandas
        except ImportError:
            with self.assertRaises(foci.InputError):
                foci.events(*fixations(), as_frame=True)
            return
        frame = foci.events(*fixations(), as_frame=True)
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(set(frame["event"]) - {"pso"}, {"fixation", "saccade"})

    def test_reads_a_recording_from_a_file(self):
        t, x, y = fixations()
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "gaze.tsv")
            np.savetxt(file, np.stack([t, x, y], axis=1), delimiter="\t", header="time_s\tx_px\ty_px", comments="")
            recording = foci.Recording.open(file, screen=SCREEN)
        np.testing.assert_allclose(recording.x, x)
        table, again = recording.events(), foci.events(recording.t, recording.x, recording.y)
        for field in table.dtype.names:
            np.testing.assert_array_equal(table[field], again[field])

    def test_says_what_it_assumed_about_a_file(self):
        t, x, y = fixations()
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "gaze.tsv")
            np.savetxt(file, np.stack([t, x, y], axis=1), delimiter="\t", header="time_s\tx\ty", comments="")
            unit, screen = foci.Recording.open(file).assumed
        self.assertEqual(unit, "unit of the positions: px (gaze.units)")
        self.assertRegex(screen, "^screen: .*since the recording does not state them$")

    def test_refuses_bad_samples(self):
        for arguments in [([0, 1, 1], [1, 2, 3], [1, 2, 3]), ([0, 1, 2], [1, 2], [1, 2, 3]),
                          ([0, 1, np.nan], [1, 2, 3], [1, 2, 3]), ([0, 1, 2], [np.nan] * 3, [1, 2, 3])]:
            with self.subTest(arguments), self.assertRaises(foci.InputError):
                foci.events(*arguments)


class CalibrationTest(unittest.TestCase):
    def setUp(self):
        grid = np.array([(x, y) for y in (108, 540, 972) for x in (192, 960, 1728)], float)
        self.target = np.repeat(grid, 20, axis=0)
        self.gaze = self.target + (30, -20)

    def test_a_fitted_map_undoes_an_offset(self):
        gaze_map = foci.GazeMap.fit(self.gaze, self.target)
        points, uncertainty_deg = gaze_map.apply(self.gaze)
        np.testing.assert_allclose(points, self.target, atol=1.0)
        self.assertEqual(uncertainty_deg.shape, (180,))
        self.assertLess(gaze_map.accuracy(self.gaze, self.target)["accuracy_deg"], 0.03)

    def test_data_loss_stays_data_loss(self):
        self.gaze[::7] = np.nan
        gaze_map = foci.GazeMap.fit(self.gaze, self.target)
        points, _ = gaze_map.apply(self.gaze)
        np.testing.assert_array_equal(np.isnan(points), np.isnan(self.gaze))

    def test_a_saved_map_is_the_same_map(self):
        gaze_map = foci.GazeMap.fit(self.gaze, self.target)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "map.toml")
            gaze_map.save(file)
            again = foci.GazeMap.open(file)
        for one, other in zip(again.apply(self.gaze), gaze_map.apply(self.gaze)):
            np.testing.assert_array_equal(one, other)

    def test_maps_a_recording(self):
        t, x, y = fixations()
        gaze_map = foci.GazeMap.fit(self.gaze, self.target)
        mapped = gaze_map.apply(foci.Recording(t, x + 30, y - 20))
        np.testing.assert_allclose(mapped.x, x, atol=1.0)

    def test_refuses_too_few_targets_and_unknown_units(self):
        with self.assertRaises(foci.InputError):
            foci.GazeMap.fit(self.gaze[:40], self.target[:40])
        with self.assertRaisesRegex(foci.InputError, "units = furlong"):
            foci.GazeMap.fit(self.gaze, self.target, units="furlong")


class DocumentationTest(unittest.TestCase):
    def test_every_public_name_has_a_docstring(self):
        names = [name for name in dir(foci) if not name.startswith("_")]
        self.assertIn("Session", names)
        for name in names:
            thing = getattr(foci, name)
            self.assertTrue(thing.__doc__, name)
            if isinstance(thing, type) and not issubclass(thing, Exception):
                for member in dir(thing):
                    if not member.startswith("_"):
                        self.assertTrue(getattr(thing, member).__doc__, f"{name}.{member}")


class SessionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = plane(0.5)

    def session(self, **options):
        return foci.Session(self.scene, foci.Eye(), SCREEN, rate_Hz=250, size_px=SIZE, **options)

    def test_focus_comes_to_the_surface_at_the_gaze(self):
        session = self.session()
        t = np.arange(0.0, 2.0, 0.004)
        session.push(t, np.full_like(t, 960.0), np.full_like(t, 540.0))
        state = session.state(2.0)
        self.assertEqual((state.state, state.gaze_px), ("fixation", (960.0, 540.0)))
        self.assertAlmostEqual(state.focus_D, 2.0, delta=0.01)
        self.assertAlmostEqual(session.frame(2.0).focus_D, state.focus_D)

    def test_single_samples_and_columns_give_the_same_states(self):
        t, x, y = fixations()
        one, many = self.session(), self.session()
        table = many.track(t, x, y)
        for i in range(t.size):
            one.push(t[i], x[i], y[i])
            state = one.state(t[i])
            self.assertEqual((state.state, state.focus_D), (table["state"][i], table["focus_D"][i]))

    def test_a_state_holds_the_surface_while_gaze_rests(self):
        session = self.session()
        t = np.arange(0.0, 1.0, 0.004)
        noise_px = np.random.default_rng(1).normal(0.0, 0.3, t.size)
        table = session.track(t, 1500.0 + noise_px, np.full_like(t, 540.0))
        distances_m = table["surface_distance_m"][100:]
        self.assertLess(np.unique(distances_m).size, 10)
        frame = session.frame(t[-1])
        self.assertAlmostEqual(1.0 / frame.surface_distance_m, 1.0 / distances_m[-1], delta=0.01)
        session.move(foci.Eye(position_m=(0, 0, 1), look_at_m=(0, 0, 0)))
        self.assertGreater(session.state(1.0).surface_distance_m, distances_m[-1] + 0.5)

    def test_an_eye_at_rest_gets_its_frame_again(self):
        session = self.session()
        t = np.arange(0.0, 3.0, 0.004)
        session.push(t, np.full_like(t, 960.0), np.full_like(t, 540.0))
        first, second = session.frame(3.0), session.frame(3.01)
        self.assertTrue(first.rendered)
        self.assertFalse(second.rendered)
        self.assertTrue(np.shares_memory(first.rgb, second.rgb))

    def test_the_recorded_pupil_is_followed(self):
        session = self.session(pupil="recording")
        session.push(0.0, 960, 540, pupil_mm=6.5)
        self.assertEqual(session.state(0.0).pupil_mm, 6.5)

    def test_time_does_not_run_back(self):
        session = self.session()
        session.push(1.0, 960, 540)
        for call in (lambda: session.push(1.0, 960, 540), lambda: session.state(0.5),
                     lambda: session.push(math.nan, 960, 540), lambda: session.push([2, 2], [9, 9], [9, 9]),
                     lambda: session.track([3, math.nan], [9, 9], [9, 9])):
            with self.assertRaises(foci.InputError):
                call()
        session.state(4.0)
        with self.assertRaises(foci.InputError):
            session.push(1.5, 960, 540)

    def test_the_eye_moves(self):
        session = self.session()
        session.push(0.0, 960, 540)
        far = np.array(session.frame(0.0))
        session.move(foci.Eye(position_m=(0, 0, 5), look_at_m=(0, 0, 0)))
        self.assertFalse(np.array_equal(far, np.asarray(session.frame(0.1))))

    def test_frames_equal_those_of_render_once_focus_rests(self):
        session = self.session()
        t = np.arange(0.0, 6.0, 0.004)
        session.push(t, np.full_like(t, 960.0), np.full_like(t, 540.0))
        frame = session.frame(6.0)
        image = foci.render(self.scene, foci.Eye(), SCREEN, size_px=SIZE, gaze_px=(960, 540))
        np.testing.assert_allclose(frame.rgb, image.rgb, atol=1e-3)


if __name__ == "__main__":
    unittest.main()
