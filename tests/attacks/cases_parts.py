"""A decorative part never costs the result; pipes, devices and odd folders neither hang nor lose anything."""

import html
import json
import os
import re
import stat

from box import PAIRS, STUDY, Skip, attack, square_ply, trace
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


@attack(*[(file, what) for file in ("frames.tsv", "fixations.tsv", "objects.tsv", "video.mp4")
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


# What makes a run's results other than the user may expect: changes of the study, and files.
DOUBTS = {
    "gaze meets nothing": ("look_at_m = [0, 0, -1]", "look_at_m = [0, 0, 1]", {}),
    "dark points": ("", "", {"scene.ply": square_ply().replace(" 128 90\n", " 0 1\n").replace(" 255 ", " 1 ")}),
    "copies of rows": ("", "", {"trace.tsv": trace() + trace().split("px\n", 1)[1]}),
    "gaze off the screen": ("", "", {"trace.tsv": trace().replace("\t320\t", "\t900\t")}),
    "gaze that is lost": ("", "", {
        "trace.tsv": trace(60) + "".join(f"{0.6 + i / 100:.2f}\tnan\tnan\n" for i in range(90))}),
    "odd pixels": ("size_m = [0.4, 0.3]", "size_m = [0.4, 0.9]", {"trace.tsv": trace().split("\n", 1)[1]}),
    "other device": ("[gaze]", "[render]\ndevice = \"gpu\"\nmethod = \"rasanen\"\n[gaze]", {}),
}


@attack(*DOUBTS)
def warning_of(box, what):
    old, new, files = DOUBTS[what]
    for name, content in files.items():
        box.write(name, content)
    box.write("study.toml", STUDY.replace(old, new, 1) if old else STUDY)
    outcome = box.run("replay", "study.toml", "--out", "out").any()
    if outcome.code != 0:
        return
    warnings = json.loads((box / "out/manifest.json").read_text())["warnings"]
    page = html.unescape((box / "out/report.html").read_text())
    printed = [line[6:] for line in outcome.err.splitlines() if line.startswith("foci: ")]
    for line in printed:
        if "renders on" in line or "assum" in line or "computing" in line:
            continue
        box.require(line in warnings, f"the manifest has not {line!r}")
        box.require(line in page, f"the report has not {line!r}")
    box.require(printed, "says nothing")


BROKEN_GPU = ({"MESA_GL_VERSION_OVERRIDE": "3.0"}, {"GALLIUM_DRIVER": "nonsense"}, {"EGL_PLATFORM": "nonsense"},
              {"__EGL_VENDOR_LIBRARY_DIRS": "/nonexistent"}, {"LIBGL_DRIVERS_PATH": "/nonexistent"},
              {"MESA_EXTENSION_OVERRIDE": "-GL_ARB_compute_shader"})


@attack(*[(i, device) for i in range(len(BROKEN_GPU)) for device in ("auto", "gpu")])
def gpu_is_broken(box, which, device):
    outcome = box.run("replay", "study.toml", "--device", device, "--method", "auto", "--set", "quality.frame_ms=20",
                      "--set", 'observer.pupil="luminance"', "--out", "out", env=BROKEN_GPU[which])
    outcome.done() if device == "auto" else outcome.any()


SCAN = ("chart", "--quick", "--scan", "scene.ply", "--eye", "0,-1.6,-0.2", "--look-at", "0,0,-1", "--method", "pinhole",
        "--out", "out", "--scene")
PAGES = {
    "calibration": (("calibrate", "gaze", "--pairs", "pairs.tsv", "--units", "norm", "--report", "out/n.html"), "n.html"),
    "stability": ((*SCAN, "thinned", "--stability"), "stability.html"),
    "chart": ((*SCAN, "scan", "--size", "16"), "chart.html"),
}


@attack(*PAGES)
def warnings_stand_on_the_page_of(box, what):
    box.write("scene.ply", re.sub(r"\d+ 128 90\n", "9 9 9\n", square_ply(60)))
    box.write("pairs.tsv", PAIRS.replace("8", "0.8").replace("5", "0.5"))
    command, page = PAGES[what]
    for _ in range(2):  # the second run keeps what the first one measured
        outcome = box.run(*command).done()
        printed = [line[6:] for line in outcome.err.splitlines() if line.startswith("foci: ")]
        text = html.unescape((box / "out" / page).read_text())
        box.require(printed and all(line in text for line in printed), f"{page} lacks one of {printed}")
