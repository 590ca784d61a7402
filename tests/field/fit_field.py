#!/usr/bin/env python3
"""Fits `typicalField` (render/optics/eye_field.cpp) to the ten eyes of Polans and others 2015.

    python3 tests/field/fit_field.py polans2015.tsv.gz

Prints, for each term and degree, the mean absolute error of an eye that the fit left out and the
root mean square of the fit less the median eye; then the coefficients of the chosen degrees; then
the medians that `foci validate` compares with (app/eye/validation.cpp), and their bounds.
Standard library only, so it checks `fitField`, which shares no code with it.
"""
import gzip
import math
import statistics
import sys

RADIUS_MM = 2.0
UNIT_DEG = 40.0
FOVEA_DEG = 5
# Name, coefficient (OSA), dioptres or micrometres per micrometre, degree in use.
TERMS = [
    ("power_D", 4, 4 * 3**0.5 / RADIUS_MM**2, 4),
    ("j0_D", 5, 2 * 6**0.5 / RADIUS_MM**2, 2),
    ("j45_D", 3, 2 * 6**0.5 / RADIUS_MM**2, 3),
    ("coma7_um", 7, 1.0, 2),
    ("coma8_um", 8, 1.0, 1),
]


def on_disc(x, y):
    return 10 <= x <= 18 and abs(y) <= 5


def basis(x, y, degree):
    return [
        (x / UNIT_DEG) ** (n - b) * (y / UNIT_DEG) ** b
        for n in range(1, degree + 1)
        for b in range(n + 1)
    ]


def value(terms, x, y, degree):
    return sum(c * t for c, t in zip(terms, basis(x, y, degree)))


def fit(points, degree):
    """Least squares by the normal equations."""
    n = degree * (degree + 3) // 2
    m = [[0.0] * (n + 1) for _ in range(n)]
    for (x, y), target in points.items():
        row = basis(x, y, degree) + [target]
        for i in range(n):
            for j in range(n + 1):
                m[i][j] += row[i] * row[j]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(m[k][i]))
        m[i], m[pivot] = m[pivot], m[i]
        for k in range(n):
            if k != i:
                factor = m[k][i] / m[i][i]
                m[k] = [a - factor * b for a, b in zip(m[k], m[i])]
    return [m[i][n] / m[i][i] for i in range(n)]


def bound(values):
    """Twice the standard error of the median, without the outliers of Iglewicz and Hoaglin (1993)."""
    middle = statistics.median(values)
    scale = 1.4826 * statistics.median(abs(v - middle) for v in values)
    kept = [v for v in values if abs(v - middle) <= 3.5 * scale]
    return 2 * (math.pi / 2) ** 0.5 * statistics.stdev(kept) / len(kept) ** 0.5


def median_eye(eyes):
    return {at: statistics.median(eye[at] for eye in eyes) for at in eyes[0]}


def main():
    with gzip.open(sys.argv[1], "rt") as file:
        rows = [[float(x) for x in line.split("\t")] for line in list(file)[1:]]
    relative = {}
    for name, index, factor, chosen in TERMS:
        eyes = []
        for subject in range(1, 11):
            eye = {(int(r[1]), int(r[2])): factor * r[index] for r in rows if r[0] == subject}
            fovea = statistics.median(
                v for (x, y), v in eye.items() if max(abs(x), abs(y)) <= FOVEA_DEG
            )
            relative.setdefault(name, []).append({at: v - fovea for at, v in eye.items()})
            eyes.append({at: v - fovea for at, v in eye.items() if not on_disc(*at)})
        for degree in range(1, 6):
            errors = []
            for left_out in eyes:
                terms = fit(median_eye([e for e in eyes if e is not left_out]), degree)
                errors += [abs(v - value(terms, x, y, degree)) for (x, y), v in left_out.items()]
            points = median_eye(eyes)
            terms = fit(points, degree)
            squares = [(v - value(terms, x, y, degree)) ** 2 for (x, y), v in points.items()]
            print(
                f"{name} degree {degree}: left out {statistics.mean(errors):.4f}, "
                f"rms {statistics.mean(squares) ** 0.5:.4f}{' *' if degree == chosen else ''}"
            )
        terms = ", ".join(f"{t:.4f}" for t in fit(median_eye(eyes), chosen))
        print(f"    .{name} = {{{terms}}},")
    sides = [(x, 0) for x in (10, 20, 30, 40, -10, -20, -30, -40)]
    for x, y in sides + [(0, y) for y in (10, 20, 25, -10, -20, -25)]:
        power = [eye[x, y] for eye in relative["power_D"]]
        astigmatism = [(2 if y == 0 else -2) * eye[x, y] for eye in relative["j0_D"]]
        print(
            f"{x} {y} deg: {statistics.median(power):.2f} +- {bound(power):.2f} D, astigmatism "
            f"{statistics.median(astigmatism):.2f} +- {bound(astigmatism):.2f} D"
        )
    for x in (20, 30, 40):
        both = [eye[x, 0] + eye[-x, 0] for eye in relative["j0_D"]]
        print(f"{x} deg, both sides: astigmatism {statistics.median(both):.2f} +- {bound(both):.2f} D")


if __name__ == "__main__":
    main()
