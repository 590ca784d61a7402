"""Opens reports in Chromium, and clicks through them: no script error, light and dark, and the scene is drawn.

    python3 tests/browser/report_test.py build/release/foci
"""

import concurrent.futures
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

from chromium import Chromium, program

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST_BYTES = 15_000_000
QUICK = ["--method", "pinhole", "--size", "64x48", "--set", "output.fps=10", "--set", "output.seconds=[0, 4]"]
# Colours of the scene's canvas, how many there are and a sum of them; after the frame has been drawn.
CANVAS = """new Promise(done => {
  document.getElementById('until-now').dispatchEvent(new Event('change'));
  requestAnimationFrame(() => {
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [view.width, view.height];
    const pen = copy.getContext('2d');
    pen.drawImage(view, 0, 0);
    const all = new Uint32Array(pen.getImageData(0, 0, copy.width, copy.height).data.buffer);
    done([new Set(all).size, all.reduce((sum, one, i) => (31 * sum + one) >>> 0, 0)]);
  });
})"""


def points_ply():
    """A wall, 1 m wide and 1 m away."""
    n = 60
    rows = "".join(f"{(i % n) / n - 0.5} {(i // n) / n - 0.5} -1 {4 * (i % n)} {4 * (i // n)} 90\n" for i in range(n * n))
    names = "".join(f"property {kind} {name}\n" for kind, name in
                    zip(3 * ["float"] + 3 * ["uchar"], ("x", "y", "z", "red", "green", "blue")))
    return f"ply\nformat ascii 1.0\nelement vertex {n * n}\n{names}end_header\n{rows}".encode()


def gaussians_ply():
    """The same wall of opaque Gaussians."""
    n = 40
    names = [*"xyz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", *(f"rot_{k}" for k in range(4))]
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {n * n}\n" + "".join(
        f"property float {name}\n" for name in names) + "end_header\n"
    flat = math.log(0.5 / n)
    return head.encode() + b"".join(
        struct.pack("<14f", (i % n) / n - 0.5, (i // n) / n - 0.5, -1, 2 * (i % n) / n - 1, 2 * (i // n) / n - 1, 0, 4,
                    flat, flat, flat - 3, 1, 0, 0, 0) for i in range(n * n))


def demo(_):
    return [ROOT / "configs" / "demo.toml"]


def eyelink(folder):
    """Two trials, in which gaze jumps each half second. The tracker's clock began long before."""
    rows = []
    for i in range(0, 4000, 4):
        if i % 2000 == 0:
            rows.append(f"MSG\t{9000000 + i} TRIALID {i // 2000 + 1}")
        rows.append(f"{9000000 + i}\t{250 if i // 500 % 2 else 400}.{i % 7}\t{200 + i // 40}.{i % 5}\t500.0\t...")
    (folder / "gaze.asc").write_text(
        "MSG\t9000000 GAZE_COORDS 0.00 0.00 639.00 479.00\nSTART\t9000000 \tLEFT\tSAMPLES\tEVENTS\n"
        "SAMPLES\tGAZE\tLEFT\tRATE\t250.00\n" + "\n".join(rows) + "\nEND\t9004000 \tSAMPLES\tEVENTS\n")
    (folder / "wall.ply").write_bytes(points_ply())
    (folder / "study.toml").write_text("[eye]\nposition_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]\n[screen]\n"
                                       "size_px = [640, 480]\nsize_m = [0.4, 0.3]\ndistance_m = 0.5\n")
    return ["study.toml", "--scene", "wall.ply", "--trace", "gaze.asc"]


def headset(folder):
    """A head that walks sideways, and gaze that rests on one point and then on another."""
    rows = []
    for i in range(450):
        x, target = 0.1 * math.sin(i / 90), (0.2 if i // 100 % 2 else -0.2, 0.1)
        far = math.hypot(target[0] - x, target[1], 1)
        rows.append(f"{i / 100},{x},0,0,0,0,0,1,{(target[0] - x) / far},{target[1] / far},{-1 / far}")
    (folder / "head.csv").write_text("time_s,hx,hy,hz,qx,qy,qz,qw,gx,gy,gz\n" + "\n".join(rows) + "\n")
    (folder / "wall.ply").write_bytes(gaussians_ply())
    (folder / "study.toml").write_text("""[scene]
file = "wall.ply"
[gaze]
source = "head.csv"
time = "time_s"
direction = ["gx", "gy", "gz"]
head_position = ["hx", "hy", "hz"]
head_quaternion = ["qx", "qy", "qz", "qw"]
frame = "world"
axes = "right-up-back"
""")
    return ["study.toml"]


def replay(foci, folder, words):
    done = subprocess.run([foci, "replay", *words(folder), *QUICK, "--out", "out"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / "out" / "report.html"


def place(browser, selector, x, y):
    """A place of an element in the window, shares of its width and height."""
    return browser.run(f"""(() => {{ const one = document.querySelector({selector!r});
      one.scrollIntoView({{ block: 'center' }});
      const box = one.getBoundingClientRect();
      return [box.left + {x} * box.width, box.top + {y} * box.height]; }})()""")


def drag(browser, start, end):
    browser.mouse("Moved", *start)
    browser.mouse("Pressed", *start, button="left", buttons=1, clickCount=1)
    if end != start:
        browser.mouse("Moved", *end, button="left", buttons=1)
    browser.mouse("Released", *end, button="left", clickCount=1)


def click_through(browser, trials):
    def time_s():
        return browser.run("video.currentTime")

    start = place(browser, "#view", 0.5, 0.5)
    before = browser.run(CANVAS)
    assert browser.run(CANVAS) == before, "the scene changes by itself"
    drag(browser, start, [start[0] + 150, start[1] + 40])
    assert browser.run(CANVAS) != before, "dragging does not turn the scene"
    middle = place(browser, "#when", 0.5, 0.5)
    drag(browser, middle, middle)
    assert 1.5 < time_s() < 2.5, f"the slider's middle moved the video to {time_s()} s"
    at = browser.run("+document.querySelector('tr.seek').dataset.at - run.first")
    row = place(browser, "tr.seek td", 0.5, 0.5)
    drag(browser, row, row)
    assert abs(time_s() - max(0, at)) < 1e-3, f"a fixation at {at} s moved the video to {time_s()} s"
    browser.run("timed.value = 'zero'; timed.dispatchEvent(new Event('change'))")
    zero = browser.run("+document.querySelector('tr.seek [data-time]').textContent")
    assert abs(zero - at) < 1e-3, f"a fixation at {at} s stands at {zero} s"
    axis = browser.run("ticks.filter(one => one.low > lowestTick - 3).map(one => +one.word.textContent)")
    assert axis and 0 <= min(axis) <= max(axis) <= 5, f"the axis from zero has {axis}"
    browser.run("document.getElementById('heat-on').click()")
    assert browser.run(CANVAS) != before and browser.run("byId('heat-most').textContent > 0"), "no heat"
    assert trials == browser.run("picked ? picked.length - 1 : 0"), "the trials"
    if trials:
        browser.run("picked.selectedIndex = 2; picked.dispatchEvent(new Event('change'))")
        hidden, all_rows = browser.run("['tr[hidden].seek', 'tr.seek'].map(one => document.querySelectorAll(one).length)")
        assert 0 < hidden < all_rows, f"a trial hides {hidden} of {all_rows} fixations"
        assert 1.9 < time_s() < 2.1, f"trial 2 begins at {time_s()} s"


def started():
    try:
        return Chromium()
    except (OSError, TimeoutError) as problem:
        print(f"chromium does not start here: {problem}: not tested")
        sys.exit(77)  # skipped


def main():
    if program() is None:
        print("chromium is not installed: not tested")
        sys.exit(77)  # skipped
    foci = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as name, started() as browser:
        kinds = (demo, eyelink, headset)
        folders = [pathlib.Path(name, kind.__name__) for kind in kinds]
        for folder in folders:
            folder.mkdir()
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            pages = list(pool.map(replay, 3 * [foci], folders, kinds))
        for kind, page in zip(kinds, pages):
            assert page.stat().st_size < MOST_BYTES, f"{kind.__name__}: {page.stat().st_size} bytes"
            for dark in (False, True):
                browser.open(page, dark)
                colors, _ = browser.run(CANVAS)
                assert colors > 100, f"{kind.__name__}: the scene has {colors} colours"
                assert browser.run("document.querySelectorAll('svg.plan').length") == 2
                if not dark:
                    click_through(browser, 2 if kind is eyelink else 0)
                assert not browser.errors, f"{kind.__name__}: {browser.errors}"
            print(f"{kind.__name__}: {page.stat().st_size / 1e6:.1f} MB, {colors} colours in the scene")


if __name__ == "__main__":
    main()
