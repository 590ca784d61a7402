"""`foci live` with a mouse, with trackers that stop, and killed; and replays of the recordings.

    live_test.py FOCI OUT_FOLDER FOCI_FILM [FOCI_PUPIL]
"""

import concurrent.futures
import glob
import json
import math
import os
import shutil
import socket
import subprocess
import sys
import time
import tomllib

from observer import Observer

SIZE = (320, 180)
NEAR, FAR = (0.078, 0.648), (0.45, 0.22)  # shares of the frame: a leaf near the eye, the painting on the wall


class Experiment:
    """A script that controls foci, as docs/experiment.py does."""

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

    def rendered(self, seconds):
        """The first state whose frame is at least this much newer than now."""
        begin = self.state()["now_s"]
        return self.until(lambda s: s["frame_s"] >= begin + seconds, "rendered on")


def table(path):
    with open(path) as file:
        return [line.rstrip("\n").split("\t") for line in file]


def sharpness(rows, centre):
    """Sum of differences between neighbouring pixels around a point: larger where the frame is in focus."""
    x0, y0 = (int(centre[i] * SIZE[i]) for i in (0, 1))
    total = 0
    for y in range(y0 - 14, y0 + 14):
        for x in range(x0 - 20, x0 + 20):
            total += abs(rows[y][3 * x + 1] - rows[y][3 * x + 4])
    return total


def start(observer, foci, study, *more):
    program = observer.start(foci, "live", study, "--window", "--socket", "0", "--json",
                             "--size", f"{SIZE[0]}x{SIZE[1]}", *more)
    lines = []
    while not lines or "listening at port" not in lines[-1]:  # other lines say what renders, and what was assumed
        lines.append(program.stderr.readline())
        assert lines[-1], lines  # the program has ended
    line = lines[-1]
    return program, Experiment(int(line.split()[-1]))


def leave(program, experiment):
    assert experiment.ask("leave") == "ok"
    assert program.wait(timeout=60) == 0, program.stderr.read()
    return json.loads(program.stdout.read())


def look_near_and_far(observer, foci, out):
    record = out + "/record"
    # With a wide pupil the blur is large.
    program, experiment = start(observer, foci, out + "/study.toml", "--record", record, "--pupil", "8")
    looks = {"near": NEAR, "far": FAR}
    sharp = {}
    for name, place in looks.items():
        observer.look(place[0] * SIZE[0], place[1] * SIZE[1])
        state = experiment.until(
            lambda s: s["gaze_px"] and s["surface_distance_m"] and
            abs(s["focus_D"] - 1 / s["surface_distance_m"]) < 0.05 and s["gaze_state"] == "fixation" and
            abs(s["gaze_px"][0] / 1920 - place[0]) < 0.02 and (s["focus_D"] > 2) == (name == "near"),
            "focused " + name)
        print(name, state)
        assert experiment.ask("mark " + name).startswith("ok ")
        experiment.rendered(0.5)
        observer.screenshot(f"{out}/live-{name}.png")
        rows = observer.pixels()[2]
        sharp[name] = sharpness(rows, (0.43, 0.25))
    # The painting is sharp when the observer looks at it.
    assert sharp["far"] > 1.2 * sharp["near"], sharp

    observer.press("F1")
    experiment.rendered(0.3)
    observer.screenshot(out + "/live-panel.png")
    observer.press("F1")
    observer.press("slash")
    experiment.rendered(0.3)
    observer.screenshot(out + "/live-keys.png")
    observer.press("slash")
    observer.press("6")
    experiment.until(lambda s: s["pupil_mm"] == 6, "a pupil of 6 mm")
    for view in ("side-by-side", "top-bottom", "anaglyph"):
        assert experiment.ask(f'set output.view "{view}"') == "ok"
        experiment.rendered(0.3)
        observer.screenshot(f"{out}/live-{view}.png")
    observer.press("space")
    assert experiment.ask("stop") == "ok"
    summary = leave(program, experiment)
    print(summary)
    assert summary["records"] == [record]
    assert [row[1] for row in table(record + "/event_markers.tsv")[1:]] == ["near", "far", "space"]

    # The replay equals the run.
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


def scrub_a_recording(observer, foci, out):
    """A recording begins with the first frame, and has the keys of a video player. Other keys move the eye."""
    with open(out + "/two.tsv", "w") as file:  # two fixations of three seconds
        file.write("time_s\tx_px\ty_px\n")
        for i in range(600):
            place = NEAR if i < 300 else FAR
            noise = math.sin(37 * i)
            file.write(f"{50 + 0.01 * i:.2f}\t{place[0] * 1920 + noise:.3f}\t{place[1] * 1080 - noise:.3f}\n")
    program, experiment = start(observer, foci, out + "/plane.toml", "--source", "trace:" + out + "/two.tsv")
    begun = experiment.until(lambda s: s["speed"] == 1, "playing")
    assert begun["recording_s"] < 52, begun
    at = lambda second: lambda s: abs(s["recording_s"] - second) < 0.05
    observer.press("space")
    experiment.until(lambda s: s["speed"] == 0, "paused")
    observer.press("l", 2)
    looks = lambda place: lambda s: s["gaze_px"] and abs(s["gaze_px"][0] / 1920 - place[0]) < 0.02
    experiment.until(lambda s: at(54.5)(s) and looks(FAR)(s), "at the second fixation")
    observer.screenshot(out + "/live-timeline.png")
    observer.press("j")
    experiment.until(lambda s: at(51.5)(s) and looks(NEAR)(s), "at the first fixation")
    look_from_outside(observer, experiment, out)
    observer.press("Right")
    experiment.until(at(55.99), "at the end")
    observer.press("Home")
    experiment.until(at(50), "at the beginning")
    observer.press("bracketright")
    observer.press("space")
    experiment.until(lambda s: s["speed"] == 2, "playing twice as fast")
    observer.press("w", 3)
    observer.press("F2")
    begin = time.time()
    while not (saved := glob.glob("foci-*.toml")) and time.time() < begin + 30:
        time.sleep(0.05)
    with open(saved[0], "rb") as file:
        eye = tomllib.load(file)["eye"]
    os.remove(saved[0])
    assert eye["position_m"][2] < 1.34, eye  # it began at 1.35
    leave(program, experiment)


def look_from_outside(observer, experiment, out):
    """A second camera shows the scene; the eye's frames stay as they are."""
    def changed(own):
        other = b"".join(observer.pixels()[2])
        return sum(abs(a - b) > 16 for a, b in zip(own, other)) / len(own)

    own, end = b"".join(observer.pixels()[2]), time.time() + 60
    before = experiment.state()
    observer.press("x")
    while changed(own) < 0.3 and time.time() < end:
        time.sleep(0.1)
    observer.press("w", 3)  # moves the camera
    time.sleep(0.5)
    observer.screenshot(out + "/live-outside.png")
    assert changed(own) > 0.3
    after = experiment.state()
    assert after["gaze_px"] == before["gaze_px"] and abs(after["focus_D"] - before["focus_D"]) < 1e-4, (before, after)
    observer.press("x")
    while changed(own) > 0.1 and time.time() < end:
        time.sleep(0.1)
    assert changed(own) < 0.1


def signs(observer):
    """Number of pixels at the upper edge in the colour of warnings."""
    return sum(row[3 * x] > 200 and row[3 * x + 1] > 160 and row[3 * x + 2] < 90
               for row in observer.pixels()[2][:60] for x in range(SIZE[0]))


def lose_a_pupil_core(observer, foci, out, pupil):
    """Gaze of a Pupil Core that is killed during the run, and comes back."""
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
    experiment.until(lambda s: s["gaze_state"] == "lost", "lost")
    later = experiment.rendered(0.5)
    print(before, later)
    assert later["gaze_state"] == "lost" and abs(later["focus_D"] - before["focus_D"]) < 0.05
    begin = time.time()
    while signs(observer) < without + 50 and time.time() - begin < 60:
        time.sleep(0.1)
    observer.screenshot(out + "/live-pupil-lost.png")
    assert signs(observer) >= without + 50, "no warning about the missing gaze"
    assert "none arrives" in experiment.until(lambda s: s["gaze_remark"], "told so")["gaze_remark"]
    serve(port, FAR)
    print(experiment.until(lambda s: s["gaze_state"] == "fixation" and s["focus_D"] < 1, "reconnected"))
    leave(program, experiment)


def push_gaze(observer, foci, out, seconds=6):
    """Gaze of another program at 1000 Hz, ten samples in a datagram: none is lost, and focus follows it."""
    record = out + "/pushed"
    program, experiment = start(observer, foci, out + "/study.toml", "--source", "socket:1000", "--record", record,
                                "--set", "output.sync_patch=40")
    experiment.until(lambda s: s["record"], "recording")
    begin, sent = time.time(), 0
    while sent < 1000 * seconds:
        if time.time() < begin + (sent + 10) / 1000:  # ten samples are sent once all are measured
            time.sleep(0.001)
            continue
        place = NEAR if sent < 500 * seconds else FAR
        samples = ";".join(f"{7000 + (sent + i) / 1000:.3f} {place[0] * 1920} {place[1] * 1080} 3.5" for i in range(10))
        assert experiment.ask("gaze " + samples) == "ok 10"
        sent += 10
    corner, latest, end = set(), sent / 1000, time.time() + 30

    def push_one():
        """A sample of now: the tracker's clock goes on while the screenshots take their time."""
        nonlocal latest, sent
        latest = max(latest + 0.001, time.time() - begin)
        sample = f"{7000 + latest:.4f} {FAR[0] * 1920 + sent % 2} {FAR[1] * 1080} 3.5"
        assert experiment.ask("gaze " + sample) == "ok 1"
        sent += 1

    while len(corner) < 4 and time.time() < end:  # the patch takes each of its levels
        corner.add(observer.pixels()[2][SIZE[1] - 5][3 * (SIZE[0] - 5)])
        push_one()
    assert corner == {0, 85, 170, 255}, corner
    state = experiment.state()
    while state["gaze_state"] != "fixation" and time.time() < end:  # a late screenshot is a gap in gaze
        push_one()
        state = experiment.state()
    print("pushed", sent, state)
    assert abs(state["focus_D"] - 1 / state["surface_distance_m"]) < 0.1 and state["focus_D"] < 1, state
    assert experiment.ask("gaze 1 2").startswith("error gaze"), "a sample without y"
    experiment.until(lambda s: s["gaze_state"] == "lost", "without gaze")
    assert experiment.ask("stop") == "ok"
    leave(program, experiment)
    gaze = [float(row[0]) for row in table(record + "/gaze.tsv")[2:] if row[1] != "n/a"]  # below two lines of header
    assert len(gaze) == sent, (len(gaze), sent)
    steps = sorted(b - a for a, b in zip(gaze, gaze[1:]))
    assert abs(steps[len(steps) // 2] - 0.001) < 1e-5, steps[len(steps) // 2]


def place_an_object(observer, foci, out):
    """A key names what the mouse points at, and the study that another key saves has it."""
    program, experiment = start(observer, foci, out + "/plane.toml")
    observer.look(0.5 * SIZE[0], 0.5 * SIZE[1])
    state = experiment.until(lambda s: s["gaze_state"] == "fixation" and s["surface_distance_m"] and s["method"],
                             "looking at the plane")
    observer.press("o")
    experiment.rendered(0.5)
    observer.screenshot(out + "/live-object.png")
    observer.press("F2")
    experiment.rendered(0.3)
    leave(program, experiment)
    (saved,) = glob.glob("foci-*.toml")
    with open(saved, "rb") as file:
        study = tomllib.load(file)
    (placed,) = study["scene"]["object"]
    away_m = math.dist(placed["center_m"], study["eye"]["position_m"])
    assert placed["name"] == "object 1" and abs(away_m / state["surface_distance_m"] - 1) < 0.02, (placed, state)
    assert abs(placed["radius_m"] / away_m - math.tan(math.radians(2))) < 1e-3, placed


def kill_the_program(observer, foci, out):
    record = out + "/killed"
    program, experiment = start(observer, foci, out + "/plane.toml", "--record", record)
    observer.look(FAR[0] * SIZE[0], FAR[1] * SIZE[1])
    experiment.until(lambda s: s["record"], "recording")
    experiment.rendered(1.5)
    program.kill()
    program.wait()
    subprocess.run([foci, "replay", record + "/study.toml", "--out", out + "/killed-replay"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def render_on_the_gpu(observer, foci, out):
    """Frames that stay on the GPU are shown as the CPU's are, and the record replays to the same bytes."""
    doctor = subprocess.run([foci, "doctor", "--json"], check=True, capture_output=True, text=True)
    gpu = json.loads(doctor.stdout)["gpu"]
    if "problem" in gpu:
        print("not tested on a GPU:", gpu["problem"])
        return
    with open(out + "/few.ply", "w") as file:  # a wall of few points: the software driver is slow
        file.write("ply\nformat ascii 1.0\nelement vertex 600\nproperty float x\nproperty float y\nproperty float z\n"
                   "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n")
        for i in range(600):
            x, y = i % 30, i // 30
            file.write(f"{0.05 * (x - 14.5)} {0.05 * (y - 9.5)} {-1 - 0.02 * x} {8 * x} {12 * y} {255 * (i % 7 == 0)}\n")
    with open(out + "/gpu.toml", "w") as file:
        file.write("[scene]\nfile = \"few.ply\"\n[eye]\nposition_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]\n"
                   "[focus]\nfixed_D = 1.0\n[output]\nview = \"side-by-side\"\n[render]\nmethod = \"sweep-lod\"\n")
    shown, hashes = {}, {}
    for device in "cpu", "gpu":
        same = out + "/on-a-device"  # the notices name it, alike on both devices
        program, experiment = start(observer, foci, out + "/gpu.toml", "--record", same, "--device", device)
        experiment.until(lambda s: s["record"] and s["method"], "recording")
        experiment.rendered(1.0)
        observer.screenshot(f"{out}/live-on-{device}.png")
        shown[device] = observer.pixels()[2]
        leave(program, experiment)
        record = f"{out}/on-{device}"
        os.rename(same, record)
        command = [foci, "replay", record + "/study.toml", "--device", "gpu", "--out", record + "-replay"]
        replay = subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        warns = "the run was rendered on the CPU" in replay.stderr
        assert warns == (device == "cpu"), replay.stderr
        for folder in record, record + "-replay":
            with open(folder + "/manifest.json") as file:
                manifest = json.load(file)
            assert manifest["device"].startswith("the CPU" if folder.endswith("on-cpu") else gpu["name"]), manifest
            hashes.setdefault(device, []).append(manifest["frames_sha256"])
    assert hashes["gpu"][0] == hashes["gpu"][1], hashes
    pixels = [b"".join(shown[device]) for device in ("cpu", "gpu")]
    assert len(set(pixels[0])) > 20, "nothing is in view"
    worst = max(abs(a - b) for a, b in zip(*pixels))
    assert worst <= 2, worst


def keep_the_shape(_, foci, out):
    """A window of another shape than the study's screen shows all of it, undistorted."""
    observer = Observer(320, 320)
    try:
        program, experiment = start(observer, foci, out + "/plane.toml", "--set", "scene.background=[1, 1, 1]")
        observer.look(160, 160)
        observer.press("F11")
        experiment.until(lambda s: s["gaze_px"] == [960, 540], "looking at the middle")
        experiment.rendered(0.5)
        rows = observer.pixels()[2]
        assert not any(rows[60]) and not any(rows[260]), "320 x 180 of the 320 x 320 px"
        assert any(rows[75]) and any(rows[245])
        leave(program, experiment)
    finally:
        observer.close()
    observer = Observer(640, 180)  # two screens, one for each eye
    try:
        program, experiment = start(observer, foci, out + "/plane.toml", "--set", "scene.background=[1, 1, 1]",
                                    "--view", "side-by-side")
        observer.press("F11")
        experiment.rendered(0.5)
        rows = observer.pixels()[2]
        assert any(rows[90][:9]) and any(rows[90][-9:]), "all of the 640 x 180 px"
        leave(program, experiment)
    finally:
        observer.close()


def main():
    foci, out = sys.argv[1], os.path.abspath(sys.argv[2]) + "/live"
    shutil.rmtree(out, ignore_errors=True)
    os.makedirs(out)
    os.chdir(out)  # where foci saves what keys ask for
    with open(out + "/study.toml", "w") as file:
        file.write("[output]\nmarker = true\n[render]\nmethod = \"sweep\"\n")
    # A scene that is there at once, for the runs that do not depend on depth.
    with open(out + "/plane.toml", "w") as file:
        file.write("[scene]\nbuiltin = \"plane\"\n[output]\nmarker = true\n[render]\nmethod = \"sweep\"\n")

    def play(*parts):
        observer = Observer(*SIZE)
        try:
            for part, *more in parts:
                part(observer, foci, out, *more)
        finally:
            observer.close()

    # Two observers play at the same time, each before a display of their own.
    others = [(scrub_a_recording,), (push_gaze,), (place_an_object,), (kill_the_program,), (render_on_the_gpu,),
              (keep_the_shape,)]
    if len(sys.argv) > 4:
        others.append((lose_a_pupil_core, sys.argv[4]))
    with concurrent.futures.ThreadPoolExecutor() as pool:
        runs = [pool.submit(play, (look_near_and_far,)), pool.submit(play, *others)]
        for run in runs:
            run.result()


if __name__ == "__main__":
    main()
