"""The Snakemake workflow of configs/batch: two workers, of which one is killed.

    python3 tests/batch/workflow_test.py build/release/foci
"""

import gzip
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
STUDY = """[screen]
size_px = [640, 480]
size_m = [0.4, 0.3]
distance_m = 0.5
[render]
method = "sweep-lod"
[output]
size_px = [320, 240]
seconds = [0, 2]
"""


def recording(foci, folder, subject):
    """Three seconds of gaze at 100 Hz, with a saccade each half second. sub-03 does not state its screen."""
    place = folder / "data" / subject / "beh"
    place.mkdir(parents=True)
    rows = [f"{0.01 * i:.2f}\t{150 if i // 50 % 2 else 400 + 10 * len(subject)}\t240" for i in range(310)]
    raw = folder / f"{subject}.tsv"
    raw.write_text("time_s\tx_px\ty_px\n" + "\n".join(rows) + "\n")
    screen = ["--screen-px", "640x480", "--screen-m", "0.4x0.3", "--distance-m", "0.5"] if subject != "sub-03" else []
    subprocess.run([foci, "trace", "convert", raw, "--out", place / f"{subject}_task-look_physio.tsv.gz", *screen],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def replays(folder):
    """The numbers of the processes that replay a recording in this folder. A process may end while it is read."""
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
            here = os.readlink(process / "cwd") == str(folder)
        except OSError:
            continue
        if here and len(words) > 3 and words[0].endswith(b"foci") and words[1] == b"replay" and b"--frames" not in words:
            found.append(int(process.name))
    return found


def main():
    if shutil.which("snakemake") is None:
        print("snakemake is not installed: not tested")
        sys.exit(77)  # skipped
    foci = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subjects = ["sub-01", "sub-02", "sub-03"]
        counting = folder / "counting"  # notes each replay of a whole recording that begins
        counting.write_text(f'#!/bin/sh\ncase "$*" in *--frames*) ;; replay*) echo "$4" >> {folder}/begun ;; esac\nexec {foci} "$@"\n')
        counting.chmod(0o755)
        for subject in subjects:
            recording(foci, folder, subject)
        (folder / "study.toml").write_text(STUDY)
        command = ["snakemake", "-s", ROOT / "configs/batch/Snakefile", "--cores", "2", "--nolock", "--config",
                   "bids=data", "study=study.toml", f"foci={counting}"]
        environment = {**os.environ, "XDG_CACHE_HOME": name, "HOME": name}
        workflow = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE,
                                    stderr=subprocess.STDOUT, text=True)
        killed = None
        while killed is None and workflow.poll() is None:
            before = replays(folder)
            time.sleep(0.2)
            running = [process for process in replays(folder) if process in before]
            if running:
                killed = running[0]
                os.kill(killed, signal.SIGKILL)
        output = workflow.communicate(timeout=300)[0]
        assert killed is not None, output
        assert workflow.returncode == 0, output

        # Nothing is lost, and only the killed run was begun twice.
        out = folder / "data/derivatives/foci"
        rows = [line.split("\t") for line in (out / "recordings.tsv").read_text().splitlines()]
        assert [row[0] for row in rows[1:]] == [f"{s}/beh/{s}_task-look_recording-eye1" for s in subjects], rows
        begun = (folder / "begun").read_text().split()
        assert sorted(begun.count(trace) for trace in set(begun)) == [1, 1, 2], begun
        for subject in subjects:
            run = out / subject / "beh" / f"{subject}_task-look_recording-eye1_foci"
            assert (run / "video.mp4").stat().st_size > 0
            assert not list(run.glob(".*.tmp*")), list(run.iterdir())
            events = out / subject / "beh" / f"{subject}_task-look_recording-eye1_physioevents.tsv.gz"
            assert "saccade" in gzip.decompress(events.read_bytes()).decode()

        fixations = [line.split("\t") for line in (out / "fixations.tsv").read_text().splitlines()]
        assert sorted({row[1] for row in fixations[1:]}) == ["01", "02", "03"], fixations
        assert fixations[0].count("subject") == 1 and len({len(row) for row in fixations}) == 1

        # A recording in parts, which are joined, has the same frames.
        subprocess.run([*command, "out=split", "parts=2"], cwd=folder, env=environment, capture_output=True, check=True)
        hashes = [[line.split("\t")[-1] for line in (place / "recordings.tsv").read_text().splitlines()]
                  for place in (out, folder / "split")]
        assert hashes[0] == hashes[1], hashes
        assert not (folder / "split/parts").exists() or not list((folder / "split/parts").rglob("*.png"))

        keyless = [*command[:command.index("--config") + 1], "bids=data"]
        refused = subprocess.run(keyless, cwd=folder, env=environment, capture_output=True, text=True)
        assert refused.returncode == 1 and "expected --config study=" in refused.stderr, refused.stderr

        def started(*words):
            """Recordings whose replay begins when the workflow is started with these words more."""
            (folder / "begun").write_text("")
            subprocess.run([*command, *words], cwd=folder, env=environment, capture_output=True, text=True, check=True)
            return (folder / "begun").read_text().split()

        again = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=True)
        assert "Nothing to be done" in again.stdout + again.stderr, again.stderr
        shutil.rmtree(out / "sub-02" / "beh" / "sub-02_task-look_recording-eye1_foci")
        assert len(started()) == 1
        assert len(started("options=--set observer.pupil_mm=3")) == len(subjects)
        for subject in subjects:
            manifest = json.loads((out / subject / "beh" / f"{subject}_task-look_recording-eye1_foci" / "manifest.json").read_text())
            assert manifest["configuration"]["observer"]["pupil_mm"] == 3, subject
    print("passed")


if __name__ == "__main__":
    main()
