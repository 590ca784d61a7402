"""A gaze-contingent loop, as in a PsychoPy experiment: take new samples, show the frame of this moment.

    python3 examples/python/gaze_contingent.py SCENE.ply DISTANCE_M [SECONDS]

The mouse stands for the tracker in a window of Tk. Without a display, the loop runs headless with simulated gaze.
In PsychoPy, replace `Gaze` by the tracker's samples, and show `image.srgb()` as an ImageStim.
"""

import math
import sys
import time

import foci

SIZE_PX = (960, 540)


class Headless:
    """Gaze that jumps between two points every second; frames are dropped."""

    def __init__(self, screen):
        self.width, self.height = screen.size_px

    def gaze(self, time_s):
        return (0.35 if math.floor(time_s) % 2 else 0.65) * self.width, 0.5 * self.height

    def show(self, image):
        pass


class Window:
    """A window of Tk, in which the mouse stands for gaze."""

    def __init__(self, screen):
        import tkinter

        self.tkinter, self.root = tkinter, tkinter.Tk()
        self.scale = screen.size_px[0] / SIZE_PX[0]
        self.label = tkinter.Label(self.root, borderwidth=0)
        self.label.pack()

    def gaze(self, time_s):
        x = self.label.winfo_pointerx() - self.label.winfo_rootx()
        y = self.label.winfo_pointery() - self.label.winfo_rooty()
        return x * self.scale, y * self.scale

    def show(self, image):
        if image.rendered:
            header = b"P6 %d %d 255\n" % SIZE_PX
            self.picture = self.tkinter.PhotoImage(data=header + image.srgb().tobytes(), format="PPM")
            self.label.configure(image=self.picture)
        self.root.update()


path, distance_m = sys.argv[1], float(sys.argv[2])
seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 20.0
screen = foci.Screen()
low, high = foci.Scene.open(path).bounds_m
scene = foci.Scene.open(path, scale_m=0.5 / (high[1] - low[1]))  # half a metre tall
low, high = scene.bounds_m
middle = [(a + b) / 2 for a, b in zip(low, high)]
eye = foci.Eye(pupil_mm=6, position_m=(middle[0], middle[1], middle[2] + distance_m), look_at_m=middle)
session = foci.Session(scene, eye, screen, rate_Hz=60, size_px=SIZE_PX, frame_ms=12)

try:
    display = Window(screen)
except Exception as error:  # no Tk, or no display
    print(f"headless: {error}")
    display = Headless(screen)

start, frames, now_s = time.perf_counter(), 0, 0.0
while now_s < seconds:
    now_s = time.perf_counter() - start
    session.push(now_s, *display.gaze(now_s))
    image = session.frame(now_s)
    display.show(image)
    frames += image.rendered
    time.sleep(max(0.0, 1 / 60 - (time.perf_counter() - start - now_s)))
print(f"{frames} frames in {now_s:.1f} s; at the end {image.state}, focus {image.focus_D:.2f} D")
