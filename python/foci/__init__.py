"""See a scene as the eye would focus it.

    import foci
    scene = foci.Scene.open("lion.ply")
    eye = foci.Eye(pupil_mm=4, position_m=(0, 0, 2), look_at_m=(0, 0, 0))
    image = foci.render(scene, eye, foci.Screen(), focus_m=0.8)

Lengths are metres, pupils millimetres, focus dioptres, gaze pixels from the screen's top-left corner. Bad input raises
InputError, a ValueError with one line.
"""

from ._foci import (Eye, GazeMap, Image, InputError, Recording, Scene, Screen, Session, State, __version__, methods,
                    render, set_threads)

__all__ = ["Eye", "GazeMap", "Image", "InputError", "Recording", "Scene", "Screen", "Session", "State", "events",
           "methods", "render", "set_threads"]

for _type in (Eye, GazeMap, Image, InputError, Recording, Scene, Screen, Session, State):
    _type.__module__ = "foci"  # what users import, and read in errors
del _type


def _recording_events(self, *, as_frame=False, **settings):
    """Fixations, saccades, pursuit, blinks and data loss, in order of time.

    online: label as `foci live` does, without the future. detector: trained, rules, ivt or idt. pursuit: False counts
    it as fixation. saccade_deg_s, min_fixation_s, max_blink_s, delay_s: see docs/python.md. as_frame: return a pandas
    DataFrame.

    Returns a structured array with the fields kind, onset_s, duration_s, x_px, y_px, start_x_px, start_y_px,
    amplitude_deg, peak_velocity_deg_s, probability. A value that an event does not have is NaN.
    """
    table = self._events(**settings)
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
