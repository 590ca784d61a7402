"""Hostile names in every text that reaches gnuplot, HTML, SVG, TSV, JSON, a shell or a terminal."""

import html.parser
import json
import os
import re

from box import SCREEN, STUDY, attack, square_ply, trace

# Without a slash, so that each may be the name of a file.
HOSTILE = {
    "shell": "`touch TOUCHED`$(touch TOUCHED);touch TOUCHED;|touch TOUCHED",
    "gnuplot": "x\"; system(\"touch TOUCHED\"); '.system('touch TOUCHED').' {Symbol a}@^_%s%n",
    "HTML": "<script>alert(1)<img src=x onerror=alert(1)>\"onload=alert(1) --><b>&lt;",
    "table": "a\tb\nc,\"d\";e\r",
    "terminal": "\x1b[31mred\x07\x9b2J\x7f",
}
OWN_SCRIPT = re.compile(r"alert\(1\)")


class Page(html.parser.HTMLParser):
    """Finds markup that a name has made."""

    def __init__(self):
        super().__init__()
        self.bad, self.scripts = [], False

    def handle_starttag(self, tag, attributes):
        self.scripts = tag == "script"
        if any(name.startswith("on") or (value and OWN_SCRIPT.search(value) and name not in ("alt", "content"))
               for name, value in attributes if name in ("onload", "onerror", "src")):
            self.bad.append(tag)

    def handle_data(self, data):
        if self.scripts and OWN_SCRIPT.search(data):
            self.bad.append("script")
        self.scripts = False


def clean(box, outcome):
    """Nothing that foci printed or wrote has another meaning because of a name."""
    for text in (outcome.out, outcome.err):
        found = re.search(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", text)
        box.require(not found, f"{outcome.command}: prints {found and found.group()!r}", "executes")
    for name in set(box.files()) - set(box.before):
        path = os.path.join(box.path, name)
        if not os.path.isfile(path) or os.path.basename(name) == "TOUCHED":
            continue
        with open(path, "rb") as file:
            content = file.read()
        if name.endswith(".json"):
            json.loads(content)
        elif name.endswith((".tsv", ".csv")):
            sign = "\t" if name.endswith("tsv") else ","
            rows = content.decode(errors="replace").split("\n")
            header = len([row for row in rows if row.startswith("#")])
            rows = [row.count(sign) for row in rows[header:-1] if '"' not in row or sign == "\t"]
            box.require(len(set(rows)) <= 1, f"{name} has rows of {sorted(set(rows))} fields", "silent")
        elif name.endswith(".html"):
            page = Page()
            page.feed(content.decode(errors="replace"))
            box.require(not page.bad, f"{name} has {page.bad} of a name", "executes")
            box.require(not re.search(rb"[\x00-\x08\x0b-\x1f]", content), f"{name} has control characters", "silent")


def toml(text):
    return json.dumps(text).replace("\\u007f", "\\u007F")


OBJ = "o {0}\nusemtl {0}\nv -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nf 1 2 3\no other\nusemtl {0} 2\nf 1 3 4\n"
GAZE = ("replay", "study.toml", "--out", "out")


def scene(box, text):
    box.write("study.toml", STUDY.replace('"scene.ply"', toml(text + ".ply")))
    os.rename(box / "scene.ply", box / (text + ".ply"))
    return [GAZE, ("info", text + ".ply"), ("prepare", text + ".ply", "--out", "n.foci")]


def recording(box, text):
    os.rename(box / "trace.tsv", box / (text + ".tsv"))
    file = "./" + text + ".tsv"
    return [(*GAZE, "--trace", file), ("trace", "info", file), ("events", file, "--out", "e.tsv"),
            ("trace", "convert", file, "--out", "a_physio.tsv.gz")]


def column(box, text):
    box.write("trace.tsv", SCREEN + f"time_s\tx_px\ty_px\t{text}\n" + "0\t1\t1\t1\n0.1\t2\t2\t1\n")
    return [("trace", "info", "trace.tsv"), ("events", "trace.tsv", "--out", "e.tsv")]


def column_that_is_missing(box, text):
    return [("events", "trace.tsv", "--x", text),
            ("replay", "study.toml", "--out", "out", "--set", "gaze.x=" + toml(text))]


def objects_of_an_obj(box, text):
    box.write("a.obj", OBJ.format(text.replace("\n", " ").replace("\r", " ")))
    return [("info", "a.obj"), ("prepare", "a.obj", "--points", "2000", "--out", "n.foci"), ("info", "n.foci"),
            (*GAZE, "--scene", "n.foci")]


def objects_of_a_gltf(box, text):
    from cases_inputs import gltf
    box.write("a.gltf", gltf(nodes=[{"mesh": 0, "name": text}], materials=[{"name": text}], primitive={"material": 0},
                             meshes=[{"name": text, "primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]))
    return [("info", "a.gltf"), ("prepare", "a.gltf", "--points", "2000", "--out", "n.foci"),
            (*GAZE, "--scene", "n.foci")]


def objects_of_a_study(box, text):
    box.write("study.toml", STUDY.replace("[eye]", f"object = [{{ name = {toml(text)}, center_m = [0, 0, -1], "
                                                   "radius_m = 0.3 }]\n[eye]"))
    return [GAZE, ("compare", "out", "out", "--out", "c"),
            ("render", "study.toml", "--out", "n.png", "--write-study", "w.toml"), ("render", "w.toml", "--out", "m.png")]


def people(box, text):
    names = (text.replace("\t", " ").replace("\n", " "), "B/../..", "b/../..")
    rows = "".join(f"{0.01 * i:.2f}\t320\t240\t{name}\n" for name in names for i in range(50))
    box.write("trace.tsv", SCREEN + "time_s\tx_px\ty_px\tparticipant\n" + rows)
    return [("trace", "info", "trace.tsv"), (*GAZE, "--trace", "trace.tsv")]


def markers_of_an_asc(box, text):
    rows = "".join(f"{10 * i}\t320\t240\t500.0\t...\n" for i in range(1, 99))
    box.write("a.asc", "MSG\t1 GAZE_COORDS 0.00 0.00 639.00 479.00\nSTART\t1 \tLEFT\tSAMPLES\tEVENTS\n"
              f"SAMPLES\tGAZE\tLEFT\tRATE\t100.00\nMSG\t15 TRIALID {text}\nMSG\t20 {text}\n"
              f"MSG\t21 !V TRIAL_VAR {text} 1\n" + rows + "END\t2000 \tSAMPLES\tEVENTS\n")
    return [("trace", "info", "a.asc"), (*GAZE, "--trace", "a.asc"),
            ("trace", "convert", "a.asc", "--out", "a_physio.tsv.gz", "--screen-m", "0.4x0.3", "--distance-m", "0.5")]


def markers(box, text):
    box.write("m.tsv", f"time_s\tmarker\n0.1\t{text}\n".encode())
    return [(*GAZE, "--markers", "m.tsv")]


def folder(box, text):
    return [("replay", "study.toml", "--out", text), ("compare", text, text, "--out", "c"),
            ("replay", "study.toml", "--frames", "0:", "--out", "p" + text), ("join", "p" + text, "--out", "j"),
            ("eye", "study.toml", "--out", "e" + text)]


def scan(box, text):
    box.write(text + ".ply", square_ply(60))
    return [("chart", "--quick", "--stability", "--scene", "thinned", "--scan", text + ".ply", "--eye", "0,-1.6,-0.2",
             "--look-at", "0,0,-1", "--method", "pinhole", "--out", "out")]


def study(box, text):
    os.rename(box / "study.toml", box / (text + ".toml"))
    return [("replay", text + ".toml", "--out", "out"), ("eye", text + ".toml", "--out", "e")]


def words(box, text):
    return [(text,), ("render", text), ("events", text), ("replay", "study.toml", "--method", text),
            ("replay", "study.toml", "--set", text), ("replay", "study.toml", "--set", "render.method=" + toml(text)),
            ("chart", "--method", text, "--out", "o"), ("chart", "--scene", text, "--out", "o"), ("info", text),
            ("webcam", text), ("join", text, "--out", "o"), ("compare", text, "x", "--out", "o"),
            ("live", "study.toml", "--source", text), ("calibrate", "gaze", "--pairs", text),
            ("prepare", text, "--out", "n.foci"), ("trace", "info", text)]


def keys(box, text):
    box.write("a.toml", STUDY + f"{toml(text)} = 1\n")
    box.write("b.toml", f"[{toml(text)}]\nx = 1\n")
    box.write("c.toml", STUDY.replace("[eye]", f"[eye]\nmethod = {toml(text)}\n"))
    box.write("d.toml", f"[scene]\nfile = '{text}'\n")
    return [("render", name, "--out", "n.png") for name in ("a.toml", "b.toml", "c.toml", "d.toml")]


def json_texts(box, text):
    box.write("a.json", json.dumps({text: {"sizePix": [640, 480], "width": 40, "distance": 50, "notes": text,
                                           "gamma": text}}))
    box.write("a_physio.tsv", "1\t2\t3\n" * 9)
    box.write("a_physio.json", json.dumps({"SamplingFrequency": 1, "StartTime": 0, "Columns": [text, "b", text],
                                           "PhysioType": text}))
    return [("calibrate", "screen", "--headless", "--monitor", "a.json"), ("trace", "info", "a_physio.tsv")]


CARRIERS = (scene, recording, column, column_that_is_missing, objects_of_an_obj, objects_of_a_gltf, objects_of_a_study,
            people, markers_of_an_asc, markers, folder, scan, study, words, keys, json_texts)


@attack(*[(carrier.__name__, kind) for carrier in CARRIERS for kind in HOSTILE])
def name_in(box, carrier, kind):
    for command in globals()[carrier](box, HOSTILE[kind]):
        clean(box, box.run(*command).any())
