"""Plays an observer whose tracker is off by a known map through `foci calibrate gaze`.

    calibrate_gaze_test.py FOCI OUT_FOLDER
"""

import json
import os
import random
import re
import sys
import time

from observer import Observer, emptied

SPEED = 3  # of the program's clock: a target takes 0.6 s
TARGETS = 9  # and 4 for validation


def tracked(x, y):
    """Where a tracker that is not calibrated sees the gaze: scaled, sheared and moved, with noise."""
    random_px = lambda: random.gauss(0.0, 4.0)
    return (640 + 0.93 * (x - 640) + 0.04 * (y - 360) + 25 + random_px(),
            360 - 0.03 * (x - 640) + 0.96 * (y - 360) - 18 + random_px())


def leave(foci, out):
    """A run that is left with the escape key writes nothing."""
    observer = Observer()
    try:
        program = observer.start(foci, "calibrate", "gaze", "--window", "--out", out + "/left.toml")
        observer.wait_for_window()
        while program.poll() is None:
            observer.press("space")
            observer.press("Escape")
        assert program.returncode == 0, program.stderr.read()
        assert not os.path.exists(out + "/left.toml")
    finally:
        observer.close()


def main():
    foci, out = sys.argv[1], emptied(sys.argv[2] + "/gaze")
    random.seed(1)
    leave(foci, out)
    observer = Observer()
    try:
        program = observer.start(foci, "calibrate", "gaze", "--window", "--targets", TARGETS,
                                 "--out", out + "/map.toml", "--json", speed=SPEED)
        observer.wait_for_window()
        observer.look(640, 360)
        time.sleep(0.3)
        observer.screenshot(out + "/gaze-welcome.png")
        observer.press("space")
        os.set_blocking(program.stderr.fileno(), False)
        at, shots, text, begin = None, 0, "", time.time()
        while time.time() - begin < 90:
            try:
                text += os.read(program.stderr.fileno(), 65536).decode()
            except BlockingIOError:
                pass
            if "result" in text:
                break
            targets = re.findall(r"at (-?\d+),(-?\d+) px\n", text)
            if not targets:
                observer.press("space")  # until the window takes it
            if targets and targets[-1] != at:
                at = targets[-1]
                shots += 1
            if at:
                observer.look(*tracked(float(at[0]), float(at[1])))
            if shots == 3:
                observer.screenshot(out + "/gaze-target.png")
                shots += 1
            time.sleep(0.01)
        assert "result" in text, text
        time.sleep(0.2)
        observer.screenshot(out + "/gaze-result.png")
        observer.press("space")
        assert program.wait(timeout=10) == 0
        result = json.loads(program.stdout.read())
        print({k: result[k] for k in ("model", "accuracy_deg", "accuracy_max_deg", "grade", "lost")})
        assert result["validated"] and result["grade"] == "good", result
        assert os.path.exists(out + "/map.toml") and os.path.exists(out + "/map.html")
    finally:
        observer.close()


if __name__ == "__main__":
    main()
