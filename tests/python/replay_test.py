"""Replays in Python have the frames and the tables of the command."""

import math
import pathlib
import tempfile
import unittest
import warnings

import numpy as np

import foci

DISTANCE_M = 2.0
STUDY = """
[scene]
file = "wall.ply"
[[scene.object]]
name = "left"
center_m = [-1, 0, -2]
size_m = [2, 4, 1]
[eye]
position_m = [0, 0, 0]
look_at_m = [0, 0, -1]
[output]
fps = 10
size_px = [96, 54]
[gaze]
source = "gaze.tsv"
"""


class ReplayTest(unittest.TestCase):
    """A wall across the line of sight; a second on its left, a second on its right."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        side = np.linspace(-2, 2, 81)
        points = "".join(f"{x:.3f} {y:.3f} {-DISTANCE_M}\n" for x in side for y in side)
        (self.folder / "wall.ply").write_text(
            "ply\nformat ascii 1.0\nelement vertex 6561\nproperty float x\nproperty float y\nproperty float z\n"
            "end_header\n" + points)
        (self.folder / "gaze.tsv").write_text("time_s\tx_px\ty_px\n" + "".join(
            f"{i / 250:.3f}\t{460 if i < 250 else 1460}\t{540 + i % 2}\n" for i in range(500)))
        (self.folder / "study.toml").write_text(STUDY)

    def study(self, **options):
        return foci.Study(self.folder / "study.toml", **options)

    def test_frames_come_one_at_a_time(self):
        replay = self.study().replay(depth=True)
        images = list(replay)
        self.assertEqual(len(images), len(replay))
        self.assertEqual(images[0].rgb.shape, (54, 96, 3))
        self.assertTrue(all(a.time_s < b.time_s for a, b in zip(images, images[1:])))
        self.assertIsNot(images[0].rgb.base, images[1].rgb.base)
        np.testing.assert_allclose(images[3].depth_m[27, 48], DISTANCE_M, rtol=0.01)
        again = [image.rgb for image in replay]
        self.assertTrue(all(np.array_equal(a.rgb, b) for a, b in zip(images, again)))
        self.assertAlmostEqual(images[-1].focus_D, 1 / images[-1].surface_distance_m, delta=0.05)

    def test_tables_have_the_point_object_and_distance(self):
        replay = self.study().replay()
        looks = replay.fixations()
        self.assertEqual(looks["object"].tolist(), ["left", "n/a"])
        x_m = [(px - 960) * 0.5313 / 1920 / 0.6 * DISTANCE_M for px in (460, 1460)]
        np.testing.assert_allclose(looks["point_x_m"], x_m, atol=0.01)
        np.testing.assert_allclose(looks["distance_m"], [math.hypot(x, DISTANCE_M) for x in x_m], rtol=0.01)
        self.assertEqual(looks["recording"].tolist(), ["gaze", "gaze"])
        self.assertTrue(np.isnan(looks["saccade_amplitude_deg"][0]))
        self.assertEqual(replay.saccades()[["from_object", "to_object"]].tolist(), [("left", "n/a")])
        self.assertEqual(len(replay.gaze3d()), 500)
        self.assertEqual(replay.objects()["object"].tolist(), ["left"])
        self.assertAlmostEqual(replay.objects()["dwell_s"][0], 1.0, delta=0.02)
        self.assertEqual(replay.events()["event"][0], "fixation")

    def test_keys_are_set_and_read(self):
        study = self.study(set={"focus.fixed_D": 2, "output.view": "mono", "output.seconds": (0, 1)})
        self.assertEqual((study.keys["focus.fixed_D"], study.keys["output.seconds"]), (2, [0, 1]))
        self.assertEqual(len(study.replay()), 10)
        study.save(self.folder / "saved.toml")
        self.assertEqual(foci.Study(self.folder / "saved.toml").keys["focus.fixed_D"], 2)
        with self.assertRaisesRegex(foci.InputError, "focus.fixed_D"):
            self.study(set={"focus.fixed_D": "near"})
        with self.assertRaisesRegex(foci.InputError, "absent.toml"):
            foci.Study("absent.toml")

    def test_a_scene_is_framed(self):
        study = foci.Study(self.folder / "wall.ply", trace=str(self.folder / "gaze.tsv"))
        self.assertNotEqual(study.framing, "")
        self.assertTrue(next(iter(study.replay())).rgb.any())

    def test_a_black_image_warns(self):
        with self.assertWarnsRegex(UserWarning, "nothing is in view"):
            replay = self.study(set={"eye.look_at_m": [0, 0, 1]}).replay()
        self.assertIn("nothing is in view", replay.warnings[0])
        scene = foci.Scene.open(self.folder / "wall.ply")
        with self.assertWarnsRegex(UserWarning, "nothing is in view"):
            foci.render(scene, foci.Eye(look_at_m=(0, 0, 1)), size_px=(32, 18))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            foci.render(scene, foci.Eye(), size_px=(32, 18))


if __name__ == "__main__":
    unittest.main()
