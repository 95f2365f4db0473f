"""Frame by frame."""

from __future__ import annotations

import atexit
import dataclasses
import math
import os
import weakref
from typing import Any, Dict, List, Mapping, Optional, Tuple, Union

import numpy

from . import _core
from ._log import tell_warnings
from .camera import Camera, PathLike
from .maps import Map
from .running import Detector


@dataclasses.dataclass(frozen=True, eq=False)
class TrackResult:
    """What became of one frame."""

    frame: int
    """how many came before it"""
    time: float
    """seconds"""
    state: str
    """"initialising", "tracking" or "lost\""""
    pose: Optional[numpy.ndarray]
    """(4, 4) T_world_camera; None unless tracking"""
    reason: str
    """why there is no pose"""
    matches: int
    """landmarks the pose agrees with"""
    covariance: Optional[numpy.ndarray]
    """(6, 6) of the pose's error in the camera's own frame, translation then rotation: m², m rad, rad² (one camera:
    map units), against the map as it stands around the camera; None: not known"""
    keyframe: bool
    """the map remembers this frame"""
    predicted: Optional[numpy.ndarray]
    """(4, 4): lost for a moment only, this is where the camera's motion would have led; a guess"""
    cut: str
    """why the frame does not go on where the one before was; empty: it does"""
    expected: int
    """landmarks that should be in view"""
    inliers: int
    """of these, found where the pose says"""
    found_share: float
    """inliers / expected; a third is usual"""
    warning: str
    """what has stopped working, with every frame since; empty: nothing"""


@dataclasses.dataclass(frozen=True, eq=False)
class FramePose:
    """Where a frame was, as it is known by now."""

    frame: int
    time: float
    pose: Optional[numpy.ndarray]
    """(4, 4) T_world_camera; None: it was not tracked"""
    map: Optional[int]
    """in whose world"""
    late: bool
    """it got its pose later"""


@dataclasses.dataclass(frozen=True, eq=False)
class Features:
    """Of the last frame, f of them."""

    pixels: numpy.ndarray
    """(f, 2) x y"""
    matched: numpy.ndarray
    """(f,) bool: the pose agrees with the landmark it shows"""
    static_probability: numpy.ndarray
    """(f,) how likely it stands still"""


_open: "weakref.WeakSet[Slam]" = weakref.WeakSet()


class Slam:
    """Visual SLAM: images in, poses and a map out.

    camera: of the images; or a camera.yaml. sensor: "mono", "stereo" (camera.baseline) or "rgbd" (camera.depth_factor).
    semidense: map shape too. dynamics: "auto", "off", "geometry" or "full". profile: "desktop" or "phone". seed: of every
    random choice. localise: only find poses in the map that is loaded, and leave it as it is.
    schedule: "inline" (default: each frame's work is done when track() returns; the same result every time) or
    "threaded" (track() never waits for mapping).
    config: a YAML file of settings. settings: {"tracker.extractor.features": 1500}, by the names of the program's
    ``--set``; alidade.settings() has them all. They may be given as keywords, too: **{"semidense.voxel": 0.02}.
    mounting: Recording.mounting of recordings that are rectified: trajectory() is of the camera as mounted then.
    calibrate: the camera is only a guess, such as Camera.from_fov(640, 480, 66). One camera alone finds its focal
    length, distortion and rolling shutter while the map grows, which is changed to it as it stands: see ``camera``.

    detector: a YOLO network (.onnx), or a function of an image, (h, w, 3) blue green red or (h, w) grey of uint8,
    that gives a list of (class, score, x, y, width, height): class a name ("person"; other names in its attribute
    ``class_names``) or its number, x y the box's top-left corner in pixels. With schedule "threaded" it is called
    from a thread of its own, with the newest frame whenever it is free. What it raises is a warning, see health();
    SLAM goes on without it. Implies dynamics="full".

    Any thread may call anything. track(), load(), reset() and finish() take turns; the others don't wait for them.
    No image is copied on the way in when its pixels lie side by side, and none is kept.
    """

    def __init__(self, camera: Union[Camera, PathLike], *, sensor: str = "mono", semidense: bool = False,
                 dynamics: Optional[str] = None, detector: Union[None, PathLike, Detector] = None,
                 profile: str = "desktop", config: Optional[PathLike] = None,
                 settings: Optional[Mapping[str, Any]] = None, schedule: str = "inline",
                 seed: Optional[int] = None, localise: bool = False, mounting: Optional[numpy.ndarray] = None,
                 calibrate: bool = False, **more_settings: Any) -> None:
        options = dict(
            sensor=sensor, semidense=semidense, dynamics=dynamics, profile=profile, schedule=schedule, seed=seed,
            localise=localise, settings={**(settings or {}), **more_settings},
            detector=detector if detector is None or callable(detector) else os.fspath(detector),
            config=None if config is None else os.fspath(config))
        if not isinstance(camera, Camera):
            camera = Camera.from_yaml(camera, sensor)
        self._core = _core.Slam(camera, options, mounting, calibrate)
        _open.add(self)

    # Driving.

    def track(self, t: float, image: numpy.ndarray, depth: Optional[numpy.ndarray] = None,
              right: Optional[numpy.ndarray] = None, *, color: Optional[numpy.ndarray] = None,
              stamp: str = "") -> TrackResult:
        """One frame, in order of time.

        t: seconds. image: (h, w) grey or (h, w, 3) blue green red, uint8, of the camera's size (for red green blue
        pass image[..., ::-1], which costs a copy). depth: RGB-D: (h, w), uint16 in camera.depth_factor per metre or
        float32 metres, registered to the image; 0 or NaN = unknown. right: stereo: the rectified right image.
        color: (h, w, 3) blue green red, for clouds, when image is grey. stamp: the time as it is to be written in
        save_trajectory().

        Raises InputError for an image that cannot be, or a time that does not grow; nothing has changed then.
        """
        try:
            return TrackResult(**self._core.track(t, image, depth, right, color, stamp))
        finally:
            tell_warnings()

    def load(self, map: Union[Map, PathLike]) -> None:
        """Goes on in a map (a Map, or its path), before the first frame."""
        self._core.load((map if isinstance(map, Map) else Map.load(map))._core)

    def reset(self) -> None:
        """The next frame begins a new recording, its time may be any; the maps are kept."""
        self._core.reset()

    def finish(self, limit: float = math.inf) -> None:
        """Waits until the map is as good as it gets, `limit` seconds at most; Ctrl-C cuts it short. More frames may
        follow."""
        try:
            self._core.finish(limit)
        finally:
            tell_warnings()

    def close(self) -> None:
        """Ends all threads and lets go of everything."""
        self._core.close()
        _open.discard(self)

    def __enter__(self) -> Slam:
        return self

    def __exit__(self, kind: Any, *_: object) -> None:
        """Calls finish(), unless there was an error. Results can still be asked for."""
        if kind is None and not self._core.closed:
            self.finish()

    # Results.

    def trajectory(self, part: int = 0, *, live: bool = False) -> numpy.ndarray:
        """(n, 8): timestamp tx ty tz qx qy qz qw, T_world_camera of all frames so far that are placed in the map with
        the most of them (part 1: in the next), corrected by what was learnt since; live: as it was at the time."""
        return self._core.trajectory(part, live)

    def save_trajectory(self, path: PathLike, part: int = 0) -> None:
        """The same as text, in TUM's format; with the stamps that track() was given it has the same bytes as
        trajectory.txt of ``alidade run``."""
        text = self._core.trajectory_text(part)
        with open(path, "w", encoding="ascii", newline="\n") as file:
            file.write(text)

    def frame_poses(self, since: int = 0) -> List[FramePose]:
        """Every frame so far, from the `since`th on, lost ones too. Of the camera as rectified."""
        return [FramePose(*row) for row in self._core.frame_poses(since)]

    def map(self) -> Map:
        """The map as it is now: cheap, and never changes afterwards."""
        return Map(self._core.map())

    def save(self, path: PathLike) -> None:
        """Writes the map: a map.alidade."""
        self.map().save(path)

    # Questions.

    @property
    def camera(self) -> Camera:
        """As used: scaled by the profile, with what was found of its rolling shutter; with ``calibrate`` of its lens."""
        return self._core.camera()

    @property
    def focal_sigma(self) -> Optional[float]:
        """With ``calibrate``: standard deviation of camera.fx as a share of it; None: nothing is found so far."""
        return self._core.focal_sigma()

    @property
    def settings(self) -> Dict[str, str]:
        """As used, by name."""
        return self._core.settings()

    @property
    def frames(self) -> int:
        """How many track() has counted: all but those it refused."""
        return self._core.frames()

    def features(self) -> Features:
        """Of the last frame."""
        return Features(*self._core.features())

    def mover_mask(self) -> Optional[numpy.ndarray]:
        """(h, w) uint8, 255 where something was left out of the last frame as moving; None without dynamics
        and while "auto" has seen nothing to leave out."""
        return self._core.mover_mask()

    def detections(self) -> Optional[List[Tuple[Union[str, int], float, float, float, float, float]]]:
        """The detector's newest answer; None: none so far."""
        return self._core.detections()

    def health(self) -> Dict[str, Optional[str]]:
        """The parts beside the tracker ("mapping", "loop closing", "detector", ...): None when it runs, else why it
        has stopped."""
        return self._core.health()

    def counts(self) -> Dict[str, int]:
        """relocalisations, loops, merges, cuts, predicted, so far."""
        return self._core.counts()

    def times(self) -> Dict[str, numpy.ndarray]:
        """Milliseconds, one sample per frame (map, loop, semidense: per keyframe): frame, extract, track, map, ..."""
        return self._core.times()


@atexit.register
def _close_all() -> None:
    # Threads of a detector would wait for the interpreter that has gone.
    for slam in list(_open):
        slam.close()
