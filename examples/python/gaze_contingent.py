"""A gaze-contingent loop, as in a PsychoPy experiment: take new samples, show the frame of this moment.

    python3 examples/python/gaze_contingent.py SCENE DISTANCE_M [SECONDS] [UP]

The mouse stands for the tracker in a window of Tk. Without a display, the loop runs headless with simulated gaze.
In PsychoPy, replace `gaze` by the tracker's samples, and show `image.srgb()` as an ImageStim. DISTANCE_M and UP: see
figure.py.
"""

import math
import time

import foci

from view import number, run, view

SIZE_PX = (960, 540)


class Headless:
    """Gaze that jumps between two points every second; frames are dropped."""

    def __init__(self, screen):
        self.width, self.height = screen.size_px

    def gaze(self, time_s):
        return (0.35 if math.floor(time_s) % 2 else 0.65) * self.width, 0.5 * self.height

    def show(self, image):
        return True


class Window:
    """A window of Tk, in which the mouse stands for gaze."""

    def __init__(self, screen):
        import tkinter

        self.tkinter, self.root = tkinter, tkinter.Tk()
        self.root.title("foci")
        self.scale = screen.size_px[0] / SIZE_PX[0]
        self.label = tkinter.Label(self.root, borderwidth=0)
        self.label.pack()

    def gaze(self, time_s):
        x = self.label.winfo_pointerx() - self.label.winfo_rootx()
        y = self.label.winfo_pointery() - self.label.winfo_rooty()
        return x * self.scale, y * self.scale

    def show(self, image):
        """Returns whether the window is still open."""
        try:
            if image.rendered:
                header = b"P6 %d %d 255\n" % SIZE_PX
                self.picture = self.tkinter.PhotoImage(data=header + image.srgb().tobytes(), format="PPM")
                self.label.configure(image=self.picture)
            self.root.update()
            return bool(self.label.winfo_exists())
        except self.tkinter.TclError:
            return False


def main(path, distance, duration="20", up="y"):
    seconds = number("SECONDS", duration)
    if seconds <= 0:
        raise foci.InputError(f"SECONDS = {duration}: expected more than 0")
    screen = foci.Screen()
    scene, eye = view(path, number("DISTANCE_M", distance), up, screen)
    session = foci.Session(scene, eye, screen, rate_Hz=60, size_px=SIZE_PX, frame_ms=12)
    try:
        display = Window(screen)
    except Exception as error:  # no Tk, or no display
        print(f"headless: {error}")
        display = Headless(screen)

    start, frames, now_s, opened = time.perf_counter(), 0, 0.0, True
    while opened and now_s < seconds:
        now_s = time.perf_counter() - start
        session.push(now_s, *display.gaze(now_s))
        image = session.frame(now_s)
        opened = display.show(image)
        frames += image.rendered
        time.sleep(max(0.0, 1 / 60 - (time.perf_counter() - start - now_s)))
    print(f"{frames} frames in {now_s:.1f} s; at the end {image.state}, focus {image.focus_D:.2f} D")


run(main, __doc__)
