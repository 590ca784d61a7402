"""Shows a drawn chessboard, tilted and moved, to a camera of known focal length, through
`foci calibrate camera --window`.

    calibrate_camera_test.py FOCI OUT_FOLDER
"""

import json
import math
import os
import sys
import time
import zlib
import struct

from observer import Observer, emptied

WIDTH, HEIGHT, FOCAL_PX = 320, 240, 310.0
COLUMNS, ROWS, SQUARE_M = 10, 7, 0.025
SAMPLES = 2  # a pixel and axis


def board_image(yaw, pitch, x, y, z):
    """Grey rows of a board turned by yaw and pitch, its centre at x, y, z metres in the camera's frame."""
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    # Columns of camera_from_board: rotation about y, then x.
    right, down = (cy, sy * sp, -sy * cp), (0.0, cp, sp)
    normal = (right[1] * down[2] - right[2] * down[1], right[2] * down[0] - right[0] * down[2],
              right[0] * down[1] - right[1] * down[0])
    dot = lambda p, q: p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
    along = dot(normal, (x, y, z))
    # A ray (u, v, 1) meets the board at t (u, v, 1), in squares from its corner: a right, b down.
    a0, b0 = COLUMNS / 2 - dot(right, (x, y, z)) / SQUARE_M, ROWS / 2 - dot(down, (x, y, z)) / SQUARE_M
    rows = []
    for py in range(HEIGHT):
        light = [0] * WIDTH
        for k in range(SAMPLES):
            v = (py + (k + 0.5) / SAMPLES - HEIGHT / 2) / FOCAL_PX
            depth, across, below = (axis[1] * v + axis[2] for axis in (normal, right, down))
            for i in range(WIDTH * SAMPLES):
                u = ((i + 0.5) / SAMPLES - WIDTH / 2) / FOCAL_PX
                t = along / (normal[0] * u + depth) / SQUARE_M
                a, b = t * (right[0] * u + across) + a0, t * (down[0] * u + below) + b0
                dark = 0 <= a < COLUMNS and 0 <= b < ROWS and (int(a) + int(b)) % 2 == 0
                light[i // SAMPLES] += 20 if dark else 235
        rows.append(bytes(level // (SAMPLES * SAMPLES) for level in light))
    return rows


def write_png(path, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" +
                   chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) +
                   chunk(b"IEND", b""))


def main():
    foci, out = sys.argv[1], emptied(sys.argv[2] + "/camera")
    frames = out + "/board"
    os.makedirs(frames, exist_ok=True)
    poses = [(0.5, 0.1, -0.05, 0.03, 0.4), (-0.5, 0.2, 0.06, -0.02, 0.42), (0.1, 0.5, 0.05, 0.04, 0.45),
             (0.2, -0.5, -0.06, -0.04, 0.4), (-0.3, -0.4, 0.0, 0.0, 0.36), (0.4, 0.4, 0.03, 0.0, 0.5),
             (-0.4, 0.4, -0.03, 0.02, 0.45), (0.6, 0.0, 0.0, -0.03, 0.4)]
    for i, pose in enumerate(poses):
        write_png(f"{frames}/{i:03d}.png", board_image(*pose))
    observer = Observer()
    try:
        program = observer.start(foci, "calibrate", "camera", "--window", "--video",
                                 frames + "/%03d.png", "--out", out + "/camera.toml", "--json")
        text = ""
        while f"view {len(poses)}" not in text:
            line = program.stderr.readline()
            assert line, text
            text += line
        time.sleep(0.3)
        observer.screenshot(out + "/camera.png")
        observer.press("space")
        assert program.wait(timeout=20) == 0, program.stderr.read()
        result = json.loads(program.stdout.read())
        print(result)
        assert result["views"] == len(poses)
        for axis in (0, 1):
            assert abs(result["focal_px"][axis] / FOCAL_PX - 1) < 0.01, result
            assert abs(result["principal_px"][axis] - (WIDTH, HEIGHT)[axis] / 2) < 3, result
        assert os.path.exists(out + "/camera.toml")
    finally:
        observer.close()


if __name__ == "__main__":
    main()
