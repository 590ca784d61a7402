"""Times of the Python module, for docs/results.py: prints JSON with milliseconds.

PYTHONPATH=build/python/python python3 tests/python/times.py
"""

import json
import time

import numpy as np

import foci

RUNS, SAMPLES = 60, 1000
SCREEN = foci.Screen()


def plane(distance_m, half_m=1.0, points=61):
    side = np.linspace(-half_m, half_m, points)
    x, y = np.meshgrid(side, side)
    position_m = np.stack([x.ravel(), y.ravel(), np.full(x.size, -distance_m)], axis=1)
    return foci.Scene.from_points(position_m, normal=np.tile((0, 0, 1), (x.size, 1)))


def ms(action, runs, prepare=lambda: None):
    """The shortest time of `action(prepare())`."""
    times = []
    for _ in range(runs):
        prepared = prepare()
        start = time.perf_counter()
        action(prepared)
        times.append(1e3 * (time.perf_counter() - start))
    return min(times)


def main():
    scene = plane(0.5)
    noise = np.random.default_rng(1)
    t = np.arange(SAMPLES) / 1000.0
    x = np.interp(t, [0.5, 0.54], [500.0, 1400.0]) + noise.normal(0.0, 1.0, SAMPLES)
    y = 500.0 + noise.normal(0.0, 1.0, SAMPLES)
    samples = list(zip(t.tolist(), x.tolist(), y.tolist()))

    def session():
        return foci.Session(scene, foci.Eye(), SCREEN, rate_Hz=1000, size_px=(160, 90))

    def columns_then_states(s):
        s.push(t, x, y)
        for _ in samples:
            s.state(1.0)

    def one_by_one(s):
        for sample in samples:
            s.push(*sample)
            s.state(sample[0])

    times = {name: ms(action, RUNS, session) for name, action in (
        ("push, columns", lambda s: s.push(t, x, y)), ("push, columns, and states one by one", columns_then_states),
        ("track, columns", lambda s: s.track(t, x, y)), ("push and state, one by one", one_by_one))}

    over = []
    for _ in range(RUNS):
        start = time.perf_counter()
        image = foci.render(scene, foci.Eye(), SCREEN, size_px=(1280, 720), focus_m=0.5)
        over.append(1e3 * (time.perf_counter() - start) - image.render_ms)
    times["render over the C++ call, 1280x720"] = sorted(over)[RUNS // 2]
    print(json.dumps(times))


if __name__ == "__main__":
    main()
