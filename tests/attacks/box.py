"""The boxes in which attacks run: a folder of small inputs, the program, and what counts as a fault."""

import os
import pathlib
import random
import shutil
import signal
import subprocess
import tempfile
import time

MEMORY_BYTES = 2 << 30  # no input here has 10 MB
CASES = []
LEDGER = ".foci-outputs"

SCREEN = "# screen_width_px=640 screen_height_px=480 screen_width_m=0.4 screen_height_m=0.3 viewing_distance_m=0.5\n"
STUDY = """[scene]
file = "scene.ply"
[eye]
position_m = [0, 0, 0]
look_at_m = [0, 0, -1]
[screen]
size_px = [640, 480]
size_m = [0.4, 0.3]
distance_m = 0.5
[gaze]
source = "trace.tsv"
[output]
size_px = [64, 48]
fps = 10
seconds = [0, 0.3]
"""
PAIRS = "x\ty\tx_target\ty_target\n-8\t-5\t-8\t-5\n8\t-5\t8\t-5\n8\t5\t8\t5\n-8\t5\t-8\t5\n0\t0\t0\t0\n"


def trace(samples=100, step_s=0.01):
    rows = "".join(f"{step_s * i:.4f}\t320\t{240 + i % 2}\n" for i in range(samples))
    return SCREEN + "time_s\tx_px\ty_px\n" + rows


def square_ply(n=16):
    points = "".join(f"{2 * ((i % n + 0.5) / n - 0.5)} {2 * ((i // n + 0.5) / n - 0.5)} -1 {37 * i % 256} 128 90\n"
                     for i in range(n * n))
    return (f"ply\nformat ascii 1.0\nelement vertex {n * n}\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n" + points)


def hang_s():
    """10 s, and more on a machine that does other work, too."""
    return 10.0 * max(1.0, os.getloadavg()[0] / os.cpu_count())


class Fault(Exception):
    def __init__(self, kind, what):
        super().__init__(what)
        self.kind, self.what = kind, what


class Skip(Exception):
    pass


def shown(text):
    return text.strip().replace("\n", " | ")[-300:]


class Process(subprocess.Popen):
    """A process whose peak of memory is known once it was waited for."""
    peak_bytes = 0

    def _try_wait(self, flags):
        try:
            pid, status, usage = os.wait4(self.pid, flags)
        except ChildProcessError:
            return self.pid, 0
        self.peak_bytes = usage.ru_maxrss * 1024
        return pid, status


class Outcome:
    def __init__(self, command, code, out, err, seconds, peak_bytes=0):
        self.command, self.code, self.out, self.err, self.seconds = command, code, out, err, seconds
        if seconds > hang_s() + 1:
            raise Fault("hangs", f"{command}: {seconds:.0f} s")
        if peak_bytes > MEMORY_BYTES:
            raise Fault("memory", f"{command}: {peak_bytes >> 20} MiB")
        if code < 0 or code > 2:
            raise Fault("crashes", f"{command}: {code}, {shown(err)}")
        if code != 0 and not err.strip():
            raise Fault("silent", f"{command}: exit code {code} without a line")

    def _expect(self, code, text):
        lines = [line for line in self.err.splitlines() if line.strip()]
        last = lines[-1] if lines else ""
        if self.code != code:
            raise Fault("silent", f"{self.command}: exit code {self.code}, expected {code}: {shown(self.err)}")
        if text not in last:
            raise Fault("silent", f"{self.command}: said {shown(last)}, expected {text}")
        return self

    def done(self):
        return self._expect(0, "")

    def refused(self, text=""):
        return self._expect(2, text)

    def failed(self, text=""):
        return self._expect(1, text)

    def any(self):
        return self

    def says(self, text):
        if text not in self.err:
            raise Fault("silent", f"{self.command}: said {shown(self.err)}, expected {text}")
        return self


class Box:
    """A folder with study.toml, scene.ply, trace.tsv, pairs.tsv; `outputs` may appear, nothing may change."""

    def __init__(self, foci, name):
        self.foci, self.name = foci, name
        self.random = random.Random(name)
        # Not below /tmp, which some cases hide.
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="foci-attack-", dir="/var/tmp")).resolve()
        self.changing = set()
        self.processes = []
        self.write("study.toml", STUDY)
        self.write("scene.ply", square_ply())
        self.write("trace.tsv", trace())
        self.write("pairs.tsv", PAIRS)
        self.before = None

    def __truediv__(self, name):
        return self.path / name

    def write(self, name, content):
        file = pathlib.Path(os.fsdecode(os.path.join(os.fsencode(self.path), os.fsencode(name))))
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content.encode() if isinstance(content, str) else content)
        return file

    def fifo(self, name):
        (self / name).parent.mkdir(parents=True, exist_ok=True)
        os.mkfifo(self / name)

    def may_change(self, *names):
        self.changing.update(names)

    def files(self):
        """Each file, link and folder below the box, with its content."""
        found = {}
        for folder, folders, names in os.walk(self.path):
            for name in folders + names:
                path = os.path.join(folder, name)
                inside = os.path.relpath(path, self.path)
                if os.path.islink(path):
                    found[inside] = ("link", os.readlink(path))
                elif os.path.isfile(path):
                    with open(path, "rb") as file:
                        found[inside] = ("file", file.read())
                else:
                    found[inside] = ("other", "")
        return found

    def start(self, *arguments, env=None, before=(), cwd=""):
        if self.before is None:
            self.before = self.files()
        self.outside = set(os.listdir(self.path.parent))
        process = Process(
            [*before, self.foci, *arguments], cwd=self.path / cwd, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, env={**os.environ, **(env or {})}, start_new_session=True)
        process.command = "foci " + " ".join(os.fsdecode(os.fsencode(a)).encode("utf-8", "replace").decode()
                                             for a in arguments)[:150]
        process.began = time.monotonic()
        self.processes.append(process)
        return process

    def finish(self, process, max_s=None):
        max_s = max_s or hang_s() + 1
        try:
            out, err = process.communicate(timeout=max_s)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            out, err = process.communicate()
            raise Fault("hangs", f"{process.command}: over {max_s:.0f} s: {shown(err.decode(errors='replace'))}")
        return Outcome(process.command, process.returncode, out.decode(errors="replace"), err.decode(errors="replace"),
                       time.monotonic() - process.began, process.peak_bytes)

    def run(self, *arguments, **how):
        return self.finish(self.start(*arguments, **how))

    def live(self, *arguments, **how):
        """Starts `foci live` under a virtual display."""
        if not shutil.which("xvfb-run"):
            raise Skip("no xvfb-run")
        return self.start("live", *arguments, before=("xvfb-run", "-a"), **how)

    def wait_for(self, found, what, process):
        """Waits until `found()` is true. @return false if the process ended before"""
        end = time.monotonic() + hang_s()
        while time.monotonic() < end:
            if found():
                return True
            if process.poll() is not None:
                return False
            time.sleep(0.002)
        raise Fault("hangs", f"{process.command}: {what} does not come")

    def staging(self):
        """The hidden folders of runs that write."""
        return [path for path in self.path.rglob(".foci-*") if path.name != LEDGER and path.is_dir()]

    def require(self, holds, what, kind="silent"):
        if not holds:
            raise Fault(kind, what)

    def require_unchanged(self):
        """No file has appeared, either."""
        new = set(self.files()) - set(self.before)
        self.require(not new, f"left {sorted(new)[:5]}", "overwrites")

    def judge(self):
        after = self.files()
        for name, was in (self.before or {}).items():
            if name in self.changing or os.path.basename(name) == LEDGER:
                continue
            if name not in after:
                raise Fault("overwrites", f"{name} is gone")
            if after[name] != was:
                raise Fault("overwrites", f"{name} has changed")
        for name in after:
            if os.path.basename(name) == "TOUCHED" and name not in (self.before or {}):
                raise Fault("executes", f"{name} is there")
        if self.staging():
            raise Fault("silent", f"left {self.staging()[0].name}")

    def close(self, keep):
        for process in self.processes:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
        if not keep:
            shutil.rmtree(self.path, ignore_errors=True)


class Case:
    def __init__(self, function, arguments):
        self.function, self.arguments = function, arguments
        words = " ".join(argument.decode("latin1") if isinstance(argument, bytes) else str(argument)
                         for argument in arguments)
        self.name = ascii(f"{function.__name__} {words}".strip())[1:-1]
        self.kind = self.what = ""

    def run(self, foci, keep):
        box = Box(foci, self.name)
        try:
            self.function(box, *self.arguments)
            box.judge()
        except Fault as fault:
            self.kind, self.what = fault.kind, fault.what + (f" ({box.path})" if keep else "")
        except Skip as skip:
            self.kind, self.what = "skipped", str(skip)
        except Exception as error:  # the case itself
            self.kind, self.what = "broken", repr(error)
        finally:
            box.close(keep and self.kind not in ("", "skipped"))
        return self


def attack(*values):
    """One case for each value, or one case without a value."""
    def add(function):
        for value in values or ((),):
            CASES.append(Case(function, value if isinstance(value, tuple) else (value,)))
        return function
    return add
