"""Plays an observer with a bank card and a blind spot through `foci calibrate screen`.

    calibrate_screen_test.py FOCI OUT_FOLDER
"""

import json
import math
import os
import sys
import time

from observer import Observer

CARD_PX = 342            # 3995 px/m
DISTANCE_M = 0.55
DOT_SPEED_M_PER_S = 0.03  # the program's own, and where its dot sets out
DOT_START_M = 0.04
INSIDE = 1.2


def main():
    foci, out = sys.argv[1], sys.argv[2]
    os.makedirs(out, exist_ok=True)
    observer = Observer()
    try:
        program = observer.start(foci, "calibrate", "screen", "--window", "--json",
                                 "--out", out + "/screen.toml", "--psychopy", out + "/screen.json")
        log = lambda: program.stderr.readline()
        time.sleep(2.0)
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
        last_m = 0.0
        for run in range(6):
            observer.press("space")
            assert log().startswith("run")
            begin = time.time()
            # The third time the observer was not attentive.
            at_m = spot_m * (1.5 if run == 2 else 1.0)
            way_m = at_m - DOT_START_M if run % 2 == 0 else INSIDE * last_m - at_m
            time.sleep(way_m / DOT_SPEED_M_PER_S - (time.time() - begin) - 0.05)
            if run == 0:
                observer.screenshot(out + "/screen-blind-spot.png")
            observer.press("space")
            last_m = at_m
            time.sleep(0.3)
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
