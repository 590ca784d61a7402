"""Every command of README.md and docs runs as it is written, in a copy of configs/sample:

    python3 tests/e2e/documents_test.py build/release/foci [PAGE]
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]

# Commands that are not run here, and why. A command is left out if it begins so.
LEFT_OUT = {
    "foci live ": "needs a display; the tests of the windows run it",
    "foci calibrate screen --out": "needs a person",
    "foci calibrate gaze --screen": "needs a person",
    "foci calibrate camera --device": "needs a camera",
    "foci calibrate camera --images": "needs pictures of a board; its unit tests make them",
    "foci calibrate gaze --source webcam:eyes.mp4": "needs a film of a face",
    "foci replay study.toml --trace webcam:eyes.mp4": "needs a film of a face",
    "foci webcam eyes.mp4": "needs a film of a face",
    "foci chart ": "takes minutes; chart_test.cpp runs it on one scene",
    "foci reproduce ": "takes minutes; reproduce_test.cpp runs a short version",
    "foci validate ": "takes a minute; eye_test.cpp runs it",
    "foci trace info generalized_gaze.csv": "needs the public recording",
    "foci replay global_points.csv.gz": "needs the public recording",
}
# A command that needs what one before it would have made by hand.
FIRST = {
    "foci replay study.toml --screen screen.toml --gaze-map map.toml":
        "foci calibrate screen --headless --size-px 1920x1080 --card-px 309x195 --distance-m 0.6 --out screen.toml && "
        "foci calibrate gaze --pairs fit.tsv --units deg --screen screen.toml --out map.toml",
}


def commands(page):
    text = page.read_text().replace("\\\n", " ")
    for line in re.findall(r"^    (foci .*)$", text, re.M):
        yield re.sub(r" +", " ", line.split(" #")[0]).strip()


def main():
    foci = pathlib.Path(sys.argv[1]).resolve()
    chosen = [page for page in PAGES if len(sys.argv) < 3 or page.name == sys.argv[2]]
    unused, failed, ran = set(LEFT_OUT) | set(FIRST), [], 0
    with tempfile.TemporaryDirectory() as temporary:
        tools = pathlib.Path(temporary) / "bin"
        tools.mkdir()
        (tools / "foci").symlink_to(foci)
        environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "XDG_CACHE_HOME": temporary}
        for page in chosen:
            folder = pathlib.Path(temporary) / page.stem
            shutil.copytree(ROOT / "configs/sample", folder)

            def run(command):
                return subprocess.run(["bash", "-c", command], cwd=folder, env=environment, text=True, timeout=120,
                                      capture_output=True)

            for command in commands(page):
                left_out = next((start for start in LEFT_OUT if command.startswith(start)), None)
                unused.discard(left_out)
                if left_out:
                    continue
                before = FIRST.get(command)
                unused.discard(command)
                begin = time.monotonic()
                done = run(before) if before else None
                if not done or done.returncode == 0:
                    done = run(command)
                ran += 1
                print(f"{page.name}: {command}  {time.monotonic() - begin:.1f} s", flush=True)
                if done.returncode != 0:
                    failed.append(f"{page.name}: {command}: exit code {done.returncode}\n{done.stderr}")
    print("\n".join(failed))
    if unused and chosen == PAGES:
        failed.append("")
        print(f"no document has these commands any more: {sorted(unused)}")
    print(f"{ran} commands, {len(failed)} faults")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
