"""A decorative part never costs the result; pipes, devices and odd folders neither hang nor lose anything."""

import os
import stat

from box import Skip, attack, trace
from cases_outputs import unshared

GNUPLOTS = {"exits": "exit 3", "is killed": "kill -9 $$", "draws nothing": "cat >/dev/null",
            "draws nonsense": "cat >/dev/null; echo '<sv'", "does not read": "echo nothing", "hangs": "exec sleep 60"}


def fake_gnuplot(box, how):
    path = box.write("bin/gnuplot", "#!/bin/sh\n" + GNUPLOTS[how] + "\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return {"PATH": f"{box / 'bin'}:{os.environ['PATH']}"}


@attack(*GNUPLOTS)
def gnuplot(box, how):
    box.run("replay", "study.toml", "--out", "out", env=fake_gnuplot(box, how)).done().says("no charts: gnuplot")
    page = (box / "out/report.html").read_text()
    box.require("No charts: " in page, "the report does not say that the charts are missing")
    box.require((box / "out/manifest.json").is_file(), "no manifest")


@attack("stability", "eye")
def gnuplot_fails_in(box, command):
    arguments = ("eye", "study.toml", "--out", "out")
    if command == "stability":
        arguments = ("chart", "--stability", "--quick", "--scene", "gaze-loss", "--method", "pinhole", "--out", "out")
    box.run(*arguments, env=fake_gnuplot(box, "exits")).done().says("gnuplot failed with exit code 3")
    page = (box / f"out/{command}.html").read_text()
    box.require("gnuplot failed" in page, "the page does not say so")


@attack("missing", "read-only")
def temporary_folder(box, how):
    if how == "missing":
        outcome = box.run("replay", "study.toml", "--out", "out", env={"TMPDIR": "/nonexistent"})
    else:
        mount = (*unshared("--mount"), "sh", "-c", 'mount -t tmpfs -o ro none /tmp && exec "$@"', "sh")
        outcome = box.run("replay", "study.toml", "--out", "out", before=mount)
        if "mount:" in outcome.err:
            raise Skip("cannot mount")
    outcome.done()
    box.require("no charts" not in outcome.err, "the charts are missing")


# Commands with an input that is named last.
READERS = {
    "events": ("events",), "trace": ("trace", "info"), "score": ("events", "--score"),
    "study": ("render", "--out", "n.png"),
    "scene": ("info",), "prepare": ("prepare", "--out", "n.foci"),
    "pairs": ("calibrate", "gaze", "--pairs"),
    "binocular": ("calibrate", "binocular", "--pairs"),
    "drift": ("calibrate", "gaze", "--pairs", "pairs.tsv", "--drift"),
    "images": ("calibrate", "camera", "--board", "5x4", "--square-mm", "20", "--images"),
    "video": ("calibrate", "camera", "--board", "5x4", "--square-mm", "20", "--video"),
    "monitor": ("calibrate", "screen", "--headless", "--monitor"),
    "edid": ("calibrate", "screen", "--headless", "--edid"),
    "eye": ("eye", "--out", "n"), "replay": ("replay", "study.toml", "--out", "n", "--trace"),
    "replayed scene": ("replay", "study.toml", "--out", "n", "--scene"),
    "screen": ("replay", "study.toml", "--out", "n", "--screen"),
    "gaze map": ("replay", "study.toml", "--out", "n", "--gaze-map"),
    "camera": ("replay", "study.toml", "--out", "n", "--camera"), "part": ("join", "--out", "n"),
    "scan": ("chart", "--quick", "--method", "pinhole", "--out", "n", "--scan"),
    "reproduce": ("reproduce", "--quick", "--out", "n", "--scan"),
}


@attack(*[(reader, what) for reader in READERS for what in ("pipe", "/dev/null", "/dev/zero", "folder")])
def input_is_a(box, reader, what):
    if what == "pipe":
        box.fifo("in")
    elif what == "folder":
        (box / "in").mkdir()
    outcome = box.run(*READERS[reader], what if what[0] == "/" else "in").any()
    box.require(outcome.code in (1, 2), f"{reader}: exit code {outcome.code}")


@attack(*[(file, what) for file in ("frames.tsv", "events.tsv", "objects.tsv", "video.mp4")
          for what in ("pipe", "device")])
def compared_run_has_a(box, file, what):
    box.run("replay", "study.toml", "--out", "a").done()
    (box / "b").mkdir()
    for name in os.listdir(box / "a"):
        if name != file and name[0] != ".":
            (box / "b" / name).write_bytes((box / "a" / name).read_bytes())
    if what == "pipe":
        box.fifo("b/" + file)
    else:
        (box / "b" / file).symlink_to("/dev/zero")
    box.run("compare", "a", "b", "--out", "c").refused(file)


ODD = (b"caf\xe9", b"\xff\xfe", b"\xf0\x28\x8c\x28", "a b", "a'b\"c", "new\nline", "#hash", "100%")


@attack(*ODD)
def folder_named(box, name):
    folder = os.path.join(os.fsencode(box.path), os.fsencode(name))
    os.mkdir(folder)
    for file in ("study.toml", "scene.ply", "trace.tsv"):
        os.link(box / file, os.path.join(folder, os.fsencode(file)))
    cwd = os.fsdecode(name)
    box.run("replay", os.fsencode(name) + b"/study.toml", "--out", os.fsencode(name) + b"/whole").done()
    if isinstance(name, bytes):  # a part's study names the folder, and TOML is UTF-8
        box.run("replay", "study.toml", "--frames", "0:2", "--out", "part", cwd=cwd).refused("not UTF-8")
        box.require(not os.path.exists(os.path.join(folder, b"part")), "left its folder")
        return
    for part, frames in (("p1", "0:2"), ("p2", "2:")):
        box.run("replay", "study.toml", "--frames", frames, "--out", part, cwd=cwd).done()
    box.run("join", "p1", "p2", "--out", "joined", cwd=cwd).done()
    video = [open(os.path.join(folder, run, b"video.mp4"), "rb").read() for run in (b"joined", b"whole")]
    box.require(video[0] == video[1], "the joined run differs")
    box.run("render", "study.toml", "--out", "a.png", "--write-study", "w.toml", cwd=cwd).done()
    box.run("render", "w.toml", "--out", "b.png", cwd=cwd).done()
    box.write("b.tsv", trace())
    box.run("replay", "study.toml", "--trace", "trace.tsv", "../b.tsv", "--out", "batch", cwd=cwd).done()
    box.run("compare", "joined", "whole", "--out", "c", cwd=cwd).done()
