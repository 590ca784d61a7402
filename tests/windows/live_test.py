"""An observer with a mouse, then one whose tracker dies, before `foci live`; and the replay of what was recorded.

    live_test.py FOCI OUT_FOLDER FOCI_FILM [FOCI_PUPIL]
"""

import json
import os
import shutil
import socket
import subprocess
import sys
import time

from observer import Observer

SIZE = (320, 180)
NEAR, FAR = (0.078, 0.648), (0.45, 0.22)  # of the image: a leaf before the eye, the image on the wall


class Experiment:
    """A script that drives foci, as docs/experiment.py does."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.settimeout(60)
        self.socket.connect(("127.0.0.1", port))

    def ask(self, command):
        self.socket.send(command.encode())
        return self.socket.recv(4096).decode().strip()

    def state(self):
        answer = self.ask("state")
        assert answer.startswith("ok {"), answer
        return json.loads(answer[3:])

    def until(self, holds, what):
        """The first state of which `holds` is true."""
        begin = time.time()
        while time.time() - begin < 60:
            state = self.state()
            if holds(state):
                return state
            time.sleep(0.05)
        raise AssertionError(f"never {what}: {self.state()}")


def table(path):
    with open(path) as file:
        return [line.rstrip("\n").split("\t") for line in file]


def sharpness(rows, centre):
    """How much neighbouring pixels differ around a point: more where the image is in focus."""
    x0, y0 = (int(centre[i] * SIZE[i]) for i in (0, 1))
    total = 0
    for y in range(y0 - 14, y0 + 14):
        for x in range(x0 - 20, x0 + 20):
            total += abs(rows[y][3 * x + 1] - rows[y][3 * x + 4])
    return total


def start(observer, foci, study, *more):
    program = observer.start(foci, "live", study, "--window", "--socket", "0", "--json",
                             "--size", f"{SIZE[0]}x{SIZE[1]}", *more)
    line = program.stderr.readline()
    assert "listening at port" in line, line
    return program, Experiment(int(line.split()[-1]))


def leave(program, experiment):
    assert experiment.ask("leave") == "ok"
    assert program.wait(timeout=60) == 0, program.stderr.read()
    return json.loads(program.stdout.read())


def look_near_and_far(observer, foci, out):
    record = out + "/record"
    # Wide open: what is out of focus shows.
    program, experiment = start(observer, foci, out + "/study.toml", "--record", record, "--pupil", "8")
    looks = {"near": NEAR, "far": FAR}
    sharp = {}
    for name, place in looks.items():
        observer.look(place[0] * SIZE[0], place[1] * SIZE[1])
        state = experiment.until(
            lambda s: s["gaze_px"] and s["surface_distance_m"] and
            abs(s["focus_D"] - 1 / s["surface_distance_m"]) < 0.05 and s["gaze_state"] == "fixation" and
            abs(s["gaze_px"][0] / 1920 - place[0]) < 0.02 and (s["focus_D"] > 2) == (name == "near"),
            "focused on what is " + name)
        print(name, state)
        assert experiment.ask("mark " + name).startswith("ok ")
        time.sleep(1.0)
        observer.screenshot(f"{out}/live-{name}.png")
        rows = observer.pixels()[2]
        sharp[name] = sharpness(rows, (0.43, 0.25))
    # The image on the wall is sharp when it is looked at.
    assert sharp["far"] > 1.2 * sharp["near"], sharp

    observer.press("F1")
    time.sleep(1.0)
    observer.screenshot(out + "/live-panel.png")
    observer.press("F1")
    observer.press("slash")
    time.sleep(1.0)
    observer.screenshot(out + "/live-keys.png")
    observer.press("slash")
    observer.press("6")
    experiment.until(lambda s: s["pupil_mm"] == 6, "a pupil of 6 mm")
    for view in ("side-by-side", "top-bottom", "anaglyph"):
        assert experiment.ask(f'set output.view "{view}"') == "ok"
        frame = experiment.state()["frame_s"]
        experiment.until(lambda s: s["frame_s"] > frame + 0.3, "drawn on")
        observer.screenshot(f"{out}/live-{view}.png")
    observer.press("space")
    assert experiment.ask("stop") == "ok"
    summary = leave(program, experiment)
    print(summary)
    assert summary["records"] == [record]
    assert [row[1] for row in table(record + "/event_markers.tsv")[1:]] == ["near", "far", "space"]

    # What is replayed is what was seen.
    replay = out + "/replay"
    subprocess.run([foci, "replay", record + "/study.toml", "--out", replay], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    hashes = []
    for folder in (record, replay):
        with open(folder + "/manifest.json") as file:
            hashes.append(json.load(file)["frames_sha256"])
    assert hashes[0] == hashes[1], hashes
    for name in ("frames.tsv", "events.tsv"):
        columns = -1 if name == "frames.tsv" else None  # the last is a timing
        assert [row[:columns] for row in table(f"{record}/{name}")] == \
               [row[:columns] for row in table(f"{replay}/{name}")], name


def lose_the_tracker(observer, foci, out):
    # A tracker that says nothing any more after two seconds.
    with open(out + "/dies.tsv", "w") as file:
        file.write("time_s\tx_px\ty_px\n")
        for i in range(200):
            file.write(f"{0.01 * i:.2f}\t{NEAR[0] * 1920:.1f}\t{NEAR[1] * 1080:.1f}\n")
    program, experiment = start(observer, foci, out + "/study.toml", "--source", "trace:" + out + "/dies.tsv")
    experiment.until(lambda s: s["gaze_state"] == "lost" and s["now_s"] > 4 and s["method"], "lost")
    first = experiment.state()
    later = experiment.until(lambda s: s["frame_s"] > first["frame_s"] + 1.0, "drawn on")
    print(later)
    assert later["gaze_state"] == "lost" and later["gaze_px"] is None
    observer.screenshot(out + "/live-lost.png")
    leave(program, experiment)


def signs(observer):
    """Pixels of the colour of warnings at the upper edge."""
    return sum(row[3 * x] > 200 and row[3 * x + 1] > 160 and row[3 * x + 2] < 90
               for row in observer.pixels()[2][:60] for x in range(SIZE[0]))


def lose_a_pupil_core(observer, foci, out, pupil):
    """Gaze of a Pupil Core that is killed on the way, and comes back."""
    def serve(port, place):
        server = observer.start(pupil, port, *place)
        return server, int(server.stdout.readline())

    server, port = serve(0, NEAR)
    program, experiment = start(observer, foci, out + "/study.toml", "--source", f"pupil:127.0.0.1:{port}")
    looks_near = lambda s: s["gaze_state"] == "fixation" and s["focus_D"] > 2
    settled = lambda s: s["surface_distance_m"] and abs(s["focus_D"] - 1 / s["surface_distance_m"]) < 0.02
    before = experiment.until(lambda s: looks_near(s) and settled(s), "focused by the tracker")
    without = signs(observer)
    server.kill()
    server.wait()
    lost = experiment.until(lambda s: s["gaze_state"] == "lost", "lost")
    later = experiment.until(lambda s: s["frame_s"] > lost["frame_s"] + 1.0, "drawn on")
    print(before, later)
    assert later["gaze_state"] == "lost" and abs(later["focus_D"] - before["focus_D"]) < 0.05
    begin = time.time()
    while signs(observer) < without + 50 and time.time() - begin < 60:
        time.sleep(0.1)
    observer.screenshot(out + "/live-pupil-lost.png")
    assert signs(observer) >= without + 50, "no sign says that gaze is lost"
    serve(port, FAR)
    print(experiment.until(lambda s: s["gaze_state"] == "fixation" and s["focus_D"] < 1, "reconnected"))
    leave(program, experiment)


def kill_the_program(observer, foci, out):
    record = out + "/killed"
    program, experiment = start(observer, foci, out + "/study.toml", "--record", record)
    observer.look(FAR[0] * SIZE[0], FAR[1] * SIZE[1])
    experiment.until(lambda s: s["record"], "recording")
    begin = experiment.state()["now_s"]
    experiment.until(lambda s: s["frame_s"] > begin + 3, "drawn on")
    program.kill()
    program.wait()
    subprocess.run([foci, "replay", record + "/study.toml", "--out", out + "/killed-replay"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def main():
    foci, out = sys.argv[1], os.path.abspath(sys.argv[2]) + "/live"
    shutil.rmtree(out, ignore_errors=True)
    os.makedirs(out)
    with open(out + "/study.toml", "w") as file:
        file.write("[output]\nmarker = true\n[render]\nmethod = \"sweep\"\n")
    observer = Observer(*SIZE)
    try:
        look_near_and_far(observer, foci, out)
        lose_the_tracker(observer, foci, out)
        if len(sys.argv) > 4:
            lose_a_pupil_core(observer, foci, out, sys.argv[4])
        kill_the_program(observer, foci, out)
    finally:
        observer.close()


if __name__ == "__main__":
    main()
