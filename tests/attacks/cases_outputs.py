"""Outputs never touch what they should not: paths, links, names, two runs in one folder, interrupts."""

import os
import shutil
import signal
import subprocess
import time

from box import LEDGER, Fault, Skip, attack, square_ply, trace

SCREEN = ("--headless", "--size-px", "1920x1080", "--size-m", "0.5x0.3", "--distance-m", "0.6")
# Commands that write files: name, arguments before the path, what its name ends in.
TO_FILES = (
    ("events", ("events", "trace.tsv", "--out"), ".tsv"),
    ("samples", ("events", "trace.tsv", "--samples"), ".tsv"),
    ("physioevents", ("events", "trace.tsv", "--physioevents"), "_physioevents.tsv"),
    ("render", ("render", "study.toml", "--out"), ".png"),
    ("depth", ("render", "study.toml", "--out", "new.png", "--depth"), ".pfm"),
    ("defocus", ("render", "study.toml", "--out", "new.png", "--defocus"), ".exr"),
    ("write-study", ("render", "study.toml", "--out", "new.png", "--write-study"), ".toml"),
    ("heatmap", ("replay", "study.toml", "--out", "new", "--heatmap"), ".ply"),
    ("convert", ("trace", "convert", "trace.tsv", "--out"), "_recording-eye1_physio.tsv.gz"),
    ("prepare", ("prepare", "scene.ply", "--out"), ".foci"),
    ("thumbnail", ("info", "scene.ply", "--thumbnail"), ".png"),
    ("gaze map", ("calibrate", "gaze", "--pairs", "pairs.tsv", "--out"), ".toml"),
    ("gaze report", ("calibrate", "gaze", "--pairs", "pairs.tsv", "--report"), ".html"),
    ("drift", ("calibrate", "gaze", "--pairs", "pairs.tsv", "--drift", "study.toml", "--out"), ".toml"),
    ("binocular", ("calibrate", "binocular", "--pairs", "pairs.tsv", "--out"), ".toml"),
    ("screen", ("calibrate", "screen", *SCREEN, "--out"), ".toml"),
    ("psychopy", ("calibrate", "screen", *SCREEN, "--psychopy"), ".json"),
    ("live study", ("live", "study.toml", "--source", "nothing", "--write-study"), ".toml"),
)
# Commands that write a folder: name, arguments before it, a file that they write there.
TO_FOLDERS = (
    ("replay", ("replay", "study.toml", "--out"), "report.html"),
    ("part", ("replay", "study.toml", "--frames", "0:2", "--out"), "part.json"),
    ("batch", ("replay", "study.toml", "--trace", "trace.tsv", "b.tsv", "--out"), "index.html"),
    ("eye", ("eye", "study.toml", "--out"), "eye.html"),
    ("validate", ("validate", "--out"), "validation.html"),
    ("reproduce", ("reproduce", "--quick", "--out"), "reproduce.html"),
    ("chart", ("chart", "--quick", "--scene", "gallery", "--method", "pinhole", "--out"), "chart.csv"),
    ("stability", ("chart", "--stability", "--quick", "--method", "pinhole", "--out"), "stability.csv"),
    ("manual", ("manual", "--out"), "man1/foci.1"),
)
# Ways to spell the path of a file in the box. `link` leads to the box, `soft-` and `hard-` to the file.
SPELLINGS = ("{}", "./{}", "nope/../{}", "nope/deep/../../{}", "link/{}", "nope/../link/{}", "link/nope/../{}",
             "full/../{}", "{box}/nope/../{}", "nope/../soft-{}", "nope/../hard-{}", "link/link/hard-{}", "{}/", "{}/.",
             "nope/../{}/")


def links(box, name):
    (box / "link").symlink_to(".")
    (box / "full").mkdir(exist_ok=True)
    box.write("full/kept", "kept")
    (box / ("soft-" + name)).symlink_to(name)
    os.link(box / name, box / ("hard-" + name))


@attack(*[(name, spelling) for name, *_ in TO_FILES for spelling in SPELLINGS[:4] + SPELLINGS[5:11:2] + SPELLINGS[12:]])
def users_file(box, command, spelling):
    arguments, ending = next((a, e) for n, a, e in TO_FILES if n == command)
    name = "mine" + ending
    box.write(name, "mine")
    links(box, name)
    box.run(*arguments, spelling.format(name, box=box.path)).refused()
    box.require_unchanged()


@attack(*[(command, spelling) for command in ("events", "write-study", "heatmap", "convert", "live study", "screen")
          for spelling in SPELLINGS])
def input_even_with_overwrite(box, command, spelling):
    arguments, ending = next((a, e) for n, a, e in TO_FILES if n == command)
    inputs = {"events": "trace.tsv", "write-study": "study.toml", "heatmap": "scene.ply", "live study": "study.toml"}
    name = inputs.get(command, "input" + ending)
    if command == "convert":  # a recording to be converted in place
        box.run("trace", "convert", "trace.tsv", "--out", name).done()
        box.before = None
        arguments = ("trace", "convert", name, "--out")
    if command == "screen":
        box.run("calibrate", "screen", *SCREEN, "--out", name).done()
        box.before = None
        arguments = ("calibrate", "screen", "--headless", "--monitor", name, "--out")
    links(box, name)
    box.run(*arguments, spelling.format(name, box=box.path), "--overwrite").refused()
    box.require_unchanged()


@attack(*[(name, way) for name, *_ in TO_FOLDERS for way in ("out", "nope/../out", "link/nope/../out/")])
def users_file_in_a_folder(box, command, way):
    arguments, file = next((a, f) for n, a, f in TO_FOLDERS if n == command)
    box.write("b.tsv", trace())
    (box / "link").symlink_to(".")
    box.write("out/" + file, "mine")
    box.run(*arguments, way).refused("out/" + file)
    box.require_unchanged()


@attack(*[("replay", "report.html"), ("join", "frames.tsv"), ("compare", "compare.html"), ("part", "frame-000000.png"),
          ("eye", "both_mtf.png")])
def input_is_in_the_output_folder(box, command, name):
    if command == "replay":
        box.write("out/" + name, trace())
        outcome = ("replay", "study.toml", "--trace", "out/" + name, "--out", "nope/../out", "--overwrite")
    elif command == "eye":
        box.write("out/" + name, "mine")
        outcome = ("eye", "study.toml", "--out", "nope/../out")
    else:
        box.run("replay", "study.toml", "--out", "a").done()
        box.run("replay", "study.toml", "--frames", "0:3", "--out", "p").done()
        box.before = None
        if command == "compare":
            box.write("a/" + name, "mine")
            outcome = ("compare", "a", "a", "--out", "nope/../a")
        elif command == "join":
            box.write("p/" + name, "mine")
            outcome = ("join", "p", "--out", "nope/../p")
        else:
            box.write("p/" + name, "mine")
            outcome = ("replay", "study.toml", "--frames", "0:3", "--out", "p")
    box.run(*outcome).refused(name)
    box.require_unchanged()


@attack("mine", "link", "folder")
def list_of_outputs_is_not_focis(box, what):
    if what == "mine":
        box.write(LEDGER, "mine")
    elif what == "link":
        (box / LEDGER).symlink_to("trace.tsv")
    else:
        (box / LEDGER).mkdir()
    box.run("events", "trace.tsv", "--out", "new.tsv").refused(LEDGER)
    box.require_unchanged()


@attack("plain", "--overwrite")
def file_that_appears_during_the_run(box, way):
    box.write("long.tsv", trace(400000, 0.001))
    process = box.start("trace", "convert", "long.tsv", "--out", "a_recording-eye1_physio.tsv.gz",
                        *([way] if way == "--overwrite" else []))
    if not box.wait_for(box.staging, "its staging folder", process):
        raise Fault("silent", "ended at once")
    os.link(box / "long.tsv", box / "a_recording-eye1_physio.tsv.gz")
    box.finish(process).refused("a_recording-eye1_physio.tsv.gz")


NAMES = ("...tsv", ".tsv", "..tsv", ".hidden.tsv", "index.html.tsv", "recordings.tsv.tsv", "INDEX.html.tsv",
         "new\nline.tsv", "tab\there.tsv", "a:b*c?.tsv", "`touch TOUCHED`.tsv", "$(touch TOUCHED).tsv", "a;b.tsv",
         "back\\slash.tsv", "\x1b[31mred.tsv", "-o.tsv", " .tsv", "a..tsv", b"caf\xe9.tsv", "x" * 200 + ".tsv",
         "video.mp4.tsv", LEDGER + ".tsv")


@attack(*NAMES)
def name_of_a_recording(box, name):
    box.write(name, trace())
    box.run("replay", "study.toml", "--trace", b"./" + os.fsencode(name), "trace.tsv", "--out", "out").done()
    new = {file.split("/")[0] for file in set(box.files()) - set(box.before)}
    box.require(new == {"out"}, f"wrote {new}", "overwrites")
    runs = [folder for folder in os.listdir(box / "out") if os.path.isdir(box / "out" / folder)]
    box.require(len(runs) == 2 and all(os.path.isfile(box / "out" / run / "report.html") for run in runs),
                f"has the runs {runs}")
    box.require(not any(run.startswith(".") for run in runs), f"hides {runs}")


@attack(("A.tsv", "a.tsv"), ("x/g.tsv", "y/G.tsv"), ("...tsv", "__.tsv"), ("a\n.tsv", "a\t.tsv"))
def names_that_are_alike(box, first, second):
    for name in (first, second):
        box.write(name, trace())
    box.run("replay", "study.toml", "--trace", first, second, "--out", "out").done()
    runs = [folder.name for folder in (box / "out").iterdir() if folder.is_dir()]
    box.require(len(runs) == 2 and len({run.lower() for run in runs}) == 2, f"has the runs {runs}")


CHART = ("chart", "--quick", "--scan", "scene.ply", "--size", "16", "--method", "pinhole", "--out", "out")


@attack(*[(where, name) for where, name in (
    ("images", "scan_4px_pinhole.png"), ("images", "scan_4px_pinhole_difference.png"),
    ("images", "scan_4px_reference.png"), ("cells", "scan_4px_pinhole.json"), ("cells", "scan_4px_reference.json"),
    ("cells", "scan_4px_reference.rgba"))])
def users_file_in_a_chart(box, where, name):
    box.write(f"out/{where}/{name}", "mine")
    box.run(*CHART).refused(name)
    box.require_unchanged()


@attack("cells/scan_4px_pinhole.json", "images/scan_4px_pinhole.png", "chart.csv")
def pipe_in_a_chart(box, name):
    box.fifo("out/" + name)
    box.run(*CHART).refused("not a file")


def unshared(*how):
    if not shutil.which("unshare") or subprocess.run(["unshare", *how, "true"], capture_output=True).returncode != 0:
        raise Skip("no right to make namespaces")
    return ("unshare", *how)


LONG = ("--size", "640x480", "--seconds", "0:0.9", "--set", "output.fps=60", "--method", "accumulate:64")


@attack("plain", "namespace", "host")
def second_run_in_a_folder(box, way):
    spaces = {"plain": (), "namespace": ("--pid",), "host": ("--uts", "--pid")}[way]
    before = unshared(*spaces, "--fork", "--kill-child") if spaces else ()
    first = box.start("replay", "study.toml", "--out", "out", *LONG, before=before)
    box.wait_for(lambda: any((staging / "all").exists() for staging in box.staging()), "its staging folder", first)
    for attempt in range(2):
        box.run("replay", "study.toml", "--out", "nope/../out", before=before).refused("(process ")
    box.require(first.poll() is None, "the first run was too short")
    os.killpg(first.pid, signal.SIGKILL)
    first.communicate()
    box.run("replay", "study.toml", "--out", "out").done()


@attack(("batch", ("replay", "study.toml", "--trace", "trace.tsv", "b.tsv")),
        ("part", ("replay", "study.toml", "--frames", "0:9")))
def second_run_as(box, _, arguments):
    box.write("b.tsv", trace())
    first = box.start(*arguments, "--out", "out", *LONG)
    box.wait_for(lambda: any((staging / "all").exists() for staging in box.staging()), "its staging folder", first)
    box.run(*arguments, "--out", "out").refused("(process ")
    os.killpg(first.pid, signal.SIGKILL)
    first.communicate()
    box.run(*arguments, "--out", "out").done()


@attack(("this start", 0, True), ("another start", 5, False), ("another start", 3600, True), ("", 5, False))
def lock_of_another_run(box, start, age_s, gone):
    staging = box / "out/.foci-0123456789abcdef"
    for part in ("claims", "new", "old"):
        (staging / part).mkdir(parents=True)
    box.write("out/.foci-0123456789abcdef/all", "")
    if start == "this start":
        with open("/proc/sys/kernel/random/boot_id", encoding="ascii") as file:
            start = file.read().strip()
    lock = box.write("out/.foci-0123456789abcdef/lock", start + "\nprocess 1 on lab3 since noon\n")
    os.utime(lock, (time.time() - age_s,) * 2)
    outcome = box.run("replay", "study.toml", "--out", "out")
    outcome.done() if gone else outcome.refused("(process 1 on lab3 since noon)")
    box.before = None
    box.require(staging.exists() != gone, "the other run's folder")
    shutil.rmtree(staging, ignore_errors=True)


@attack(*range(3))
def two_runs_at_once(box, _):
    both = [box.start("replay", "study.toml", "--out", "out") for _ in range(2)]
    codes = sorted(box.finish(process).code for process in both)
    box.require(codes in ([0, 0], [0, 2]), f"exit codes {codes}")
    box.require((box / "out/report.html").is_file() and (box / "out/video.mp4").is_file(), "no run is whole")


SLOW = (
    ("replay", ("replay", "study.toml", "--out", "new/out", *LONG)),
    ("part", ("replay", "study.toml", "--frames", "0:50", "--out", "new/out", *LONG)),
    ("convert", ("trace", "convert", "long.tsv", "--out", "new/a_physio.tsv.gz")),
    ("prepare", ("prepare", "large.ply", "--out", "new/a.foci")),
    ("eye", ("eye", "study.toml", "--out", "new/out")),
    ("validate", ("validate", "--out", "new/out")),
    ("stability", ("chart", "--stability", "--quick", "--scene", "density", "--method", "sweep", "--out", "new/out")),
)


@attack(*[(name, signal_name) for name, _ in SLOW for signal_name in ("SIGINT", "SIGTERM")])
def interrupt(box, command, signal_name):
    if command == "convert":
        box.write("long.tsv", trace(400000, 0.001))
    if command == "prepare":
        box.write("large.ply", square_ply(300))
    process = box.start(*dict(SLOW)[command])
    # Before the staging folder, there is the folder; both have to go.
    if not box.wait_for((box / "new").exists, "its folder", process):
        raise Fault("silent", f"{process.command} ended at once")
    time.sleep(0.1 * box.random.random())
    began = time.monotonic()
    process.send_signal(getattr(signal, signal_name))
    outcome = box.finish(process)
    box.require(time.monotonic() - began < 3.0, "took long to end", "hangs")
    if command == "stability":  # keeps its measurements
        box.require(outcome.code == 1, f"exit code {outcome.code}")
        return
    outcome.failed("interrupted")
    box.require_unchanged()


@attack(*["{box}/nope/../new.tsv", "new/deep/new.tsv", "link/new.tsv"])
def ordinary_outputs_still_work(box, path):
    (box / "link").symlink_to(".")
    box.run("events", "trace.tsv", "--out", path.format(box=box.path)).done()
    box.run("events", "trace.tsv", "--out", path.format(box=box.path)).done()
    box.require(any(file.endswith("new.tsv") for file in box.files()), "wrote nothing")
