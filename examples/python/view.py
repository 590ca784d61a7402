"""What figure.py and gaze_contingent.py share: a view of any scene, and errors in one line."""

import inspect
import math
import pathlib
import sys

import foci


def view(path, distance_m, up, screen, pupil_mm=6):
    """The scene in front of an eye, DISTANCE_M from its middle and as large as the screen allows.

    up: the scene's upward axis, x, y or z, or -x, -y or -z. The front is the side that `foci render --up` shows.
    """
    if up.lstrip("-") not in ("x", "y", "z") or len(up) > 2:
        raise foci.InputError(f"UP = {up}: expected x, y, z, -x, -y or -z")
    if not 0.05 <= distance_m <= 100:
        raise foci.InputError(f"DISTANCE_M = {distance_m}: expected 0.05 to 100")
    sign, axis = (-1 if up[0] == "-" else 1), "xyz".index(up[-1])
    depth_axis = 1 if axis == 2 else 2
    width_axis = 3 - axis - depth_axis

    # The face of the scene's box that is next to the eye fills nine tenths of the screen.
    low, high = foci.Scene.open(path).bounds_m
    half = [max((b - a) / 2, 1e-9) for a, b in zip(low, high)]
    needed = max(half[side] / (screen.size_m[k] / 2 / screen.distance_m) for k, side in enumerate((width_axis, axis)))
    scene = foci.Scene.open(path, scale_m=0.9 * distance_m / (needed + half[depth_axis]))

    middle = [(a + b) / 2 for a, b in zip(*scene.bounds_m)]
    position = list(middle)
    position[depth_axis] += distance_m * (-sign if axis == 2 else sign)
    upwards = [sign if k == axis else 0 for k in range(3)]
    return scene, foci.Eye(pupil_mm=pupil_mm, position_m=position, look_at_m=middle, up=upwards)


def number(name, text):
    """A number of the command line."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise foci.InputError(f"{name} = {text}: expected a number")
    return value


def run(main, doc):
    """Calls main with the words of the command line. Bad input ends the program with one line."""
    words, parameters = sys.argv[1:], inspect.signature(main).parameters.values()
    required = sum(parameter.default is parameter.empty for parameter in parameters)
    try:
        if not required <= len(words) <= len(parameters):
            raise foci.InputError("usage: " + next(line.strip() for line in doc.splitlines() if "python3 " in line))
        main(*words)
    except (ValueError, ImportError, OSError) as error:  # InputError is a ValueError
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {error}")
