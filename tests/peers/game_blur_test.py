#!/usr/bin/env python3
"""Closed forms of game_blur.py. Needs python3-opencv; skipped without."""

import sys
import unittest

try:
    import numpy as np
    import game_blur
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

LENS = {"focus_m": 1.0, "blur_radius_px_per_D": 8.0}
SHAPE = (80, 80)


def plane(value):
    return np.full(SHAPE, value, np.float32)


def colored(grey):
    return np.repeat(grey[..., None], 3, axis=2).astype(np.float32)


class GameBlur(unittest.TestCase):
    def test_one_colour_stays(self):
        """At any depth, also across a step."""
        depth = plane(1.0)
        depth[:, 40:] = 4.0
        depth[:20] = 0.5
        depth[60:] = 0.0
        image = game_blur.blurred(colored(plane(0.3)), depth, LENS)
        np.testing.assert_allclose(image, 0.3, atol=1e-5)

    def test_what_is_in_focus_stays(self):
        noise = np.random.default_rng(1).random(SHAPE).astype(np.float32)
        depth = plane(1.0)
        depth[0, 0] = 0.4  # so that the gather has a radius
        image = game_blur.blurred(colored(noise), depth, LENS)
        np.testing.assert_allclose(image[30:, 30:], colored(noise)[30:, 30:], atol=1e-5)

    def test_an_edge_becomes_the_integral_of_a_disc(self):
        """Behind and before the focus: a half-plane of light of one depth, blurred by 8 px."""
        light = plane(0.0)
        light[:, 40:] = 1.0
        for depth in (plane(0.0), plane(0.5)):
            row = game_blur.blurred(colored(light), depth, LENS)[40, :, 0]
            x = np.clip((np.arange(80) - 39.5) / 8.0, -1.0, 1.0)
            expected = 0.5 + (x * np.sqrt(1.0 - x**2) + np.arcsin(x)) / np.pi
            self.assertLess(np.abs(row - expected).max(), 0.06)  # of 96 taps

    def test_a_blurred_background_does_not_leak_over_the_focus(self):
        light, depth = plane(1.0), plane(0.0)
        light[:, :40], depth[:, :40] = 0.0, 1.0
        image = game_blur.blurred(colored(light), depth, LENS)
        self.assertLess(image[40, :39, 0].max(), 1e-3)

    def test_a_near_edge_spreads_over_the_focus(self):
        light, depth = plane(0.0), plane(1.0)
        light[:, :40], depth[:, :40] = 1.0, 0.5
        row = game_blur.blurred(colored(light), depth, LENS)[40, :, 0]
        self.assertGreater(row[43], 0.1)
        self.assertLess(row[50], 1e-3)


if __name__ == "__main__":
    unittest.main()
