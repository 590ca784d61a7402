"""`foci live --headset` through GLX, with a runtime of our own (tests/fake_openxr).

    headset_test.py FOCI OUT_FOLDER ...
"""

import json
import os
import subprocess
import sys

from live_test import Experiment, leave, table
from observer import Observer, emptied

LAYER = "/usr/share/openxr/1/api_layers/explicit.d/XrApiLayer_core_validation.x86_64-linux-gnu.json"


def start(observer, foci, out, words, *more, environment=()):
    folder = emptied(f"{out}/{words.split('=')[0].replace(' ', '-')}")
    manifest = os.environ["FOCI_FAKE_OPENXR_JSON"] if words != "no runtime" else "/nowhere/runtime.json"
    program = observer.start(
        foci, "live", out + "/study.toml", "--headset", "--json", *more,
        environment={"XR_RUNTIME_JSON": manifest, "FOCI_FAKE_OPENXR": words, "FOCI_FAKE_OPENXR_OUT": folder,
                     **dict(environment)})
    return program, folder


def replays(foci, record):
    """A record is complete, and its replay has the same frames."""
    subprocess.run([foci, "replay", record + "/study.toml", "--out", record + "/replay"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    hashes = []
    for folder in (record, record + "/replay"):
        with open(folder + "/manifest.json") as file:
            hashes.append(json.load(file)["frames_sha256"])
    assert hashes[0] == hashes[1], hashes


def show_and_record(observer, foci, out):
    """Both eyes are shown, the layer of Khronos finds no fault, and the record replays to the same frames."""
    report = out + "/validation.txt"
    layer = {"XR_ENABLE_API_LAYERS": "XR_APILAYER_LUNARG_core_validation", "XR_CORE_VALIDATION_EXPORT_TYPE": "text",
             "XR_CORE_VALIDATION_FILE_NAME": report} if os.path.exists(LAYER) else {}
    record = out + "/record"
    program, shown = start(observer, foci, out, "real still jumps gaze=10,-30 eye=96,90", "--record", record, "--socket", "0",
                           environment=layer)
    lines = []
    while not lines or "listening at port" not in lines[-1]:
        lines.append(program.stderr.readline())
        assert lines[-1], lines
    assert any("headset Fake headset, by Fake 1.2.3" in line for line in lines), lines
    experiment = Experiment(int(lines[-1].split()[-1]))
    experiment.until(lambda s: s["record"] and s["gaze_state"] == "fixation" and s["surface_distance_m"], "focused")
    experiment.rendered(0.6)
    observer.screenshot(out + "/mirror.png")
    observer.press("Home")
    experiment.rendered(0.3)
    summary = leave(program, experiment)
    print(summary)
    assert summary["sample_to_display_ms_median"] > 0, summary
    with open(shown + "/log.txt") as file:
        log = file.read()
    assert "VIOLATION" not in log and " new\n" in log and log.endswith("end\n"), log[-2000:]
    assert not os.path.exists(report), open(report).read()[:2000]  # the layer writes it for a fault alone
    rows = table(record + "/timing.tsv")
    assert {"display_s", "gaze_age_ms"} <= set(rows[0]), rows[0]
    assert all(float(row[rows[0].index("display_s")]) > float(row[rows[0].index("render_start_s")]) for row in rows[1:])
    replays(foci, record)


def say_what_is_missing(observer, foci, out):
    for words, code, text in [("no_headset", 2, "no headset at Fake 1.2.3"), ("denied", 2, "does not permit it"),
                              ("no_gaze_extension", 2, "gaze.from_head=true"), ("no runtime", 2, "no OpenXR runtime"),
                              ("real exit=30", 0, "has ended the session")]:
        program, _ = start(observer, foci, out, words)
        out_text, said = program.communicate(timeout=60)
        print(words, program.returncode, said)
        assert program.returncode == code and text in said, (words, program.returncode, said)
        assert (out_text != "") == (code == 0), out_text


def keep_the_record(observer, foci, out):
    """The record of a session that is lost is complete. Where there is no tracker, the head's direction is the gaze."""
    record = out + "/lost"
    program, _ = start(observer, foci, out, "real no_gaze_extension lost=150", "--record", record,
                       "--set", "gaze.from_head=true")
    _, said = program.communicate(timeout=60)
    assert program.returncode == 1 and "session is lost" in said, (program.returncode, said)
    replays(foci, record)


def main():
    foci, out = sys.argv[1], emptied(os.path.abspath(sys.argv[2]) + "/headset")
    with open(out + "/study.toml", "w") as file:
        file.write("[scene]\nbuiltin = \"plane\"\n[render]\nmethod = \"pinhole\"\ndevice = \"cpu\"\n")
    observer = Observer(1000, 900)
    try:
        show_and_record(observer, foci, out)
        say_what_is_missing(observer, foci, out)
        keep_the_record(observer, foci, out)
    finally:
        observer.close()


if __name__ == "__main__":
    main()
