"""See a scene as the eye would focus it.

    import foci
    scene = foci.Scene.open("lion.ply")
    eye = foci.Eye(pupil_mm=4, position_m=(0, 0, 2), look_at_m=(0, 0, 0))
    image = foci.render(scene, eye, foci.Screen(), focus_m=0.8)

Lengths are metres, pupils millimetres, focus dioptres, gaze pixels from the screen's top-left corner. Bad input raises
InputError, a ValueError with one line.
"""

import numpy as _numpy

from ._foci import (Eye, GazeMap, Image, InputError, Recording, Replay, Scene, Screen, Session, State, Study,
                    __version__, methods, render, set_threads)

__all__ = ["Eye", "GazeMap", "Image", "InputError", "Recording", "Replay", "Scene", "Screen", "Session", "State",
           "Study", "events", "methods", "render", "set_threads"]

for _type in (Eye, GazeMap, Image, InputError, Recording, Replay, Scene, Screen, Session, State, Study):
    _type.__module__ = "foci"  # what users import, and read in errors
del _type


def _recording_events(self, *, as_frame=False, **settings):
    """Fixations, saccades, pursuit, blinks and data loss, in order of time.

    online: label as `foci live` does, without the future. detector: trained, rules, ivt or idt. pursuit: False counts
    it as fixation. saccade_deg_s, min_fixation_s, max_blink_s, delay_s: see docs/python.md. as_frame: return a pandas
    DataFrame.

    Returns a structured array with the fields event, onset_s, duration_s, x_px, y_px, start_x_px, start_y_px,
    amplitude_deg, peak_velocity_deg_s, probability. A value that an event does not have is NaN.
    """
    return _table(self._events(**settings), as_frame)


def _table(table, as_frame):
    if not as_frame:
        return table
    try:
        import pandas
    except ImportError:
        raise InputError("as_frame=True: needs pandas (Debian: python3-pandas)") from None
    return pandas.DataFrame.from_records(table)


Recording.events = _recording_events


def events(t, x, y, *, pupil_mm=None, screen=Screen(), rate_Hz=None, as_frame=False, **settings):
    """Events of gaze samples: Recording(t, x, y, ...).events(...).

    t: (N,), seconds, increasing. x, y: (N,), pixels of the screen; NaN stands for data loss.
    """
    return Recording(t, x, y, pupil_mm, screen, rate_Hz).events(as_frame=as_frame, **settings)


_WORDS = {"recording", "subject", "session", "trial", "trial_type", "object", "from_object", "to_object", "gaze_state",
          "event", "detector", "pupil_unit", "recorded_pupil_unit"}


def _read(text):
    """A TSV text as a structured array: words, and numbers, of which n/a is NaN."""
    names, *rows = (line.split("\t") for line in text.splitlines())
    columns = {name: [row[i] for row in rows] for i, name in enumerate(names)}
    types = [(name, f"U{max(map(len, column), default=1)}" if name in _WORDS else float)
             for name, column in columns.items()]
    table = _numpy.empty(len(rows), types)
    for name, column in columns.items():
        table[name] = column if name in _WORDS else [float("nan") if each == "n/a" else float(each) for each in column]
    return table


def _adds_table(name, what):
    def method(self, *, as_frame=False):
        return _table(_read(self._table(name)), as_frame)

    method.__name__ = method.__qualname__ = name
    method.__doc__ = f"""{what}

    Returns a structured array with the columns of {name}.tsv (docs/outputs.md); as_frame: a pandas DataFrame.
    """
    setattr(Replay, name, method)


_adds_table("events", "Fixations, saccades, pursuit, blinks and data loss.")
_adds_table("fixations", "A row for each fixation: gaze, object, distance, focus, defocus, blur.")
_adds_table("saccades", "A row for each saccade.")
_adds_table("gaze3d", "A row for each sample: line of sight, and the point, distance and object that it meets.")
_adds_table("objects", "A row for each object and trial: first look, dwell time, fixations, visits.")
