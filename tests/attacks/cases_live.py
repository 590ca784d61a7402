"""Live: what the network may not do, and gaze that must not end in silence."""

import json
import re
import socket
import time

from box import STUDY, Skip, attack

HOSTILE = ("a\x1b[31m\x07b", "`touch TOUCHED`", "<script>alert(1)</script>", "x" * 60000)


class Live:
    """`foci live` that listens; its box, and how it ended."""

    def __init__(self, box, *arguments, study=STUDY):
        box.write("study.toml", study)
        self.box = box
        self.process = box.live("study.toml", "--window", "--socket", "0", "--json", "--size", "64x48", *arguments)
        line, self.printed = "", ""
        while "listening at port" not in line:
            line = self.process.stderr.readline().decode(errors="replace")
            self.printed += line
            if not line:
                raise Skip(f"no window: {self.printed[-200:]}")
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.settimeout(15)
        self.socket.connect(("127.0.0.1", int(line.split()[-1])))
        self.wait_for_frame()

    def ask(self, command):
        self.socket.send(command if isinstance(command, bytes) else command.encode())
        return self.socket.recv(65536).decode(errors="replace").strip()

    def wait_for_frame(self):
        end = time.monotonic() + 15
        while time.monotonic() < end and not json.loads(self.ask("state")[3:])["frame_s"] > 0:
            time.sleep(0.05)

    def leave(self):
        self.box.require(self.ask("leave") == "ok", "does not leave")
        outcome = self.box.finish(self.process, 30).done()
        self.printed += outcome.err
        self.box.require(not re.search(r"[\x00-\x08\x0b-\x1f]", self.printed), f"prints {self.printed!r}", "executes")

    def manifest(self, record):
        return json.loads((self.box / record / "manifest.json").read_text())


def open_files(live):
    live.box.write("open/eye.csv", "n,m,um\n3,-1,0.1\npupil_mm,6\n")
    live.box.write("secret.csv", "s3cret,1\n")
    (live.box / "open/link.csv").symlink_to(live.box / "secret.csv")
    (live.box / "open/zero.csv").symlink_to("/dev/zero")
    live.box.fifo("open/pipe.csv")
    live.box.before = None


FILES = ("/etc/passwd", "secret.csv", "../secret.csv", "link.csv", "zero.csv", "pipe.csv", "/dev/zero", ".", "", "a\0b",
         "open/../secret.csv")


@attack("closed", "open")
def file_by_remote(box, how):
    live = Live(box, "--source", "mouse", study=STUDY + ('[remote]\nfolder = "open"\n' if how == "open" else ""))
    open_files(live)
    for name in FILES:
        answer = live.ask(f"set observer.wavefront {json.dumps(name)}")
        box.require(answer.startswith("error"), f"{name}: {answer}", "executes")
        box.require("s3cret" not in answer and "root:" not in answer, f"{name}: {answer}", "executes")
    answer = live.ask('set observer.wavefront "eye.csv"')
    box.require(answer.startswith("ok" if how == "open" else "error"), answer)
    live.leave()


@attack()
def words_by_remote(box):
    live = Live(box, "--source", "socket:100", "--record", "record")
    for text in HOSTILE:
        for verb in ("mark", "record", "set", "set scene.file", "set render.method", "set gaze.source", "gaze", ""):
            answer = live.ask(f"{verb} {text}")
            box.require(answer.startswith(("error", "ok")), f"{verb}: {answer[:99]}")
    for name in ("../out", "/tmp/x", "a/b", ".", ".."):
        box.require(live.ask("record " + name).startswith("error"), "record " + name, "overwrites")
    for key in ("scene.file", "gaze.map", "screen.monitor", "screen.spectra", "record.frames", "remote.folder",
                "output.fps"):
        box.require(live.ask(f'set {key} "/etc/passwd"').startswith("error"), key, "executes")
    for noise in (b"", b"\0" * 60000, b"\xff\xfe", b"gaze " + b"1 2 3;" * 9000, b"gaze " + b"9" * 60000, b"[" * 60000):
        live.socket.send(noise)
    live.ask("state")
    while "ok {" not in live.socket.recv(65536).decode(errors="replace"):
        pass
    live.leave()
    json.loads((box / "record/manifest.json").read_text())
    rows = (box / "record/event_markers.tsv").read_text().split("\n")
    box.require(all(row.count("\t") == 1 for row in rows[:-1]), "a marker breaks its table", "silent")


@attack("lost", "far ahead", "repeated", "no numbers")
def gaze_that_is_not_used(box, why):
    live = Live(box, "--source", "socket:100", "--record", "record")
    said = ""
    for i in range(200):
        at = {"lost": f"{i / 100} nan nan", "far ahead": f"{1e4 * (i + 1)} 9 9", "repeated": "5 9 9",
              "no numbers": "x y z"}[why]
        said = live.ask("gaze " + at)
        if "unused" in said or said.startswith("error"):
            break
        time.sleep(0.02)
    else:
        box.require(False, f"every sample was answered {said}")
    state = json.loads(live.ask("state")[3:])
    live.leave()
    if why == "no numbers":
        return
    box.require(state["gaze_remark"], "the state has no remark")
    box.require("gaze" in live.printed.split("listening")[-1], f"the log says nothing: {live.printed[-200:]}")
    gaze = live.manifest("record")["gaze"]
    box.require(gaze["unused"] or gaze["dropped"], f"the record says nothing: {gaze}")


@attack()
def dropped_gaze_is_counted(box):
    live = Live(box, "--source", "socket:100", "--record", "record")
    kept = dropped = 0
    for i in range(150):
        answer = live.ask(f"gaze {i / 100 - (2 if i % 10 == 9 else 0)} 320 240")
        kept += answer.startswith("ok 1")
        dropped += answer.startswith("ok 0") or "dropped" in answer
        time.sleep(0.01)
    live.leave()
    gaze = live.manifest("record")["gaze"]
    box.require(dropped >= 10, f"answers: {dropped} dropped")
    box.require(gaze["dropped"] >= 10, f"the record has dropped {gaze['dropped']}")


@attack("step", "drift", "wild sample", "jitter")
def clock_of_the_sender(box, what):
    live = Live(box, "--source", "socket:100", "--record", "record")
    begin, steps = time.monotonic(), 0
    while time.monotonic() < begin + 3.5:
        now = time.monotonic() - begin
        at = {"step": now + (1000 if now > 1.5 else 0), "drift": 0.995 * now, "jitter": now - 0.02 * box.random.random(),
              "wild sample": 1e5 if steps == 100 else now}[what]
        live.ask(f"gaze {50 + at:.6f} 320 240")
        steps += 1
        time.sleep(0.01)
    live.leave()
    rows = [row.split("\t") for row in (box / "record/frames.tsv").read_text().splitlines()]
    lost = [row[rows[0].index("gaze_state")] for row in rows[1:]].count("lost")
    box.require(lost <= 0.35 * len(rows), f"lost in {lost} of {len(rows)} frames")
    if what == "step":
        box.require(live.manifest("record")["gaze"]["clock"]["steps"] == 1, "the record has no step")
