"""Plays an observer with a bank card and a blind spot through `foci calibrate screen`.

    calibrate_screen_test.py FOCI OUT_FOLDER
"""

import json
import math
import os
import sys
import time

from observer import Observer, emptied

CARD_PX = 342            # 3995 px/m
DISTANCE_M = 0.4
SPEED = 2                # of the program's clock
INATTENTIVE = 1.25       # times the offset: farther off than the runs that foci keeps
DOT_SPEED_M_PER_S = 0.03 * SPEED
REACTION_S = 0.05        # from the dot on the display to the key in the program
CROSS_PX = (1152, 396)   # where foci draws it in a window of 1280 x 720
PX_PER_M = CARD_PX / 0.0856


def wait_for_dot(observer, x_px, outwards):
    """Returns once the red dot, which moves left where it moves outwards, has reached this column."""
    begin = time.time()
    while time.time() - begin < 20:
        row = observer.pixels(CROSS_PX[1])[2][0]
        red = [x for x in range(len(row) // 3) if row[3 * x] > 150 and row[3 * x + 1] < 80]
        if red and (sum(red) / len(red) <= x_px) == outwards:
            return
    raise AssertionError("the dot did not come")


def main():
    foci, out = sys.argv[1], emptied(sys.argv[2] + "/screen")
    observer = Observer()
    try:
        program = observer.start(foci, "calibrate", "screen", "--window", "--json",
                                 "--out", out + "/screen.toml", "--psychopy", out + "/screen.json",
                                 speed=SPEED)
        log = lambda: program.stderr.readline()
        observer.wait_for_window()
        observer.look(700, 600)
        observer.click(60 + CARD_PX - 3, 300)
        observer.press("Right", 3)
        time.sleep(0.3)
        observer.screenshot(out + "/screen-card.png")
        observer.press("space")
        assert "distance" in log()
        observer.screenshot(out + "/screen-distance.png")
        observer.press("b")
        assert "blind spot" in log()

        spot_m = DISTANCE_M * math.tan(math.radians(13.5))
        for run in range(6):
            observer.press("space")
            assert log().startswith("run")
            # The third time the observer was not attentive.
            at_m = spot_m * (INATTENTIVE if run == 2 else 1.0)
            lead_m = REACTION_S * DOT_SPEED_M_PER_S * (1 if run % 2 == 0 else -1)
            wait_for_dot(observer, CROSS_PX[0] - PX_PER_M * (at_m - lead_m), outwards=run % 2 == 0)
            observer.press("space")
            if run == 0:
                observer.screenshot(out + "/screen-blind-spot.png")
            time.sleep(0.1)
        assert "gamma" in log()
        observer.press("Left", 5)
        time.sleep(0.3)
        observer.screenshot(out + "/screen-gamma.png")
        observer.press("s")
        assert "result" in log()
        time.sleep(0.3)
        observer.screenshot(out + "/screen-result.png")
        observer.press("space")
        assert program.wait(timeout=10) == 0
        result = json.loads(program.stdout.read())
        print(result)
        assert abs(result["px_per_m"][0] * 0.0856 - CARD_PX) <= 2, result
        assert abs(result["distance_m"] / DISTANCE_M - 1) < 0.05, result
        assert result["gamma"] == "sRGB" and "1 refused" in result["distance_from"], result
        assert os.path.exists(out + "/screen.toml") and os.path.exists(out + "/screen.json")
    finally:
        observer.close()


if __name__ == "__main__":
    main()
