"""A display without a monitor (Xvfb), and an observer who moves its mouse and presses its keys (XTest)."""

import ctypes
import glob
import os
import shutil
import struct
import subprocess
import tempfile
import time
import zlib


def emptied(folder):
    """The folder without the files of an earlier run, which foci does not replace if a test has changed them."""
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    return folder


class Observer:
    def __init__(self, width=1280, height=720):
        self.size = (width, height)
        self.folder = tempfile.TemporaryDirectory()
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24",
             "-fbdir", self.folder.name, "-nolisten", "tcp"],
            pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            self.name = ":" + pipe.readline().strip()
        self.x11 = ctypes.CDLL("libX11.so.6")
        self.x11.XInitThreads()  # several observers may play at the same time
        self.xtest = ctypes.CDLL("libXtst.so.6")
        self.x11.XOpenDisplay.restype = ctypes.c_void_p
        self.x11.XStringToKeysym.restype = ctypes.c_ulong
        self.x11.XKeysymToKeycode.restype = ctypes.c_ubyte
        self.display = ctypes.c_void_p(self.x11.XOpenDisplay(self.name.encode()))
        if not self.display:
            raise RuntimeError("Xvfb does not answer at " + self.name)
        self.programs = []

    def start(self, *command, speed=1.0, environment=()):
        """Starts a program on this display. Its clock runs `speed` times as fast (see fast_clock.cpp)."""
        environment = dict(os.environ, DISPLAY=self.name, LIBGL_ALWAYS_SOFTWARE="1", **dict(environment))
        if speed != 1.0:
            environment.update(LD_PRELOAD=os.environ["FOCI_FAST_CLOCK"], FOCI_CLOCK_SPEED=str(speed))
        program = subprocess.Popen([str(word) for word in command], env=environment, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.programs.append(program)
        return program

    def look(self, x, y):
        """Moves the mouse."""
        self.xtest.XTestFakeMotionEvent(self.display, 0, round(x), round(y), ctypes.c_ulong(0))
        self.x11.XFlush(self.display)

    def click(self, x, y):
        self.look(x, y)
        time.sleep(0.1)
        for down in (1, 0):
            self.xtest.XTestFakeButtonEvent(self.display, 1, down, ctypes.c_ulong(0))
            self.x11.XFlush(self.display)
            time.sleep(0.1)

    def press(self, key, times=1):
        """`key` as X names it: space, Escape, Return, Right, r."""
        code = self.x11.XKeysymToKeycode(
            self.display, ctypes.c_ulong(self.x11.XStringToKeysym(key.encode())))
        for _ in range(times):
            for down in (1, 0):
                self.xtest.XTestFakeKeyEvent(self.display, code, down, ctypes.c_ulong(0))
                self.x11.XFlush(self.display)
                time.sleep(0.06)

    def wait_for_window(self):
        """Returns once a program has drawn: the display is black before."""
        begin = time.time()
        while time.time() - begin < 60:
            width, height, rows = self.pixels()
            if any(rows[height // 2]):
                return
            time.sleep(0.05)
        raise AssertionError("no window has opened")

    def pixels(self, only_row=None):
        """Width, height and rows of RGB bytes of the display's image (Xvfb keeps an XWD file)."""
        def read():
            with open(glob.glob(self.folder.name + "/Xvfb_screen0")[0], "rb") as file:
                return file.read()

        data = read()
        for _ in range(100 if only_row is None else 0):  # the server may be in the middle of a frame
            before, data = data, read()
            if data == before:
                break
        head = struct.unpack(">25I", data[:100])
        start, width, height, line = head[0] + 12 * head[19], head[4], head[5], head[12]
        rows = []
        for y in range(height) if only_row is None else [only_row]:
            row = data[start + y * line:start + y * line + 4 * width]
            rgb = bytearray(3 * width)
            rgb[0::3], rgb[1::3], rgb[2::3] = row[2::4], row[1::4], row[0::4]
            rows.append(bytes(rgb))
        return width, height, rows

    def screenshot(self, path):
        width, height, rows = self.pixels()

        def chunk(kind, body):
            return (struct.pack(">I", len(body)) + kind + body +
                    struct.pack(">I", zlib.crc32(kind + body)))

        with open(path, "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n" +
                       chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                       chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) +
                       chunk(b"IEND", b""))

    def close(self):
        for program in self.programs:
            if program.poll() is None:
                program.kill()
                program.wait()
        self.x11.XCloseDisplay(self.display)
        self.server.terminate()
        self.server.wait()
        self.folder.cleanup()
