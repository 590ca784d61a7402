import os
from typing import Any, Final, Iterator, Literal, Optional, Sequence, Tuple, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Pair = Sequence[float]
_Triple = Sequence[float]
_Path = Union[str, "os.PathLike[str]"]
_Detector = Literal["trained", "rules", "ivt", "idt"]

__version__: str

class InputError(ValueError): ...

class Screen:
    def __init__(self, size_px: Sequence[int] = ..., size_m: _Pair = ..., distance_m: float = ...) -> None: ...
    size_px: Final[Tuple[int, int]]
    size_m: Final[Tuple[float, float]]
    distance_m: Final[float]

class Eye:
    def __init__(self, pupil_mm: float = 4.0, position_m: _Triple = ..., look_at_m: _Triple = ..., up: _Triple = ...,
                 age_years: Optional[float] = None, sphere_D: float = 0.0, cylinder_D: float = 0.0,
                 axis_deg: float = 0.0, chromatic: bool = False, wavefront_um: Sequence[float] = ...,
                 wavefront_pupil_mm: Optional[float] = None, stiles_crawford: bool = False,
                 diffraction: bool = False) -> None: ...
    pupil_mm: Final[float]
    age_years: Final[Optional[float]]
    chromatic: Final[bool]
    position_m: Final[Tuple[float, float, float]]
    look_at_m: Final[Tuple[float, float, float]]
    up: Final[Tuple[float, float, float]]

class Scene:
    @staticmethod
    def open(path: _Path, scale_m: float = 1.0, viewpoint_m: Optional[_Triple] = None) -> Scene: ...
    @staticmethod
    def from_points(position_m: ArrayLike, color: Optional[ArrayLike] = None, normal: Optional[ArrayLike] = None,
                    radius_m: Optional[ArrayLike] = None) -> Scene: ...
    bounds_m: Final[Tuple[Tuple[float, float, float], Tuple[float, float, float]]]
    remarks: Final[list[str]]
    def __len__(self) -> int: ...

class Image:
    rgb: Final[NDArray[np.float32]]
    rgba: Final[NDArray[np.float32]]
    depth_m: Final[NDArray[np.float32]]
    defocus_D: Final[NDArray[np.float32]]
    blur_px: Final[NDArray[np.float32]]
    shape: Final[Tuple[int, int, int]]
    focus_D: Final[float]
    surface_distance_m: Final[Optional[float]]
    pupil_mm: Final[float]
    time_s: Final[float]
    state: Final[str]
    rendered: Final[bool]
    render_ms: Final[float]
    splats: Final[int]
    method: Final[str]
    def srgb(self, gamma: Optional[float] = None) -> NDArray[np.uint8]: ...
    def save(self, path: _Path) -> None: ...
    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> NDArray[Any]: ...

def render(scene: Scene, eye: Eye, screen: Screen = ..., *, focus_m: Optional[float] = None,
           gaze_px: Optional[_Pair] = None, size_px: Optional[Sequence[int]] = None, method: str = "auto",
           background: _Triple = ..., shading: float = 0.0, tolerance: float = 1.0, depth: bool = True) -> Image: ...

class Recording:
    def __init__(self, t: ArrayLike, x: ArrayLike, y: ArrayLike, pupil_mm: Optional[ArrayLike] = None,
                 screen: Screen = ..., rate_Hz: Optional[float] = None) -> None: ...
    @staticmethod
    def open(path: _Path, screen: Optional[Screen] = None, rate_Hz: Optional[float] = None) -> Recording: ...
    t: Final[NDArray[np.float64]]
    x: Final[NDArray[np.float64]]
    y: Final[NDArray[np.float64]]
    pupil_mm: Final[NDArray[np.float64]]
    screen: Final[Screen]
    rate_Hz: Final[float]
    format: Final[str]
    assumed: Final[list[str]]
    warnings: Final[list[str]]
    def __len__(self) -> int: ...
    def labels(self, *, online: bool = ..., detector: _Detector = ..., pursuit: Optional[bool] = ...,
               saccade_deg_s: float = ..., min_fixation_s: float = ..., max_blink_s: float = ...,
               delay_s: float = ...) -> NDArray[np.str_]: ...
    def quality(self, *, online: bool = ..., detector: _Detector = ..., pursuit: Optional[bool] = ...,
                saccade_deg_s: float = ..., min_fixation_s: float = ..., max_blink_s: float = ...,
                delay_s: float = ...) -> dict[str, Any]: ...
    def events(self, *, as_frame: bool = False, online: bool = ..., detector: _Detector = ...,
               pursuit: Optional[bool] = ..., saccade_deg_s: float = ..., min_fixation_s: float = ...,
               max_blink_s: float = ..., delay_s: float = ...) -> Any: ...

def events(t: ArrayLike, x: ArrayLike, y: ArrayLike, *, pupil_mm: Optional[ArrayLike] = None, screen: Screen = ...,
           rate_Hz: Optional[float] = None, as_frame: bool = False, online: bool = ..., detector: _Detector = ...,
           pursuit: Optional[bool] = ..., saccade_deg_s: float = ..., min_fixation_s: float = ...,
           max_blink_s: float = ..., delay_s: float = ...) -> Any: ...

class GazeMap:
    @staticmethod
    def fit(gaze: ArrayLike, target: ArrayLike, *, units: str = "px", screen: Screen = ...,
            model: Optional[Literal["offset", "affine", "second", "third"]] = None) -> GazeMap: ...
    @staticmethod
    def open(path: _Path, screen: Screen = ...) -> GazeMap: ...
    def save(self, path: _Path) -> None: ...
    @overload
    def apply(self, recording: Recording) -> Recording: ...
    @overload
    def apply(self, points: ArrayLike, units: str = "px") -> Tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def accuracy(self, gaze: ArrayLike, target: ArrayLike, units: str = "px") -> dict[str, Any]: ...
    model: Final[str]
    units: Final[str]
    screen: Final[Screen]

class State:
    time_s: Final[float]
    state: Final[str]
    gaze_px: Final[Optional[Tuple[float, float]]]
    fixation_px: Final[Optional[Tuple[float, float]]]
    surface_distance_m: Final[Optional[float]]
    target_D: Final[Optional[float]]
    focus_D: Final[float]
    pupil_mm: Final[float]

class Session:
    def __init__(self, scene: Scene, eye: Eye, screen: Screen = ..., *, rate_Hz: float, start_s: float = 0.0,
                 size_px: Optional[Sequence[int]] = None, method: str = "auto", background: _Triple = ...,
                 shading: float = 0.0, tolerance: float = 1.0, frame_ms: Optional[float] = None,
                 foveated: bool = False, pupil: Literal["fixed", "recording"] = "fixed", latency_s: float = ...,
                 time_constant_s: float = ..., depth: bool = False) -> None: ...
    @overload
    def push(self, t: float, x: float, y: float, pupil_mm: Optional[float] = None, blink: bool = False) -> None: ...
    @overload
    def push(self, t: ArrayLike, x: ArrayLike, y: ArrayLike, pupil_mm: Optional[ArrayLike] = None) -> None: ...
    def track(self, t: ArrayLike, x: ArrayLike, y: ArrayLike,
              pupil_mm: Optional[ArrayLike] = None) -> NDArray[Any]: ...
    def state(self, time_s: float) -> State: ...
    def frame(self, time_s: float) -> Image: ...
    def move(self, eye: Eye) -> None: ...

class Study:
    def __init__(self, path: _Path, *, scene: Optional[_Path] = None, trace: Optional[str] = None,
                 look: Optional[str] = None, up: Optional[str] = None, set: dict[str, Any] = ...) -> None: ...
    framing: Final[str]
    keys: Final[dict[str, Any]]
    def save(self, path: _Path) -> None: ...
    def replay(self, *, depth: bool = False) -> Replay: ...

class Replay:
    warnings: Final[list[str]]
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Image]: ...
    def events(self, *, as_frame: bool = False) -> Any: ...
    def fixations(self, *, as_frame: bool = False) -> Any: ...
    def saccades(self, *, as_frame: bool = False) -> Any: ...
    def gaze3d(self, *, as_frame: bool = False) -> Any: ...
    def objects(self, *, as_frame: bool = False) -> Any: ...

def methods() -> list[str]: ...
def set_threads(threads: int) -> None: ...
