"""What reads memory, stops half-way, or stands beside an input: hostile files of every format."""

import base64
import gzip
import json
import os
import re
import struct
import time
import zlib

from box import SCREEN, STUDY, attack, square_ply, trace


def u32(*values):
    return struct.pack(f"<{len(values)}I", *values)


def png(width, height, rows=None):
    """Black, of one bit a pixel; `rows` are all that it has of its rows."""
    def part(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    pixels = zlib.compress(bytes((1 + (width + 7) // 8) * (height if rows is None else rows)))
    return (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0)) +
            part(b"IDAT", pixels) + part(b"IEND", b""))


def bomb(megabytes, start=b"", filling=b"\0"):
    """Gzip members of 16 MB each, after `start`."""
    return gzip.compress(start) + gzip.compress(filling * (16000000 // len(filling))) * (megabytes // 16)


CORNERS = struct.pack("<9f", -1, -1, -1, 1, -1, -1, 0, 1, -1)


def gltf(buffer=CORNERS, view=None, accessor=None, more_accessors=(), more_views=(), primitive=None, **more):
    """A triangle, with parts replaced."""
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, **(primitive or {})}]}],
        "buffers": [{"byteLength": len(buffer),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()}],
        "bufferViews": [{"buffer": 0, "byteLength": len(buffer), **(view or {})}, *more_views],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", **(accessor or {})},
                      *more_accessors], **more})


INDEX = {"bufferView": 0, "componentType": 5125, "count": 3, "type": "SCALAR"}
SPARSE = {"count": 3, "indices": {"bufferView": 0, "componentType": 5125}, "values": {"bufferView": 0}}
FAR = 2**31 - 4
GLTF = {
    "count": gltf(accessor={"count": 4}), "large count": gltf(accessor={"count": 2**31}),
    "count that overflows": gltf(accessor={"count": 2**62}), "negative count": gltf(accessor={"count": -1}),
    "offset": gltf(accessor={"byteOffset": 4}), "far offset": gltf(accessor={"byteOffset": FAR}),
    "negative offset": gltf(accessor={"byteOffset": -36}),
    "offset that overflows": gltf(accessor={"byteOffset": 2**64 - 36}),
    "view length": gltf(view={"byteLength": 72}), "view offset": gltf(view={"byteOffset": 36}),
    "negative view": gltf(view={"byteOffset": -4}), "short view": gltf(view={"byteLength": 35}),
    "stride": gltf(view={"byteStride": 16}), "huge stride": gltf(view={"byteStride": 2**31}),
    "interleaved": gltf(view={"byteStride": 12}, accessor={"byteOffset": 8}),
    "no view": gltf(accessor={"bufferView": 7}), "no buffer": gltf(view={"buffer": 3}),
    "no accessor": gltf(primitive={"attributes": {"POSITION": 9}}),
    "buffer shorter than stated": gltf(buffers=[{"byteLength": 36, "uri": "data:;base64,AAAA"}]),
    "buffer without bytes": gltf(buffers=[{"byteLength": 36}]),
    "index accessor": gltf(primitive={"indices": 1}, more_accessors=[{**INDEX, "count": 10}]),
    "index offset": gltf(primitive={"indices": 1}, more_accessors=[{**INDEX, "byteOffset": 28}]),
    "index of vertices": gltf(CORNERS + u32(0, 1, 2**32 - 2), view={"byteLength": 36}, primitive={"indices": 1},
                              more_views=[{"buffer": 0, "byteOffset": 36, "byteLength": 12}],
                              more_accessors=[{**INDEX, "bufferView": 1}]),
    "sparse count": gltf(accessor={"sparse": {**SPARSE, "count": 10}}),
    "sparse index": gltf(accessor={"sparse": SPARSE}),
    "sparse of no view": gltf(accessor={"sparse": {**SPARSE, "values": {"bufferView": 5}}}),
    "sparse offset": gltf(accessor={"sparse": {**SPARSE, "values": {"bufferView": 0, "byteOffset": FAR}}}),
    "sparse alone": gltf(accessor={"bufferView": None, "count": 2**31, "sparse": SPARSE}),
    "meshopt": gltf(view={"extensions": {"EXT_meshopt_compression": {
        "buffer": 0, "byteOffset": 20, "byteLength": 40, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"}}}),
    "meshopt count": gltf(view={"extensions": {"EXT_meshopt_compression": {
        "buffer": 0, "byteLength": 36, "byteStride": 12, "count": 2**31, "mode": "ATTRIBUTES"}}}),
    "draco": gltf(primitive={"extensions": {"KHR_draco_mesh_compression": {
        "bufferView": 0, "attributes": {"POSITION": 0}}}}, extensionsRequired=["KHR_draco_mesh_compression"]),
    "draco of no view": gltf(primitive={"extensions": {"KHR_draco_mesh_compression": {
        "bufferView": 9, "attributes": {"POSITION": 0}}}}, extensionsRequired=["KHR_draco_mesh_compression"]),
    "circle of nodes": gltf(nodes=[{"mesh": 0, "children": [0]}]), "deep": gltf() + "[" * 200000,
    "deep nodes": gltf(nodes=[{"mesh": 0, "children": [i + 1]} for i in range(50000)] + [{"mesh": 0}]),
    "skin": gltf(skins=[{"joints": [40], "inverseBindMatrices": 0}], nodes=[{"mesh": 0, "skin": 0}]),
    "image": gltf(images=[{"bufferView": 0, "mimeType": "image/png"}], textures=[{"source": 0}],
                  materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], primitive={"material": 0}),
}


@attack(*GLTF)
def gltf_reaches_too_far(box, what):
    box.write("a.gltf", GLTF[what])
    outcome = box.run("info", "a.gltf").any()
    if what not in ("image", "meshopt"):  # an image that is none is left out
        outcome.refused("a.gltf")
    box.run("render", "a.gltf", "--out", "n.png", "--size", "64x48").any()


PLY = "ply\nformat {} 1.0\nelement {}\nend_header\n"
XYZ = "\nproperty float x\nproperty float y\nproperty float z"
TEXTURED = gltf(images=[{"uri": f"{i}.png"} for i in range(60)], textures=[{"source": i} for i in range(60)],
                materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(60)],
                buffer=CORNERS + bytes(24), accessor={}, more_views=[],
                meshes=[{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": i}
                                        for i in range(60)]}],
                more_accessors=[{"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC2"}])
OBJ = "mtllib a.mtl\nv -1 -1 -1\nv 1 -1 -1\nv 0 1 -1\nvt 0 0\nvt 1 0\nvt 0 1\n"
NEST = "[" * 3000000
MONITOR = '{"a": {"sizePix": [640, 480], "width": 40, "distance": 50, "gamma": 2.2, "spectra": %s}}'


def xdf(*chunks):
    return b"XDF:" + b"".join(chunks)


def xdf_chunk(tag, content, length=None):
    return b"\x08" + struct.pack("<QH", 2 + len(content) if length is None else length, tag) + content


STREAM = (b'<?xml version="1.0"?><info><name>a</name><type>Gaze</type><channel_count>%d</channel_count><nominal_srate>'
          b"100</nominal_srate><channel_format>float32</channel_format></info>")


def xdf_samples(count, stamps=3):
    body = b"".join(b"\x08" + struct.pack("<dff", 0.01 * i, 0.5, 0.5) for i in range(stamps))
    return xdf_chunk(3, u32(7) + b"\x08" + struct.pack("<Q", count) + body)


# The files of an attack, made when it runs, and the command that reads them.
INFO, TRACE = ("info",), ("trace", "info")
MEMORY = {
    "textures of a glTF": (lambda: {"a.gltf": TEXTURED, **dict.fromkeys([f"{i}.png" for i in range(60)],
                                                                         png(6000, 6000))}, INFO),
    "textures of an OBJ": (lambda: {
        "a.obj": OBJ + "".join(f"usemtl m{i}\nf 1/1 2/2 3/3\n" for i in range(60)),
        "a.mtl": "".join(f"newmtl m{i}\nmap_Kd {i}.png\n" for i in range(60)),
        **dict.fromkeys([f"{i}.png" for i in range(60)], png(6000, 6000))}, INFO),
    "texture of 2^16 px": (lambda: {"a.obj": OBJ + "usemtl m\nf 1/1 2/2 3/3\n", "a.mtl": "newmtl m\nmap_Kd a.png\n",
                                    "a.png": png(65535, 65535, 1)}, INFO),
    "MTL": (lambda: {"a.obj": OBJ + "f 1 2 3\n", "a.mtl": "".join(f"newmtl m{i}\nKd 1 1 1\n" for i in range(300000))},
            INFO),
    "MTL of one line": (lambda: {"a.obj": OBJ + "usemtl m\nf 1 2 3\n", "a.mtl": "newmtl m\nmap_Kd " + "-s 1 " * 1500000},
                        INFO),
    "many MTL": (lambda: {"a.obj": "mtllib a.mtl\n" * 300000 + OBJ + "f 1 2 3\n", "a.mtl": "newmtl m\n" * 1000}, INFO),
    "OBJ of a face": (lambda: {"a.obj": OBJ + "f" + " 1 2 3" * 1000000}, INFO),
    "OBJ of materials": (lambda: {"a.obj": OBJ + "".join(f"usemtl {i}\nf 1 2 3\n" for i in range(300000))}, INFO),
    "PLY of points": (lambda: {"a.ply": PLY.format("binary_little_endian", "vertex 4000000000" + XYZ)}, INFO),
    "ASCII PLY of points": (lambda: {"a.ply": PLY.format("ascii", "vertex 4000000000" + XYZ)}, INFO),
    "PLY of a list": (lambda: {"a.ply": (PLY.format("binary_little_endian", "vertex 3" + XYZ + "\nelement face 1\n"
                                                    "property list uint int vertex_indices")).encode() + CORNERS +
                               u32(2**32 - 1)}, INFO),
    "PLY of names": (lambda: {"a.ply": PLY.format("ascii", "vertex 1" + "\nproperty float q" * 500000)}, INFO),
    "PLY of textures": (lambda: {"a.ply": "ply\nformat ascii 1.0\n" + "comment TextureFile a.png\n" * 200000 +
                                 "element vertex 3" + XYZ + "\nelement face 1\nproperty list uchar int vertex_indices\n"
                                 "end_header\n-1 -1 -1\n1 -1 -1\n0 1 -1\n3 0 1 2\n", "a.png": png(6000, 6000)}, INFO),
    "packed PLY": (lambda: {"a.ply.gz": bomb(4000, PLY.format("binary_little_endian",
                                                             "vertex 300000000" + XYZ).encode())}, INFO),
    "packed points": (lambda: {"a.xyz.gz": bomb(4000, b"1 2 3\n", b"1 2 3\n")}, INFO),
    "packed nonsense": (lambda: {"a.ply.gz": bomb(4000)}, INFO),
    "PCD": (lambda: {"a.pcd": "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2000000000\n"
                              "HEIGHT 2\nPOINTS 4000000000\nDATA binary\n"}, INFO),
    "packed PCD": (lambda: {"a.pcd": b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 300000000\n"
                                     b"HEIGHT 1\nPOINTS 300000000\nDATA binary_compressed\n" + u32(9, 3600000000)}, INFO),
    "OFF": (lambda: {"a.off": "OFF\n2000000000 2000000000 0\n"}, INFO),
    "STL": (lambda: {"a.stl": bytes(80) + u32(2**32 - 1)}, INFO),
    "LAS": (lambda: {"a.las": b"LASF" + bytes(20) + b"\1\4" + bytes(68) + b"\xff" * 300}, INFO),
    "COLMAP": (lambda: {"points3D.bin": struct.pack("<Q", 2**60)}, INFO, "points3D.bin"),
    "SPZ": (lambda: {"a.spz": bomb(3000, u32(0x5053474E, 2, 2**31))}, INFO),
    "KSPLAT": (lambda: {"a.ksplat": b"\0\1" + bytes(2) + b"\xff" * 5000}, INFO),
    "GLB": (lambda: {"a.glb": b"glTF" + u32(2, 2**32 - 1, 2**32 - 12) + b"JSON{}"}, INFO),
    "glTF of primitives": (lambda: {"a.gltf": gltf(meshes=[{"primitives": [{"attributes": {"POSITION": 0}}] * 150000}])},
                           INFO),
    "glTF of instances": (lambda: {"a.gltf": gltf(nodes=[{"children": [i + 1] * 10} for i in range(9)] + [{"mesh": 0}])},
                          INFO),
    "FOCI": (lambda: {"a.foci": b"foci scene\0\0" + b"\xff" * 300}, INFO),
    "recording of one line": (lambda: {"a.tsv": "x" * 9000000}, TRACE),
    "recording of columns": (lambda: {"a.tsv": "\t".join(f"c{i}" for i in range(1000000)) + "\n"}, TRACE),
    "packed recording": (lambda: {"a_physio.tsv.gz": bomb(2000, b"", b"1\t2\t3\n"), "a_physio.json": json.dumps({
        "SamplingFrequency": 1, "StartTime": 0, "Columns": ["timestamp", "x_coordinate", "y_coordinate"]})}, TRACE),
    "packed rows": (lambda: {"a.toml": STUDY.replace("[gaze]", "[gaze]\nrate_Hz = 1000\nx = 'x_px'\ny = 'y_px'"),
                             "a.tsv.gz": bomb(900, (SCREEN + "x_px\ty_px\n").encode(), b"1\t2\n")},
                    ("events", "--study", "a.toml"), "a.tsv.gz"),
    "packed line": (lambda: {"a.tsv.gz": bomb(4000)}, TRACE),
    "packed JSON": (lambda: {"a.json.gz": bomb(4000, b"{")}, TRACE),
    "ASC": (lambda: {"a.asc": "MSG 1 " + "x" * 9000000}, TRACE),
    "ASC of messages": (lambda: {"a.asc": "MSG 1 !V TRIAL_VAR a b\n" * 300000}, TRACE),
    "XDF of a chunk": (lambda: {"a.xdf": xdf(xdf_chunk(2, u32(7) + STREAM % 2, 2**62))}, TRACE),
    "XDF of channels": (lambda: {"a.xdf": xdf(xdf_chunk(2, u32(7) + STREAM % 2000000000), xdf_samples(3))}, TRACE),
    "XDF of samples": (lambda: {"a.xdf": xdf(xdf_chunk(2, u32(7) + STREAM % 2), xdf_samples(2**61))}, TRACE),
    "XDF of a header": (lambda: {"a.xdf": xdf(xdf_chunk(2, u32(7) + STREAM % 2 + b"<desc>" * 1500000))}, TRACE),
    "packed XDF": (lambda: {"a.xdfz": bomb(4000, b"XDF:")}, TRACE),
    "JSON of a recording": (lambda: {"a_physio.tsv.gz": gzip.compress(b"1\t2\t3\n" * 9), "a_physio.json": NEST}, TRACE),
    "nested monitor": (lambda: {"a.json": NEST}, ("calibrate", "screen", "--headless", "--monitor")),
    "spectra of a monitor": (lambda: {"a.json": MONITOR % ("[[" + "0," * 4000000 + "0]]")},
                             ("calibrate", "screen", "--headless", "--monitor")),
    "aberrometer": (lambda: {"a.csv": "n,m,um\n" + "2,0,0.1\n" * 1000000},
                    ("render", "study.toml", "--out", "n.png", "--set"), "observer.wavefront=a.csv"),
    "aberrometer of a line": (lambda: {"a.csv": "Z4," * 3000000},
                              ("render", "study.toml", "--out", "n.png", "--set"), "observer.wavefront=a.csv"),
    "nested study": (lambda: {"a.toml": "[a]\nb = " + NEST}, ("render", "--out", "n.png")),
    "study of a text": (lambda: {"a.toml": "[scene]\nfile = \"" + "x" * 9000000}, ("render", "--out", "n.png")),
    "pairs": (lambda: {"a.tsv": "x\ty\tx_target\ty_target\n" + "1\t1\t1\t1\n" * 1000000},
              ("calibrate", "gaze", "--pairs")),
    "images of a board": (lambda: {"a.png": png(65535, 65535, 1)},
                          ("calibrate", "camera", "--board", "5x4", "--square-mm", "20", "--images")),
    "image of a board": (lambda: {"a.png": png(30000, 30000)},
                         ("calibrate", "camera", "--board", "5x4", "--square-mm", "20", "--images")),
    "webcam": (lambda: {"a.png": png(30000, 30000)}, ("webcam",)),
}


@attack(*MEMORY)
def memory_for(box, what):
    make, command, *last = MEMORY[what]
    for name, content in make().items():
        box.write(name, content)
        last = last or [name]
    box.run(*command, *last).any()


@attack("part.json", "frame-000000.png", "a large image", "nested")
def altered_part(box, what):
    box.run("replay", "study.toml", "--frames", "0:", "--out", "p").done()
    box.before = None
    if what == "part.json":
        text = (box / "p/part.json").read_text()
        box.write("p/part.json", re.sub(r'("pupil_mm": ?)', r"\g<1>1", text))
    elif what == "nested":
        box.write("p/part.json", NEST)
    else:
        box.write("p/frame-000000.png", png(64, 48) if what[0] == "f" else png(30000, 30000))
    box.run("join", "p", "--out", "n").refused("p/part.json" if what in ("part.json", "nested") else "frame-000000.png")


@attack("scan_4px_reference.rgba", "scan_4px_reference.json", "scan_4px_pinhole.json")
def altered_cell(box, name):
    command = ("chart", "--quick", "--scene", "scan", "--scan", "scene.ply", "--size", "16", "--method", "pinhole",
               "--eye", "0,-1.6,-0.2", "--look-at", "0,0,-1", "--out", "out")
    box.write("scene.ply", square_ply(60))
    box.run(*command).done()
    file = box / "out/cells" / name
    status, content = file.stat(), bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)
    os.utime(file, ns=(status.st_atime_ns, status.st_mtime_ns))
    score = [line.split(",")[-2:] for line in (box / "out/chart.csv").read_text().splitlines()]
    if box.run(*command).any().code == 0:
        box.require(score == [line.split(",")[-2:] for line in (box / "out/chart.csv").read_text().splitlines()],
                    "the scores have changed")


def neon(box, parts, more="", missing=""):
    for part in parts:
        for kind in ("raw", "time"):
            values = (struct.pack("<2f", 100 + i, 600) if kind == "raw" else
                      struct.pack("<q", 1700000000000000000 + 5000000 * (i + 100 * part)) for i in range(100))
            if f"{part}.{kind}" != missing:
                box.write(f"neon/gaze ps{part}.{kind}", b"".join(values))


@attack("first part", "second part", "second part's times", "half a sample")
def neon_without(box, what):
    neon(box, {"first part": [2], "second part": [1, 3]}.get(what, [1, 2]),
         missing="2.time" if "times" in what else "")
    if what == "half a sample":
        box.write("neon/gaze ps2.raw", (box / "neon/gaze ps2.raw").read_bytes()[:-5])
    outcome = box.run("trace", "info", "neon").any()
    box.require(outcome.code == 2 or "warnings" in outcome.out, f"read in silence: {outcome.out[-200:]}")


@attack(*[(name, how) for name in ("a.tsv.gz", "a.xdfz", "a.ply.gz", "a.xyz.gz", "livedata.json.gz", "a.spz")
          for how in ("cut", "altered", "followed by nonsense")])
def second_member_is(box, name, how):
    inside = {"a.tsv.gz": trace().encode(), "a.ply.gz": square_ply().encode(),
              "a.xyz.gz": b"".join(b"%d %d 1 9 9 9\n" % (i % 40, i // 40) for i in range(1600)), "a.spz": bytes(4000),
              "a.xdfz": xdf(xdf_chunk(2, u32(7) + STREAM % 2), xdf_samples(100, 100)),
              "livedata.json.gz": b'{"ts": 1, "s": 0, "gp": [0.5, 0.5]}\n' * 400}[name]
    first, second = gzip.compress(inside[:len(inside) // 2]), bytearray(gzip.compress(inside[len(inside) // 2:]))
    if how == "cut":
        second = second[:-20]
    elif how == "altered":
        second[-6] ^= 1  # of the checksum
    else:
        second += b"nonsense"
    box.write(name, first + bytes(second))
    outcome = box.run("info" if name[-6:-3] in ("ply", "xyz") or name[-3:] == "spz" else "trace",
                      *(["info"] if name[0] == "l" or name[2:5] in ("tsv", "xdf") else []), name).any()
    box.require(outcome.code == 2 or "warning" in outcome.out or "after" in outcome.out + outcome.err,
                f"read in silence: {outcome.out[-200:]}")


ASC = ("MSG\t1 GAZE_COORDS 0.00 0.00 639.00 479.00\nSTART\t1 \tLEFT\tSAMPLES\tEVENTS\n"
       "SAMPLES\tGAZE\tLEFT\tRATE\t100.00\n{}END\t2000 \tSAMPLES\tEVENTS\n")


@attack(*[(kind, value) for kind in ("asc", "tsv")
          for value in ("1e30", "-1e30", "nan", "inf", "1e309", "0x10", "1e-400")])
def position_of(box, kind, value):
    rows = [f"{10 * i}\t{value if i == 50 else 320}\t240\t500.0\t...\n" for i in range(1, 100)]
    if kind == "asc":
        box.write("a.asc", ASC.format("".join(rows)))
    else:
        box.write("a.tsv", SCREEN + "time_s\tx_px\ty_px\n" + "".join(
            f"{i / 100}\t{value if i == 50 else 320}\t240\n" for i in range(100)))
    outcome = box.run("trace", "info", "a." + kind, "--screen-px", "640x480", "--screen-m", "0.4x0.3", "--distance-m",
                      "0.5").any()
    if outcome.code == 0:
        box.require("e+" not in outcome.out and "1e" not in outcome.out, f"kept it: {outcome.out[-300:]}")


@attack("path", "objects", "columns", "one text")
def study_of_one_line(box, what):
    path = ", ".join(f"{{ time_s = {i}, position_m = [0, 0, {i % 7 * 0.01}], look_at_m = [0, 0, -1] }}"
                     for i in range(8000))
    objects = ", ".join(f'{{ name = "o{i}", center_m = [0, 0, -1], radius_m = 0.1 }}' for i in range(8000))
    study = STUDY
    if what == "path":
        study = study.replace("position_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]", f"path = [{path}]")
    elif what == "objects":
        study = study.replace("[eye]", f"object = [{objects}]\n[eye]")
    elif what == "columns":
        study = study.replace("[output]", "rows = { " + ", ".join(f'c{i} = "v"' for i in range(8000)) + " }\n[output]")
    else:
        study = study.replace('"scene.ply"', '"' + "\\u0041" * 100000 + '"')
    box.write("long.toml", study)
    began = time.monotonic()
    box.run("render", "long.toml", "--out", "n.png", "--write-study", "w.toml").any()
    box.require(time.monotonic() - began < 6, "takes long", "hangs")


# A file beside the input, which the input names.
COMPANIONS = {
    "MTL": ({"a.obj": OBJ + "usemtl m\nf 1/1 2/2 3/3\n"}, "a.mtl", ("info", "a.obj")),
    "texture": ({"a.obj": OBJ + "usemtl m\nf 1/1 2/2 3/3\n", "a.mtl": "newmtl m\nmap_Kd a.png\n"}, "a.png",
                ("info", "a.obj")),
    "buffer": ({"a.gltf": gltf(buffers=[{"byteLength": 36, "uri": "a.bin"}])}, "a.bin", ("info", "a.gltf")),
    "image": ({"a.gltf": TEXTURED}, "0.png", ("info", "a.gltf")),
    "metadata": ({"a_physio.tsv.gz": gzip.compress(b"1\t2\t3\n" * 9)}, "a_physio.json",
                 ("trace", "info", "a_physio.tsv.gz")),
    "times": ({"neon/gaze ps1.raw": bytes(800)}, "neon/gaze ps1.time", ("trace", "info", "neon")),
    "aberrometer": ({}, "a.csv", ("render", "study.toml", "--out", "n.png", "--set", "observer.wavefront=a.csv")),
    "monitor": ({}, "a.json", ("render", "study.toml", "--out", "n.png", "--set", "screen.monitor=a.json")),
    "map": ({}, "map.toml", ("replay", "study.toml", "--out", "n", "--set", "gaze.map=map.toml")),
    "part": ({}, "b.ply", ("render", "study.toml", "--out", "n.png", "--set", 'scene.part=[{file="b.ply"}]')),
    "markers": ({}, "markers.tsv", ("replay", "study.toml", "--out", "n", "--markers", "markers.tsv")),
    "other eye": ({"a_recording-eye1_physio.tsv.gz": gzip.compress(b"1\t2\t3\n" * 9), "a_recording-eye1_physio.json":
                   '{"SamplingFrequency": 1, "StartTime": 0, "Columns": ["timestamp", "x_coordinate", "y_coordinate"]}'},
                  "a_recording-eye2_physio.tsv.gz", ("trace", "info", "a_recording-eye1_physio.tsv.gz")),
}


@attack(*[(companion, what) for companion in COMPANIONS for what in ("pipe", "/dev/zero", "folder", "secret")])
def companion_is_a(box, companion, what):
    files, name, command = COMPANIONS[companion]
    for file, content in files.items():
        box.write(file, content)
    if what == "pipe":
        box.fifo(name)
    elif what == "folder":
        (box / name).mkdir(parents=True)
    else:
        (box / name).parent.mkdir(exist_ok=True)
        (box / name).symlink_to(what if what[0] == "/" else box.write("secret", "s3cret:x:0\n"))
    outcome = box.run(*command).any()
    box.require(outcome.err or outcome.out, "says nothing")
