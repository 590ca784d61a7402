"""Makes the files of this folder, which the commands of the documents name:

    python3 configs/sample/make.py

A table with a vase and balls as a scan and as a mesh, a room of Gaussians, and recordings of a simulated observer. The
same files each time; the standard library is all that it needs.
"""

import gzip
import math
import pathlib
import random
import struct

HERE = pathlib.Path(__file__).resolve().parent
SCREEN_PX, SCREEN_M, DISTANCE_M = (1920, 1080), (0.5313, 0.2989), 0.6
GOLDEN = math.pi * (3 - math.sqrt(5))


def vase(height):
    """Radius at a share of the height."""
    return 0.05 + 0.035 * math.sin(2.2 * math.pi * height + 0.4) * (1 - 0.35 * height)


def shaded(color, normal):
    light = max(0.0, 0.4 * normal[0] + 0.8 * normal[1] + 0.45 * normal[2])
    return tuple(min(255, round(c * (0.45 + 0.55 * light))) for c in color)


def on_vase(count, foot, height, color):
    for i in range(count):
        share, angle = (i + 0.5) / count, i * GOLDEN
        radius = vase(share)
        band = color if int(share * 9) % 2 else tuple(min(255, c + 70) for c in color)
        normal = (math.cos(angle), 0.15, math.sin(angle))
        yield ((foot[0] + radius * normal[0], foot[1] + share * height, foot[2] + radius * normal[2]),
               shaded(band, normal))


def on_ball(count, middle, radius, color):
    for i in range(count):
        y, angle = 1 - 2 * (i + 0.5) / count, i * GOLDEN
        ring = math.sqrt(1 - y * y)
        normal = (ring * math.cos(angle), y, ring * math.sin(angle))
        checks = (int(6 * angle / math.pi) + int(4 * y + 8)) % 2
        yield (tuple(m + radius * n for m, n in zip(middle, normal)),
               shaded(color if checks else (235, 230, 215), normal))


def on_plane(count_u, count_v, corner, u, v, colors, checks, normal):
    for i in range(count_u):
        for j in range(count_v):
            a, b = (i + 0.5) / count_u, (j + 0.5) / count_v
            at = tuple(c + a * p + b * q for c, p, q in zip(corner, u, v))
            yield at, shaded(colors[(int(a * checks[0]) + int(b * checks[1])) % 2], normal)


def table():
    """Points and colours, in metres, y up; an eye at (0, 0.35, 0) sees all of it along -z."""
    yield from on_plane(150, 125, (-0.6, 0, -1.5), (1.2, 0, 0), (0, 0, 1.0), ((140, 92, 58), (176, 124, 82)), (8, 7),
                        (0, 1, 0))
    yield from on_vase(4500, (-0.12, 0, -0.95), 0.36, (52, 96, 150))
    yield from on_ball(1500, (0.16, 0.06, -0.72), 0.06, (196, 62, 52))
    yield from on_ball(2500, (0.3, 0.09, -1.25), 0.09, (70, 140, 84))


def write_scan():
    points = [((x, -z, y), color) for (x, y, z), color in table()]  # z up, as scans are
    head = ("ply\nformat binary_little_endian 1.0\ncomment the sample of foci, in metres\n"
            f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n")
    (HERE / "scan.ply").write_bytes(head.encode() + b"".join(struct.pack("<3f3B", *p, *c) for p, c in points))


def write_mesh():
    rings, sides, height = 24, 36, 0.36
    lines = ["# the vase of scan.ply as a mesh, in metres", "o vase"]
    for ring in range(rings + 1):
        for side in range(sides):
            radius, angle = vase(ring / rings), 2 * math.pi * side / sides
            lines.append(f"v {radius * math.cos(angle):.5f} {height * ring / rings:.5f} {radius * math.sin(angle):.5f}"
                         f" {0.2 + 0.25 * (ring // 3 % 2):.2f} {0.38 + 0.27 * (ring // 3 % 2):.2f} 0.60")
    for ring in range(rings):
        for side in range(sides):
            a, b = ring * sides + side + 1, ring * sides + (side + 1) % sides + 1
            lines.append(f"f {a} {a + sides} {b + sides} {b}")
    (HERE / "vase.obj").write_text("\n".join(lines) + "\n")


def write_room():
    """SPZ 2: a room of 4 x 4 m and 2.5 m high, y up, the floor at 0; a vase as high as a child and a ball."""
    walls = [on_plane(52, 52, (-2, 0, -2), (4, 0, 0), (0, 0, 4), ((150, 130, 110), (196, 180, 160)), (8, 8), (0, 1, 0)),
             on_plane(52, 33, (-2, 0, -2), (4, 0, 0), (0, 2.5, 0), ((120, 140, 160), (132, 152, 172)), (16, 1),
                      (0, 0, 1)),
             on_plane(52, 33, (-2, 0, -2), (0, 0, 4), (0, 2.5, 0), ((150, 120, 110), (168, 136, 124)), (1, 10),
                      (1, 0, 0))]
    # (center, color, half extents): flat on floor and walls, round on the objects.
    splats = [(p, c, tuple(0.05 if n == 0 else 0.008 for n in flat))
              for wall, flat in zip(walls, ((0, 1, 0), (0, 0, 1), (1, 0, 0))) for p, c in wall]
    splats += [(tuple(3 * (x - f) + f for x, f in zip(p, (0.5, 0, -0.8))), c, (0.018,) * 3)
               for p, c in on_vase(2200, (0.5, 0, -0.8), 0.36, (52, 96, 150))]
    splats += [(p, c, (0.014,) * 3) for p, c in on_ball(1400, (-0.5, 0.22, 0.1), 0.22, (196, 62, 52))]
    count = len(splats)
    clamped = lambda value: max(0, min(255, round(value)))  # noqa: E731
    linear = lambda share: (share - 0.5) / 0.28209479177387814  # noqa: E731  # the constant spherical harmonic
    body = struct.pack("<IIIBBBB", 0x5053474E, 2, count, 0, 12, 0, 0)
    body += b"".join(struct.pack("<i", round(x * 4096))[:3] for p, _, _ in splats for x in p)
    body += bytes([clamped(255 * 0.97)] * count)
    body += bytes(clamped((linear(c / 255) * 0.15 + 0.5) * 255) for _, color, _ in splats for c in color)
    body += bytes(clamped((math.log(s) + 10) * 16) for _, _, size in splats for s in size)
    body += bytes([128] * 3 * count)  # no rotation
    (HERE / "room.spz").write_bytes(gzip.compress(body, 9, mtime=0))


def looks(seed, seconds, rate_hz, places, noise):
    """(time, place) of an observer who looks at one place after another: 0.25 to 0.5 s, steps of 30 ms between."""
    dice = random.Random(seed)
    at, until, steps = dice.choice(places), 0.0, 0.03
    previous = at
    for i in range(int(seconds * rate_hz)):
        t = i / rate_hz
        if t >= until:
            previous, at = at, dice.choice([p for p in places if p != at])
            begin, until = t, t + dice.uniform(0.25, 0.5)
        share = min(1.0, (t - begin) / steps)
        share = share * share * (3 - 2 * share)
        yield t, tuple(p + share * (q - p) + dice.gauss(0, noise) for p, q in zip(previous, at))


SPOTS_PX = [(760, 470), (1130, 640), (1240, 450), (900, 760), (700, 620)]


def write_recordings():
    def tsv(seed):
        rows = looks(seed, 3, 250, SPOTS_PX, 2.0)
        return "time_s\tx_px\ty_px\n" + "".join(f"{t:.3f}\t{x:.1f}\t{y:.1f}\n" for t, (x, y) in rows)

    (HERE / "gaze.tsv").write_text(tsv(1))
    for number in (1, 2):
        (HERE / "data").mkdir(exist_ok=True)
        (HERE / f"data/observer-{number}.tsv").write_text(tsv(10 + number))

    # As laboratories export them: 0 to 1 of the screen, pupils in mm; of one person, and of two in one table.
    def csv(seed, lead=""):
        return "".join(f"{lead}{1000 * t:.1f},{x / SCREEN_PX[0]:.5f},{y / SCREEN_PX[1]:.5f},{3.4 + 0.2 * math.sin(t):.3f}\n"
                       for t, (x, y) in looks(seed, 3, 120, SPOTS_PX, 2.0))

    columns = "timestamp_ms,gaze_x_norm,gaze_y_norm,pupil_diameter_mm\n"
    (HERE / "gaze.csv").write_text(columns + csv(3))
    (HERE / "people.csv").write_text("participant," + columns + csv(3, "A,") + csv(4, "B,"))

    # EyeLink, as edf2asc writes it: one eye, two trials.
    lines = ["** CONVERTED FROM sample.edf", "** SAMPLE OF FOCI, SIMULATED", "",
             "MSG\t1000 DISPLAY_COORDS 0 0 1919 1079", "MSG\t1000 GAZE_COORDS 0.00 0.00 1919.00 1079.00",
             "START\t1000 \tLEFT\tSAMPLES\tEVENTS", "PRESCALER\t1", "VPRESCALER\t1", "PUPIL\tAREA",
             "SAMPLES\tGAZE\tLEFT\tRATE\t 250.00\tTRACKING\tCR\tFILTER\t2"]
    trials = {0.0: "MSG\t1000 TRIALID vase", 1.5: "MSG\t2500 TRIALID balls"}
    for t, (x, y) in looks(5, 3, 250, SPOTS_PX, 1.5):
        lines += [trials[round(t, 3)]] if round(t, 3) in trials else []
        lines.append(f"{1000 + round(1000 * t)}\t {x:7.1f}\t {y:7.1f}\t {1180 + 40 * math.sin(t):6.1f}\t...")
    lines += ["MSG\t4000 TRIAL_RESULT 0", "END\t4000 \tSAMPLES\tEVENTS\tRES\t  36.1\t  36.4"]
    (HERE / "gaze.asc").write_text("\n".join(lines) + "\n")

    # Labelled by two simulated coders, who part for a sample at the borders.
    rows = list(looks(6, 3, 250, SPOTS_PX, 2.0))
    moving = [abs(b[1][0] - a[1][0]) > 12 for a, b in zip(rows, rows[1:])] + [False]
    (HERE / "coded").mkdir(exist_ok=True)
    (HERE / "coded/one.tsv").write_text("time_s\tx_px\ty_px\tcoder_A\tcoder_B\n" + "".join(
        f"{t:.3f}\t{x:.1f}\t{y:.1f}\t{('fixation', 'saccade')[moving[i]]}\t{('fixation', 'saccade')[moving[max(0, i - 1)]]}\n"
        for i, (t, (x, y)) in enumerate(rows)))


def turned_to(direction):
    """The quaternion x, y, z, w that turns -z to a direction."""
    x, y, z = (d / math.dist(direction, (0, 0, 0)) for d in direction)
    q = (y, -x, 0.0, 1 - z)  # (-z) x direction, and 1 + (-z) . direction
    return tuple(c / math.dist(q, (0, 0, 0, 0)) for c in q)


def write_headset():
    """EyeNavGS: rows of both eyes alternate. The head sways before the vase and the ball of room.spz."""
    # On the surfaces: the vase, the ball, the floor, the walls.
    spots = [(0.449, 0.162, -0.557), (0.486, 0.648, -0.733), (0.465, 0.972, -0.63), (-0.446, 0.358, 0.262),
             (1.1, 0, -0.2), (-1.4, 0, -0.9), (0.2, 1.5, -2), (-1.4, 1.2, -2), (-2, 1, -0.5), (1.5, 0.7, -2)]
    lines = ["ViewIndex,FOV1,FOV2,FOV3,FOV4,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,QuaternionZ,QuaternionW,"
             "GazePosX,GazePosY,GazePosZ,GazeQX,GazeQY,GazeQZ,GazeQW,Timestamp"]
    for t, spot in looks(7, 2.4, 36, spots, 0.001):
        head = (0.15 * math.sin(t), 1.5 + 0.02 * math.sin(2.3 * t), 1.6)
        for view in (0, 1):
            eye = (head[0] + (view - 0.5) * 0.064, head[1], head[2])
            fields = [*((-0.942, 0.698) if view == 0 else (-0.698, 0.942)), -0.942, 0.733, *eye,
                      *turned_to((0, -0.35, -1)), *eye, *turned_to(tuple(s - e for s, e in zip(spot, eye)))]
            lines.append(f"{view}," + ",".join(f"{f:.4f}" for f in fields) + f",{round(1000 * t)}")
    (HERE / "user1_room.csv").write_text("\n".join(lines) + "\n")


def write_pairs():
    """Targets and what a tracker with an offset and a gain said, degrees; a fit's and a validation's."""
    dice = random.Random(8)

    def rows(targets, each, drift=0.0):
        return "x\ty\tx_target\ty_target\n" + "".join(
            f"{1.08 * x + 0.9 + drift + dice.gauss(0, 0.15):.3f}\t{0.95 * y - 0.6 + drift + dice.gauss(0, 0.15):.3f}\t{x}\t{y}\n"
            for x, y in targets for _ in range(each))

    grid = [(x, y) for y in (-9, 0, 9) for x in (-16, 0, 16)]
    (HERE / "fit.tsv").write_text(rows(grid, 12))
    (HERE / "other.tsv").write_text(rows([(-8, -5), (8, -5), (0, 3), (-8, 5), (8, 5)], 12))
    (HERE / "one.tsv").write_text(rows([(0, 0)], 20, drift=0.7))


def write_binocular():
    """A tracker below the screen, tilted by 12 deg; the observer's head moves between the targets."""
    dice, kappa, tilt = random.Random(9), (0.03, -0.025), 0.2
    grid = [(x, y) for y in (-110, 0, 110) for x in (-220, 0, 220)]

    def in_tracker(v, place=0.0):
        x, y, z = v
        return (x + 10 * place, y * math.cos(tilt) - z * math.sin(tilt) + 150 * place,
                y * math.sin(tilt) + z * math.cos(tilt) - 20 * place)

    def both_eyes(head, target):
        fields = []
        for side in (0, 1):
            eye = (head[0] + (side - 0.5) * 63, head[1], head[2])
            sight = in_tracker(tuple(t - e for t, e in zip((*target, 0), eye)))
            turn = kappa[side] + dice.gauss(0, 0.003)
            x, y, z = sight[0], sight[1] * 1.0 + dice.gauss(0, 1.5), sight[2]
            fields += [*in_tracker(eye, 1.0), x * math.cos(turn) + z * math.sin(turn), y,
                       z * math.cos(turn) - x * math.sin(turn)]
        return ",".join(f"{f:.3f}" for f in fields)

    names = ",".join(f"{side}_{what}" for side in ("left", "right")
                     for what in ("origin_x_mm", "origin_y_mm", "origin_z_mm", "direction_x", "direction_y", "direction_z"))
    for name, targets in (("eyes-fit.csv", grid), ("eyes-other.csv", [(-110, -55), (110, 55), (-110, 55), (110, -55)])):
        rows = [f"{both_eyes((dice.uniform(-60, 60), dice.uniform(-40, 60), dice.uniform(520, 700)), t)},{t[0]},{t[1]}\n"
                for t in targets for _ in range(6)]
        (HERE / name).write_text(names + ",x_target_mm,y_target_mm\n" + "".join(rows))
    at_px = [(x / SCREEN_PX[0] - 0.5, 0.5 - y / SCREEN_PX[1]) for x, y in SPOTS_PX]
    spots_mm = [(1000 * SCREEN_M[0] * u, 1000 * SCREEN_M[1] * v) for u, v in at_px]
    (HERE / "eyes.csv").write_text("time_s," + names + "\n" + "".join(
        f"{t:.4f},{both_eyes((20 * math.sin(t), 0, 600), spot)}\n" for t, spot in looks(9, 3, 60, spots_mm, 0.5)))


def write_study():
    (HERE / "study.toml").write_text(f"""# The table, seen on a screen by a simulated observer.
[scene]
file = "scan.ply"

[eye]
position_m = [0, -0.2, 0.4]
look_at_m = [0, 1, 0.15]
up = [0, 0, 1]

[screen]
size_px = [{SCREEN_PX[0]}, {SCREEN_PX[1]}]
size_m = [{SCREEN_M[0]}, {SCREEN_M[1]}]
distance_m = {DISTANCE_M}

[output]
size_px = [640, 360]

[gaze]
source = "gaze.tsv"
""")


if __name__ == "__main__":
    write_scan()
    write_mesh()
    write_room()
    write_recordings()
    write_headset()
    write_pairs()
    write_binocular()
    write_study()
