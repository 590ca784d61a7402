#!/usr/bin/env python3
"""Measures foci and writes docs/results.md, with machine, date and commit of each section.

    python3 docs/results.py                        short runs of everything, on an idle machine
    python3 docs/results.py --full                 the full chart, stability suite and reproduction
    python3 docs/results.py --only bench,chart     some sections; the page keeps the others as they are
    python3 docs/results.py --labelled DIR/*.tsv   agreement with human coders, on recordings with columns coder_NAME
    python3 docs/results.py --faces DIR            the webcam on marked faces (tests/unit/gaze/webcam/real_faces_test.cpp)
    python3 docs/results.py --large SCENE.foci [--cgroup DIR]
                                                   a landscape of foci_large_scene, in a memory cgroup with a limit

Expects a release build with tests (cmake --preset release && cmake --build --preset release). The section "live" needs
a display or xvfb-run. The measurements stay in out/results; `foci chart` continues from them.
"""

import argparse
import csv
import datetime
import json
import math
import os
import re
import shutil
import socket
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
GPU_STAGES = ("cut", "project", "bin", "sort", "composite", "present")
PAGE = os.path.join(ROOT, "docs", "results.md")
BENCH_LEFT_OUT = re.compile(r"Label(Off|On)line/60|SurfelsOfRandomSphere/10000000|threads:1|Frame/[a-z]*/pinhole|SampleMesh/(3|1000)|SweepPlane/blur_dpx:(0|114)|/256px|/25cm|FirstFrame.*/8mm")  # rows that the page does without
CURVE = (0.3, 0.5, 0.7, 0.8, 0.9, 0.95)  # probabilities whose share of right labels the page shows
SECTIONS = ("bench", "trained_events", "event_rules", "live", "chart", "motion", "peers", "growth", "stability", "reproduce", "eye", "webcam", "large", "python")


def run(*command):
    """Standard output of a command; its progress goes to the terminal."""
    print("+", " ".join(command), file=sys.stderr)
    return subprocess.run(command, check=True, cwd=ROOT, stdout=subprocess.PIPE, text=True).stdout


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def short(text, digits=3):
    """A number with few digits; other text unchanged."""
    try:
        value = float(text)
    except (TypeError, ValueError):
        return text
    if abs(value) >= 1000:
        return f"{value:.0f}"
    return f"{value:.{digits}g}"


def stamp(foci):
    """One line: machine, date, commit."""
    machine = json.loads(run(foci, "doctor", "--json"))
    commit = run("git", "rev-parse", "--short", "HEAD").strip()
    if run("git", "status", "--porcelain", "--untracked-files=no").strip():
        commit += " with local changes"
    date = datetime.date.today().isoformat()
    load = os.getloadavg()[0]
    return f"*{date}, commit {commit}: {machine['cpu']}, {machine['threads']} threads, {machine['simd']}; load {load:.1f}.*"


def bench(args):
    counters = ("median_rendered_ms", "p95_rendered_ms", "rendered", "error")
    measured = json.loads(run(args.bench, "--benchmark_format=json", f"--benchmark_filter={args.bench_filter}"))
    gallery, frames, others, no_gpu = [], [], [], None
    for one in measured["benchmarks"]:
        name = re.sub(r"BM_|/iterations.*|/real_time.*", "", one["name"])
        if one.get("error_occurred") and name.startswith("GpuFrame"):
            no_gpu = one["error_message"]
        if one.get("error_occurred") or one.get("run_type") == "aggregate" or BENCH_LEFT_OUT.search(name):
            continue
        if "splats_per_px" in one:
            device_ms = sum(one[stage + "_ms"] for stage in GPU_STAGES) if "present_ms" in one else None
            frames.append(f"`{name}` {short(one['median_ms'])}" + ("" if device_ms is None else f" ({short(device_ms)})"))
        elif "p95_ms" in one:
            gallery.append([f"`{name}`"] + [short(one.get(counter, "n/a")) for counter in counters])
        else:
            name = re.sub(r"/(process_time|min_warmup_time).*", "", name)
            others.append(f"`{name}` {short(one['real_time'])} {one['time_unit']}")
    text = ["`foci_bench`, wall-clock times."]
    if gallery:
        text.append("**A study's frame**: six seconds of gaze over the gallery of two million surfels, 1920 x 1080 px, method "
                    "`auto`. Times are those of rendered frames.")
        text.append(table(["run", "median, ms", "95 %, ms", "share rendered", "predicted error, JND"], gallery))
    if frames:
        text.append("**One frame**: scene, method, width of the image, focus, pupil; the median, ms" +
                    (f". There was no GPU ({no_gpu})" if no_gpu else ", and the GPU's own time in brackets") +
                    ". `FirstFrame` is that of a new renderer on a loaded scene. " + ", ".join(frames) + ".")
    if others:
        text.append("**Others**: " + ", ".join(others) + ".")
    return "\n\n".join(text)


# Figure of observers left out (hmr: set left out), kinds whose mean counts, columns, key, goals.
EVENT_GOALS = (
    ("kappa, dots", ("dots",), ("offline", "online"), "stable", (0.81, 0.80)),
    ("kappa, pictures", ("img",), ("offline", "online"), "stable", (0.88, 0.875)),
    ("kappa, videos", ("video",), ("offline", "online"), "stable", (0.885, 0.88)),
    ("kappa, irf", ("irf",), ("offline", "online"), "stable", (0.905, 0.90)),
    ("kappa, gazecom", ("gazecom",), ("offline", "online"), "stable", (0.815, 0.81)),
    ("kappa, hmr", ("hmr",), ("offline", "online"), "stable", (0.70, 0.69)),
    ("kappa, dots, pictures and videos", ("dots", "img", "video"), ("60 Hz", "120 Hz"), "stable", (0.79, 0.852)),
    ("kappa, irf", ("irf",), ("60 Hz", "120 Hz"), "stable", (0.77, 0.845)),
    ("kappa, gazecom", ("gazecom",), ("60 Hz", "120 Hz"), "stable", (0.785, 0.796)),
    ("F1 of fixations, gazecom", ("gazecom",), ("offline", "online"), "fixation_f1", (0.90, 0.81)),
    ("F1 of saccades, gazecom", ("gazecom",), ("offline",), "saccade_f1", (0.67,)),
    ("F1 of pursuit, gazecom", ("gazecom",), ("offline",), "pursuit_f1", (0.64,)),
    ("F1 of fixations, pictures", ("img",), ("offline", "online"), "fixation_f1", (0.93, 0.78)),
    ("F1 of saccades, pictures", ("img",), ("offline",), "saccade_f1", (0.935,)))


def event_goals(json_):
    def reached(kinds, column, key):
        group = "set_left_out" if kinds == ("hmr",) else "observers_left_out"
        return sum(json_[group][kind][column][key] for kind in kinds) / len(kinds)

    missed = []
    for name, kinds, columns, key, goals in EVENT_GOALS:
        for column, goal in zip(columns, goals):
            value = round(reached(kinds, column, key), 3)
            if value < goal:
                missed.append(f"{name}, {column} {short(value)} (goal {short(goal)})")
    count = sum(len(goals) for *_, goals in EVENT_GOALS)
    listed = ": " + "; ".join(missed) if missed else ""
    return f"{len(missed)} of {count} goals are missed with observers left out (hmr: set left out){listed}."


def trained_events(args):
    if not args.labelled:
        return None
    folder = os.path.dirname(os.path.dirname(args.labelled[0]))
    model, figures = (os.path.join(args.out, name) for name in ("trained.model", "trained.json"))
    run(os.path.join(args.build, "foci_train_events"), folder, "--out", model, "--json", figures)
    with open(figures, encoding="utf-8") as file:
        json_ = json.load(file)
    columns = ("offline", "online", "60 Hz", "120 Hz")

    def cell(group, kind, column, key):
        value = json_[group].get(kind, {}).get(column, {}).get(key)
        return "" if value is None else short(value)

    def cells(group, kind, columns, keys):
        found = [cell(group, kind, column, key) or "-" for column in columns for key in keys]
        return ", ".join(found) if kind in json_[group] else ""

    keys, groups = ("fixation_f1", "saccade_f1", "pursuit_f1"), ("set_left_out", "observers_left_out")
    kinds = list(json_["set_left_out"])
    kappas = table(["recordings", "set left out", "observers left out", "coders"],
                   [[kind] + [cells(group, kind, columns, ("stable",)) for group in groups] +
                    [cell("coders", kind, "coders", "stable")] for kind in kinds])
    scores = table(["recordings"] + [f"{group.replace('_', ' ')}, {column}" for group in groups for column in columns[:2]],
                   [[kind] + [cells(group, kind, (column,), keys) for group in groups for column in columns[:2]]
                    for kind in kinds])

    def right(name, stated):
        """The curve at a probability, straight between its points."""
        curve = json_["calibration"][name]
        for (x0, y0), (x1, y1) in zip(curve, curve[1:]):
            if x0 <= stated <= x1:
                return short(y0 + (y1 - y0) * (stated - x0) / (x1 - x0), 2)
        return short(curve[0 if stated < curve[0][0] else -1][1], 2)

    curve = [[stated, right("offline", stated), right("online", stated)] for stated in CURVE]
    return ("`foci_train_events` trains the detector `trained` without one data set, and labels that one: *set left out*. "
            "*Observers left out*: without a third of the set's observers. Cohen's kappa of stable gaze offline, online, and "
            "offline at 60 and 120 Hz, mean over the coders; *coders* is their agreement with each other.\n\n" +
            kappas + "\n\n**F1 of events** (fixations, saccades, pursuit): two events agree if they "
            "share more than half of their union.\n\n" + scores + "\n\n**Confidence**: the probability of a label, and the "
            "share of such labels that are right on sets left out, with equal weight for each set. The curve from the trees' "
            "output to the probability is that of the other sets.\n\n" +
            table(["probability", "right, offline", "right, online"], curve) + "\n\n" + event_goals(json_) +
            " In videos of outdoor scenes (gazecom), a fixation that drifts looks like slow pursuit: most pursuits that foci "
            "finds are not the coders'. At 120 Hz a small saccade has two or three samples.")


def event_rules(args):
    if not args.labelled:
        return None
    data = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(args.labelled[0]))))
    program = os.path.join(args.build, "foci_event_rules")
    kappas, _, held_out = run(program, data).strip().split("\n\n")
    rows = [line.rsplit(None, 9) for line in kappas.splitlines()[2:] + held_out.splitlines()]
    return ("`foci_event_rules` chooses the constants of `EventRules` on all labelled recordings but one, and labels that one. "
            "The rows *held out* pool these labels: Cohen's kappa, mean over the coders. The search begins at the defaults, "
            "which were chosen on the same recordings, so these rows are upper bounds. A few long intervals decide the kappa of "
            "pursuit: expect the held-out figure.\n\n" +
            table(["", *(f"{what}: {kind}" for what in ("stable", "saccades") for kind in ("images", "dots", "video", "irf")),
                   "pursuit: all"], [[cell.strip() for cell in row] for row in rows]))


def live(args):
    command = [args.foci, "live", "configs/demo.toml", "--window", "--size", args.live_size, "--source", "trace:simulated",
               "--socket", "0", "--json"]
    if not os.environ.get("DISPLAY"):
        if not shutil.which("xvfb-run"):
            return None
        command = ["xvfb-run", "-a", "-s", "-screen 0 1920x1080x24"] + command
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command[command.index("--socket") + 1] = str(port)
    folder = os.path.join(args.out, "live")
    shutil.rmtree(folder, ignore_errors=True)
    command += ["--record", folder]
    print("+", " ".join(command), file=sys.stderr)
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as foci, \
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as remote:
        remote.settimeout(1)
        remote.connect(("127.0.0.1", port))
        for _ in range(120):  # until the first frame is there
            try:
                remote.send(b"state")
                if remote.recv(4096).startswith(b"ok"):
                    break
            except OSError:
                time.sleep(0.5)
        time.sleep(args.live_s)
        remote.send(b"leave")
        summary = json.loads(foci.communicate(timeout=120)[0].strip().splitlines()[-1])
    flat = []

    def flatten(prefix, value):
        for name, inner in value.items():
            if isinstance(inner, dict):
                flatten(f"{prefix}{name}.", inner)
            elif isinstance(inner, (int, float)):
                flat.append(f"`{prefix}{name}` {short(inner)}")

    flatten("", summary)
    return (f"`foci live configs/demo.toml --window --size {args.live_size}` for {args.live_s:.0f} s, with the simulated observer as "
            "source. Summary of `--json`: " + ", ".join(flat) + ".")


def chart(args):
    folder = os.path.join(args.out, "chart")
    run(args.foci, "chart", "--out", folder, *args.quick, *args.chart_options)
    rows = rows_of(os.path.join(folder, "chart.csv"))
    threads = max(int(row["threads"]) for row in rows)
    text = [f"`foci chart` at the largest blur of each scene: ms per frame at {threads} threads, PSNR in dB, and in JND the "
            "visible error (of `auto`, also its prediction). In an empty cell, another method is both faster and closer. Beside "
            "the scene stands the PSNR to which its reference is known ([methods.md](methods.md#chart-time-against-accuracy))."]
    largest, cells, ms = {}, {}, {}
    for row in rows:
        largest[row["scene"]] = max(largest.get(row["scene"], 0.0), float(row["blur_px"]))
    for row in rows:
        if int(row["threads"]) == threads and float(row["blur_px"]) == largest[row["scene"]] and \
                (row["on_frontier"] == "yes" or row["method"] == "auto"):
            method = "`" + row["method"] + ("" if row["setting"] == "n/a" else ":" + row["setting"]) + "`"
            predicted = "" if row["expected_error"] == "n/a" else f" ({short(row['expected_error'])})"
            place = f"{row['scene']}, {short(row['blur_px'])} px, {short(row['reference_psnr_dB'])} dB"
            cells.setdefault(place, {})[method] = ", ".join(
                short(row[name]) for name in ("ms_median", "psnr_dB", "visible_error")) + predicted
            ms.setdefault(method, []).append(float(row["ms_median"]))
    methods = sorted((method for method in ms if len(ms[method]) > 1), key=lambda method: sum(ms[method]) / len(ms[method]))
    text.append(table(["scene"] + methods, [[place] + [found.get(method, "") for method in methods]
                                            for place, found in cells.items()]))
    if not args.chart_options:
        shutil.copy(os.path.join(folder, "chart.png"), os.path.join(ROOT, "docs", "chart.png"))
    return "\n\n".join(text)


MOTION_GOALS = {"head-1mm": 0.01, "head-10mm": 0.01, "focus": 0.005}  # excess change, for 99.9 % of the pixels


def motion(args):
    folder = os.path.join(args.out, "motion")
    run(args.foci, "chart", "--motion", "--method", "auto", "--out", folder, *args.quick)
    worst = {}
    for row in rows_of(os.path.join(folder, "motion.csv")):
        excess, path = float(row["light_worst"]), row["path"]
        if row["method"] == "auto":
            worst.setdefault(row["scene"], {}).setdefault(path, []).append(excess)  # then within the budget

    def text(path, excess):
        return ", ".join(f"**{short(one, 2)}**" if one > MOTION_GOALS[path] else short(one, 2) for one in excess)

    return (f"`{' '.join(['foci chart --motion --method auto', *args.quick])}`: worst excess change in light, then within half of the time ([methods.md](methods.md#motion)); bold "
            f"exceeds {MOTION_GOALS['head-1mm']} (head) or {MOTION_GOALS['focus']} (focus).\n\n" +
            table(["scene", *MOTION_GOALS], [[f"`{scene}`"] + [text(path, found[path]) for path in MOTION_GOALS]
                                             for scene, found in worst.items()]))


def peers(args):
    cells, renderers, cases = {}, {}, []
    for scene, size in (("ball", "320"), ("garden", "200")):
        exported, out = (os.path.join(args.out, "peers", scene, name) for name in ("cases", "chart"))
        chart = (args.foci, "chart", "--quick", "--size", size, "--scene", scene, "--overwrite")
        run(*chart, "--export", exported)
        run(sys.executable, os.path.join(ROOT, "tests", "peers", "peers.py"), exported, "--samples", "64", "256")
        run(*chart, "--import", exported, "--out", out, *(word for name in ("pinhole", "auto") for word in ("--method", name)))
        rows = rows_of(os.path.join(out, "chart.csv"))
        largest = max(float(row["blur_px"]) for row in rows)
        cases.append(f"{scene}, {short(largest)} px")
        for row in rows:
            if float(row["blur_px"]) != largest:
                continue
            method = row["method"]
            if row["renderer"] != "n/a":
                renderers[method.split(":")[0]] = row["renderer"].rsplit(", ", 2)[0]  # without this machine
            cells.setdefault(method, {})[cases[-1]] = ", ".join(short(row[name]) for name in ("ms_median", "psnr_dB", "flip"))
    versions = "; ".join(f"`{name}`: {version}" for name, version in renderers.items())
    return ("`tests/peers/peers.py` "
            "([methods.md](methods.md#other-renderers)): ms, PSNR in dB, FLIP. `game-blur` gathers from one sharp image with its "
            "depth, in Python. `Spark` blurs as `inflate:spark` (with half the aperture, by the disc's variance), "
            f"and its 8 bits lose faint Gaussians. `PlayCanvas` has no lens. {versions}.\n\n" +
            table(["renderer"] + cases, [[f"`{name}`"] + [found.get(case, "") for case in cases] for name, found in cells.items()]))


def growth(args):
    command = (args.foci, "chart", "--growth", "--json", "--overwrite", "--out", os.path.join(args.out, "growth"))
    exponents, times = {}, {}
    for curve in json.loads(run(*command, *args.quick, *args.growth_options))["curves"]:
        method, axis, kind = re.fullmatch("(.*) over (.*), (.*)", curve["curve"]).groups()
        if method != "auto":
            continue
        bend = curve["bend"]
        exponents.setdefault(axis, []).append(f"{kind} {curve['exponent']:.2f}" + (
            f" ({bend['before']:.2f}, from {short(bend['at'], 2)} on {bend['after']:.2f})" if bend else ""))
        times[axis, kind] = {point["size"]: point["cpu_ms_median"] for point in curve["points"]}
    (n, ms), (more, more_ms) = list(times["splats", "surfels"].items())[-2:]
    tenfold = (more_ms / ms) ** (math.log(10) / math.log(more / n))
    blur = times["blur", "surfels"]
    return (f"`{' '.join(['foci chart --growth', *args.quick, *args.growth_options])}`: exponents of the time of `auto` "
            "([methods.md](methods.md#how-cost-grows)). " +
            "; ".join(f"{axis}: {', '.join(texts)}" for axis, texts in exponents.items()) +
            f". At the largest scenes, ten times the surfels cost {short(tenfold)} times the frame (goal: 1.15). 128 px of blur "
            f"on the plane cost {short(blur[128] / blur[16])} times 16 px (goal: 1).")


def stability(args):
    folder = os.path.join(args.out, "stability")
    run(args.foci, "chart", "--stability", "--out", folder, *args.quick, *args.stability_options)
    images = ("auto", "sweep-lod:7")
    scenes = {}
    for row in rows_of(os.path.join(folder, "stability.csv")):
        scene = scenes.setdefault(row["scene"], {"values": [], "scores": {}})
        if row["value"] not in scene["values"]:
            scene["values"].append(row["value"])
        bold = "" if row["good"] == "yes" else "**"
        scene["scores"].setdefault(row["method"], {})[row["value"]] = bold + short(row["score"]) + bold
    text = ["`foci chart --stability`. Scores follow the dial's values from left to right; a bold score misses the wanted one "
            "([stability.md](stability.md))."]
    for observers, title in ((False, "Images"), (True, "Gaze")):
        chosen = {name: scene for name, scene in scenes.items() if name.startswith("gaze-") == observers}
        if not chosen:
            continue
        methods = [name for name in images if any(name in scene["scores"] for scene in chosen.values())] if not observers else \
            list(dict.fromkeys(name for scene in chosen.values() for name in scene["scores"]))
        cells = {name: ["; ".join(scene["scores"].get(method, {}).get(value, "n/a") for value in scene["values"])
                        for method in methods] for name, scene in chosen.items()}
        good = [name for name in cells if not any("**" in cell for cell in cells[name])]
        text.append(f"**{title}**" + (". All scores are good in: " + ", ".join(f"`{name}`" for name in good) + "." if good else ""))
        text.append(table(["scene", "dial"] + [f"`{name}`" if not observers else name for name in methods],
                          [[f"`{name}`", ", ".join(map(short, chosen[name]["values"]))] + cells[name]
                           for name in cells if name not in good]))
    return "\n\n".join(text)


def reproduce(args):
    folder = os.path.join(args.out, "reproduce")
    shutil.rmtree(folder, ignore_errors=True)
    run(args.foci, "reproduce", "--out", folder, *args.quick)
    rows = rows_of(os.path.join(folder, "table1.csv"))
    threads = max(int(row["threads"]) for row in rows)
    cells = {}
    for row in rows:
        if int(row["threads"]) == threads and float(row["aperture"]) > 0.0:
            place = f"{row['scene']}, {short(row['aperture'])} m, {short(row['blur_px_max'])} px"
            cells.setdefault(place, {})["`" + row["method"] + "`"] = ", ".join(
                short(row[name]) for name in ("kfragments", "points", "ms_median", "psnr_dB"))
    methods = [method for method in next(iter(cells.values())) if method != "`accumulate:200`"]
    return (f"`foci reproduce`, 512 x 512 px: thousands of fragments, points, ms at {threads} threads, and PSNR in dB "
            "([reproduce.md](reproduce.md)).\n\n" +
            table(["scene, aperture, blur"] + methods, [[place] + [found.get(method, "") for method in methods]
                                                        for place, found in cells.items()]))


def eye(args):
    folder = os.path.join(args.out, "eye")
    os.makedirs(folder, exist_ok=True)
    study = os.path.join(folder, "study.toml")
    with open(study, "w", encoding="utf-8") as file:
        file.write("[scene]\nbuiltin = \"gallery\"\n")
    times = []
    for pupil_mm, focus_m in ((3, 0.6), (6, 0.4), (6, 0.6), (6, 5.0)):
        ms = {"null": [], "40": []}
        for _ in range(4):
            for age, taken in ms.items():
                summary = json.loads(run(args.foci, "render", study, "--size", "960x540", "--method", "sweep:19", "--pupil",
                                         str(pupil_mm), "--focus", str(focus_m), "--set", f"observer.age_years={age}", "--json",
                                         "--overwrite", "--out", os.path.join(folder, "image.pfm")))
                taken.append(summary["render_ms"])
        plain_ms, typical_ms = min(ms["null"]), min(ms["40"])
        times.append([pupil_mm, focus_m, short(plain_ms), short(typical_ms), short(typical_ms / plain_ms)])
    listed = os.path.join(folder, "psf.json")
    run(os.path.join(args.build, "foci_tests"), "--gtest_filter=SplattedPsf.*", f"--gtest_output=json:{listed}")
    with open(listed, encoding="utf-8") as file:
        case = json.load(file)["testsuites"][0]["testsuite"][0]
    images = [[name.removeprefix("psf_").replace("_", " ")] + value.split() for name, value in case.items()
              if re.match(r"psf_\d mm, (-1|0|1) D", name)]
    validation = os.path.join(folder, "validation")
    run(args.foci, "validate", "--overwrite", "--out", validation)
    with open(os.path.join(validation, "validation.tsv"), newline="", encoding="utf-8") as file:
        figures = list(csv.DictReader(file, delimiter="\t"))
    worst = {}
    for one in figures:
        one["off"] = abs(float(one["value"]) / float(one["expected"]) - 1.0)
        worst[one["figure"]] = max(worst.get(one["figure"], one), one, key=lambda each: each["off"])
    return "\n\n".join([
        "**Time of an eye with aberrations**: the gallery by `sweep:19` at 960 x 540 px, a typical eye of 40 years against one "
        "without aberrations. Each time is the shortest of four alternating runs.",
        table(["pupil, mm", "focus, m", "without, ms", "with, ms", "ratio"], times),
        "**A rendered point of light against Fourier optics**, typical eye, `sweep:19` with diffraction, pixels of 1 arcmin. "
        "The root mean square is a share of the peak: over a window of 65 arcmin, and over the pixels of at least 1 % of the "
        "peak. Errors of the variance are those within the disc that holds all rays.",
        table(["pupil and defocus", "RMS, window, %", "RMS, lit pixels, %", "variance along x, %", "along y, %"], images),
        "**Against published measurements**, `foci validate`: of each figure, the condition that differs most.",
        table(["figure", "condition", "published", "here", "unit"],
              [[name, one["condition"], short(one["expected"]), short(one["value"]), one["unit"]]
               for name, one in worst.items()])])


def webcam(args):
    """Real faces: where the irises are. Rendered faces: irises, and gaze in degrees."""
    if not args.faces:
        return None
    os.environ["FOCI_FACES"] = args.faces
    cases = {}
    for program, tests in (("foci_tests", "RealFaces.*:HardFaces.*"), ("foci_e2e", "Webcam.DISABLED_DegreesOfHardFaces")):
        listed = os.path.join(args.out, f"{program}.json")
        run(os.path.join(args.build, program), "--gtest_also_run_disabled_tests", f"--gtest_output=json:{listed}", f"--gtest_filter={tests}")
        with open(listed, encoding="utf-8") as file:
            cases |= {case["name"]: case for suite in json.load(file)["testsuites"] for case in suite["testsuite"]}
    real, moved = cases["AreFoundAndTheirIrises"], cases["MovedAboutTheirIrisesHaveLittleScatter"]
    judged = cases["ConfidenceIsTheShareOfRightIrises"]
    cascades, networks = cases["TheCascadesGetHalfOfTheIrises"], cases["TheNetworksHalveTheMisses"]

    def of(kind, part, whole):
        return f"{real.get(f'{kind}_{part}', 0)} of {real[f'{kind}_{whole}']}" if f"{kind}_{whole}" in real else "-"

    ms = []
    for name in sorted(os.listdir(args.faces)):
        if name.endswith(".mp4"):
            summary = json.loads(run(args.foci, "webcam", os.path.join(args.faces, name), "--json"))
            ms.append(f"{name}: {summary['ms_median']:.0f} ms a frame, 95 % below {summary['ms_95']:.0f} ms")
    hard = sorted(key for key in networks if key.startswith("hard_"))
    total = [sum(int(case[key].split()[i]) for key in hard) for case in (cascades, networks) for i in range(3)]
    degrees = [(key.removeprefix("degrees_").replace("_", " "), [float(value) for value in text.split()])
               for key, text in cases["DISABLED_DegreesOfHardFaces"].items() if key.startswith("degrees_")]
    return "\n\n".join([
        "**Real faces**: photographs and a video of public repositories. People checked marks that the networks had proposed, so "
        "the counts are not independent. An iris is right within a quarter of its diameter.",
        table(["", "photographs", "video"],
              [[title] + [of(kind, part, whole) for kind in ("photographs", "video")] for title, part, whole in (
                  ("largest face found", "found", "faces"), ("irises right", "right", "irises"),
                  ("irises wrong", "wrong", "irises"), ("irises in shut eyes", "irises_in_shut", "shut"),
                  ("faces where there is none", "false_faces", "without_face"))] +
              [["median error, iris diameters"] + [short(real.get(f"{kind}_median_error", "-"), 2)
                                                   for kind in ("photographs", "video")]]),
        "Time with networks, one face: " + "; ".join(ms) + ".",
        "The same portraits **moved about**, by up to half a face from frame to frame, with irises of 12 pixels: both irises are "
        f"right in {short(moved['moved_both_right'])} % of the frames. One eye's direction scatters by "
        f"{short(moved['moved_scatter_across_deg'], 2)} degrees across and {short(moved['moved_scatter_down_deg'], 2)} down.",
        "**Confidence** against the share of right irises, on the portraits made smaller, darker, blurred, noisy or partly "
        "covered. The curve for each file was fitted to the other files.",
        table(["confidence", "share right", "irises"],
              [[short(confidence, 2), short(right, 2), count] for confidence, right, count in
               (judged[key].split() for key in sorted(judged) if re.match(r"confidence_\d", key))]),
        "**Rendered faces as hard as real ones** (`tests/faces`): lashes, shaded corners, narrow lids and uneven light in all of "
        "them, and one difficulty more. Irises right, wrong, all.",
        table(["difficulty", "without networks", "with networks"],
              [[key.removeprefix("hard_").replace("_", " ")] + [f"{right}, {wrong}, {count}" for right, wrong, count in
                                                                (case[key].split() for case in (cascades, networks))]
               for key in hard] + [["all"] + [", ".join(str(n) for n in total[i:i + 3]) for i in (0, 3)]]),
        "**Gaze in degrees**, on films of two of these rendered people, by `foci calibrate gaze --source webcam:FILM --pairs FIT "
        "--validate OTHER --screen SCREEN --json`: nine targets to fit, mean error on four others, across and down. Beside it are "
        "the same map on the true irises, and the middle of the targets as a guess. No recordings of real faces with known gaze were to be had.",
        table(["condition", "gaze found, %", "error", "on true irises", "middle as guess"],
              [[name, short(100 * values[0])] + [f"{values[i]:.1f}, {values[i + 1]:.1f}" for i in (1, 3, 5)]
               for name, values in degrees])])


# The eye's place and the point that it looks at, metres. The ground is about 1.6 m high in the middle.
LARGE_VIEWS = (("the whole landscape", (0, 150, 200), (0, 0, 0)), ("from 40 m above", (0, 42, 0), (0, 0, -40)),
               ("the ground in front", (0, 3.2, 0), (0, 1.6, -3)),
               ("along the ground to the horizon, from a hill", (20, 6.8, 48), (10, 4, -60)))


def large(args):
    """First frames, later frames and memory of each view."""
    if not args.large:
        return None

    enter = (lambda: open(os.path.join(args.cgroup, "cgroup.procs"), "w").write(str(os.getpid()))) if args.cgroup else None

    def forget():
        with open(args.large, "rb") as file:
            os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)

    def measured(*command):
        """Seconds and the peak of resident memory, GB."""
        start = time.monotonic()
        process = subprocess.Popen(command, cwd=args.out, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=enter)
        _, status, usage = os.wait4(process.pid, 0)
        if status:
            sys.exit(f"{' '.join(command)}: ended with {os.waitstatus_to_exitcode(status)}")
        return time.monotonic() - start, usage.ru_maxrss * 1024 / 1e9

    rows = []
    for name, eye, at in LARGE_VIEWS:
        study, folder = os.path.join(args.out, "large.toml"), os.path.join(args.out, "large")
        with open(study, "w", encoding="utf-8") as file:
            keyframes = [f"{{ time_s = {time_s}, position_m = {[eye[0], eye[1], eye[2] - time_s]}, look_at_m = {list(at)} }}"
                         for time_s in (0, 1)]  # forwards by a metre a second
            file.write(f'[scene]\nfile = "{args.large}"\n[eye]\nup = [0, 1, 0]\npath = [{", ".join(keyframes)}]\n'
                       '[render]\ndevice = "cpu"\n[output]\nsize_px = [1920, 1080]\nfps = 10\nseconds = [0, 1]\n')
        first = (args.foci, "render", study, "--gaze", "960,700", "--out", "large.png", "--overwrite")
        forget()
        cold, warm = measured(*first), measured(*first)
        rows.append([name, short(cold[0], 2), short(warm[0], 2), short(max(cold[1], warm[1]), 2)])
    _, gigabytes = measured(args.foci, "replay", study, "--out", folder, "--overwrite")
    with open(os.path.join(folder, "frames.tsv"), newline="", encoding="utf-8") as file:
        frames = [float(frame["render_ms"]) for frame in csv.DictReader(file, delimiter="\t")]
    times = sorted([ms for ms in frames if ms > 0.0][1:])  # without the first; a reused frame takes no time
    limit = "without a limit of memory"
    if args.cgroup:
        limits = [os.path.join(args.cgroup, limit) for limit in ("memory.max", "memory.limit_in_bytes")]
        text = open(next(path for path in limits if os.path.exists(path)), encoding="utf-8").read()
        limit = f"in a memory cgroup limited to {int(text) / 2**30:.3g} GiB, pages of the file included"
    text = (f"A landscape of `foci_large_scene`, {os.path.getsize(args.large) / 1e9:.1f} GB, 1920 x 1080 px, method `auto` at "
            f"full quality on the CPU, {limit}. Times of whole runs of `foci render`: cold (none of the file in memory), and "
            "again. Peak of resident memory, with the pages of the mapped file.")
    later = (f"Later frames of the last view, where the eye moves forwards by 1 m/s (`foci replay`): median "
             f"{times[len(times) // 2] / 1000:.2f} s, {gigabytes:.2g} GB.")
    parts = [text, table(["view", "first frame, cold, s", "again, s", "memory, GB"], rows), later]
    if shutil.which("xvfb-run"):
        forget()
        live = ["xvfb-run", "-a", "-s", "-screen 0 1920x1080x24", "timeout", "--foreground", "-s", "INT", "20", args.foci, "live",
                study, "--window", "--source", "trace:simulated", "--set", "output.seconds=null", "--json"]
        seen = json.loads(subprocess.run(live, cwd=args.out, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                         preexec_fn=enter).stdout)
        parts.append(f"`foci live` on that view for 20 s, cold: first frame after {short(seen['first_frame_s'], 2)} s, "
                     f"{seen['frames']} frames, {short(100 * seen['frames_full'], 2)} % of them at full quality; gaze to swap "
                     f"{short(seen['sample_to_swap_ms_median'], 2)} ms (median), {short(seen['sample_to_swap_ms_p95'], 2)} ms (95 %).")
    return "\n\n".join(parts)


def python(args):
    """Calls of the Python module."""
    module = os.path.join(os.path.dirname(args.build), "python", "python")
    if not os.path.isdir(os.path.join(module, "foci")):
        return None
    environment = dict(os.environ, PYTHONPATH=module)
    script = os.path.join(ROOT, "tests", "python", "times.py")
    measured = json.loads(subprocess.run(["/usr/bin/python3", script], check=True, stdout=subprocess.PIPE, text=True,
                                         env=environment).stdout)
    return ("1,000 samples at 1000 Hz pushed into a session, and 1,000 states read, on a plane of 3,721 surfels: shortest of "
            "60 runs, ms. `render`: what Python adds to the C++ call, median. " +
            "; ".join(f"{name}: {short(ms, 2)}" for name, ms in measured.items()) + ".")


TITLES = {"bench": "Benchmarks",
          "trained_events": "Trained event detection on recordings that it has not seen",
          "event_rules": "Event detection on recordings that its constants have not seen", "live": "Live", "chart": "Time against accuracy", "motion": "Motion",
          "peers": "Other renderers", "growth": "How cost grows", "stability": "Stability", "reproduce": "The paper's Table 1",
          "eye": "The eye", "webcam": "The webcam", "large": "Scenes larger than memory", "python": "Python"}


def old_sections():
    """Section name -> its text, of the page as it is."""
    if not os.path.exists(PAGE):
        return {}
    parts = re.split(r"^<!-- section (\w+) -->\n", open(PAGE, encoding="utf-8").read(), flags=re.M)
    return {name: text.rstrip("\n") for name, text in zip(parts[1::2], parts[2::2])}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--full", action="store_true", help="full runs instead of --quick")
    parser.add_argument("--only", default=",".join(SECTIONS), help="sections, by commas: " + ", ".join(SECTIONS))
    parser.add_argument("--labelled", nargs="*", default=[], help="recordings with the labels of human coders")
    parser.add_argument("--faces", help="photographs of faces with marked irises")
    parser.add_argument("--large", help="a landscape of 200 million surfels: foci_large_scene OUT.foci 200")
    parser.add_argument("--cgroup", help="folder of the memory cgroup that foci runs in for --large")
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), help="folder of foci and foci_bench")
    parser.add_argument("--out", default=os.path.join(ROOT, "out", "results"), help="folder of the measurements")
    parser.add_argument("--bench-filter", default=".")
    parser.add_argument("--live-s", type=float, default=30.0)
    parser.add_argument("--live-size", default="1280x720")
    parser.add_argument("--chart-options", default="", help="for foci chart, e.g. '--scene plane --size 64'")
    parser.add_argument("--growth-options", default="", help="for foci chart --growth")
    parser.add_argument("--stability-options", default="", help="for foci chart --stability")
    args = parser.parse_args()
    args.foci, args.bench = os.path.join(args.build, "foci"), os.path.join(args.build, "foci_bench")
    args.out = os.path.abspath(args.out)
    args.large = args.large and os.path.abspath(args.large)
    args.faces = args.faces and os.path.abspath(args.faces)
    args.labelled = [os.path.abspath(path) for path in args.labelled]
    args.quick = [] if args.full else ["--quick"]
    args.chart_options, args.stability_options = args.chart_options.split(), args.stability_options.split()
    args.growth_options = args.growth_options.split()
    only = args.only.split(",")
    if unknown := set(only) - set(SECTIONS):
        parser.error(f"--only: unknown section {', '.join(sorted(unknown))}")
    os.makedirs(args.out, exist_ok=True)

    texts = old_sections()
    for name in SECTIONS:
        if name in only:
            stamped = stamp(args.foci)
            text = globals()[name](args)
            if text is None:
                print(f"{name}: skipped (see --help); the page keeps its old section", file=sys.stderr)
            else:
                texts[name] = f"## {TITLES[name]}\n\n{stamped}\n\n{text}"
    with open(PAGE, "w", encoding="utf-8") as page:
        page.write("# Results\n\n`docs/results.py` measures foci and writes this page: do not edit it.\n"
                   "The section on Gaussian scenes and the figures of [batch.md](batch.md) are measured by hand.\n"
                   "Times vary between runs; compare ratios.\n")
        for name in SECTIONS:
            text = texts.get(name, f"## {TITLES[name]}\n\nNot measured yet: `python3 docs/results.py --only {name}`.")
            page.write(f"\n<!-- section {name} -->\n{text}\n")
        for name in sorted(texts.keys() - set(SECTIONS)):  # measured by hand
            page.write(f"\n<!-- section {name} -->\n{texts[name]}\n")


if __name__ == "__main__":
    main()
