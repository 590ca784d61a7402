"""Calibrates a webcam in the window of `foci calibrate gaze`: the camera is a film, played in real time, of
an observer who looks at the targets; then the same film is replayed through the map. Both trackers do this, the
networks where they are installed.

    calibrate_webcam_test.py FOCI OUT_FOLDER FOCI_FILM
"""

import csv
import json
import math
import os
import subprocess
import sys
import time

from observer import Observer, emptied

WIDTH_M, HEIGHT_M, DISTANCE_M = 0.52, 0.2925, 0.55
LEAD_S, EACH_S = 1.5, 2.2
TARGETS, VALIDATION_TARGETS, SEED = 9, 4, 3
RATE_HZ = 10  # of the film
LOOK_S = 0.5  # of each target, for the saccade to it
LIMIT_DEG = 1.5


def table(path):
    with open(path) as file:
        return list(csv.DictReader(file, delimiter="\t"))


def wait_for(program, word, seconds):
    text, begin = "", time.time()
    while word not in text and time.time() - begin < seconds:
        try:
            text += os.read(program.stderr.fileno(), 65536).decode()
        except BlockingIOError:
            time.sleep(0.01)
    assert word in text, text
    return text


def main():
    foci, out, film = sys.argv[1], emptied(sys.argv[2] + "/webcam"), sys.argv[3]
    shown = subprocess.run(
        [film, "eyes.mp4", str(TARGETS), str(SEED), str(WIDTH_M), str(HEIGHT_M), str(DISTANCE_M),
         str(LEAD_S), str(EACH_S)], cwd=out, check=True, capture_output=True, text=True).stdout
    with open(out + "/shown.tsv", "w") as file:
        file.write(shown)
    doctor = subprocess.run([foci, "doctor", "--json"], check=True, capture_output=True).stdout
    if json.loads(doctor)["webcam_models"]["missing"]:
        print("without networks, which are not installed: sh app/webcam_models.sh")
    else:
        calibrate_and_replay(foci, emptied(out + "/networks"), out)
    os.environ["XDG_DATA_HOME"] = out  # no models are there
    calibrate_and_replay(foci, emptied(out + "/cascades"), out)


def calibrate_and_replay(foci, out, films):
    subprocess.run(
        [foci, "calibrate", "screen", "--headless", "--size-px", "1280x720", "--size-m",
         f"{WIDTH_M}x{HEIGHT_M}", "--distance-m", str(DISTANCE_M), "--out", out + "/screen.toml"],
        check=True, capture_output=True)
    # The film and the clock run so slowly that no frame is dropped, however busy the machine is.
    ms = json.loads(subprocess.run([foci, "webcam", films + "/eyes.mp4", "--json"], check=True,
                                   capture_output=True).stdout)["ms_95"]
    speed = max(0.2, min(1.0, 500.0 / RATE_HZ / ms))
    observer = Observer()
    try:
        program = observer.start(
            foci, "calibrate", "gaze", "--window", "--source", f"webcam:{films}/eyes.mp4", "--targets",
            TARGETS, "--seed", SEED, "--manual", "--screen", out + "/screen.toml", "--out",
            out + "/map.toml", "--json", speed=speed)
        os.set_blocking(program.stderr.fileno(), False)
        wait_for(program, "first frame", 20)
        begin = time.time()
        until = lambda film_s: time.sleep(max(begin + film_s / speed - time.time(), 0.0))
        until(0.5)
        observer.screenshot(out + "/welcome.png")
        until(LEAD_S)
        observer.press("space")
        for target in range(TARGETS + VALIDATION_TARGETS):
            until(LEAD_S + EACH_S * target + 1.1)
            observer.press("space")
            if target == 4:
                observer.screenshot(out + "/target.png")
        wait_for(program, "result", 20)
        time.sleep(0.2)
        observer.screenshot(out + "/result.png")
        observer.press("space")
        assert program.wait(timeout=60) == 0
        result = json.loads(program.stdout.read())
        print({k: result[k] for k in ("model", "accuracy_deg", "accuracy_max_deg", "grade", "lost")})
        assert result["model"] == "webcam" and result["validated"], result
        assert result["accuracy_deg"] <= LIMIT_DEG, result
        assert os.path.exists(out + "/map.html")
    finally:
        observer.close()

    # The same film through the map, in another process.
    with open(out + "/study.toml", "w") as file:
        file.write('[scene]\nbuiltin = "plane"\n[output]\nsize_px = [64, 36]\nfps = 15\n')
    subprocess.run(
        [foci, "replay", "study.toml", "--trace", f"webcam:{films}/eyes.mp4", "--gaze-map", "map.toml",
         "--screen", "screen.toml", "--out", "out"], cwd=out, check=True, capture_output=True)
    errors = []
    targets = table(films + "/shown.tsv")
    for row in table(out + "/out/frames.tsv"):
        for target in targets:
            since = float(row["time_s"]) - float(target["onset_s"])
            if LOOK_S <= since < float(target["duration_s"]) and row["gaze_x_px"] != "n/a":
                x = (float(row["gaze_x_px"]) / 1280 - 0.5) * WIDTH_M
                y = (0.5 - float(row["gaze_y_px"]) / 720) * HEIGHT_M
                errors.append(math.degrees(math.hypot(
                    x - float(target["x_target"]), y - float(target["y_target"])) / DISTANCE_M))
    accuracy = sum(errors) / len(errors)
    print("replayed:", len(errors), "frames,", round(accuracy, 2), "deg")
    assert len(errors) > 200 and accuracy <= LIMIT_DEG, (len(errors), accuracy)


if __name__ == "__main__":
    main()
