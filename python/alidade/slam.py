"""SLAM frame by frame."""

from __future__ import annotations

import atexit
import dataclasses
import inspect
import math
import os
import weakref
from typing import Any, Dict, List, Mapping, Optional, Tuple, Union

import numpy

from . import _core
from ._arguments import described, integer, meant, number, text
from ._log import tell_warnings
from ._paths import coded
from ._renamed import Renamed, warn
from .camera import Camera, PathLike
from .errors import UsageError
from .imu import Imu, Inertial, Orientation
from .maps import Map
from .running import Detector


@dataclasses.dataclass(frozen=True, eq=False)
class TrackResult:
    """Result of one frame."""

    frame: int
    """number of previous frames"""
    time: float
    """seconds"""
    state: str
    """"initializing", "tracking" or "lost\""""
    pose: Optional[numpy.ndarray]
    """(4, 4) T_world_camera; None unless tracking"""
    failure: Optional[str]
    """why there is no pose, as a name such as "few_matches"; None while tracking"""
    reason: str
    """the failure in words"""
    matches: int
    """number of landmarks matched consistently with the pose"""
    covariance: Optional[numpy.ndarray]
    """(6, 6) of the pose error in the camera's frame, translation then rotation: m², m rad, rad² (monocular: map
    units), relative to the map around the camera; None: unknown"""
    keyframe: bool
    """the frame became a keyframe"""
    predicted: Optional[numpy.ndarray]
    """(4, 4), if lost: pose by dead reckoning with an inertial sensor, otherwise shortly extrapolated from the motion"""
    orientation: Optional[Orientation]
    """with an inertial sensor, in every state; None: its rotation to the camera is not known yet"""
    cut: str
    """why the frame does not continue the previous one; empty: it does"""
    expected: int
    """number of landmarks expected in view"""
    inliers: int
    """of these, the number found consistent with the pose"""
    found_share: float
    """inliers / expected; a third is usual"""
    probability: float
    """that the pose is right, and not of another place that looks alike; 0: not tracking"""
    warning: str
    """which part of the system has failed, repeated with every frame; empty: none"""


@dataclasses.dataclass(frozen=True, eq=False)
class FramePose:
    """Current estimate of a frame's pose."""

    frame: int
    """number of previous frames"""
    time: float
    """seconds"""
    pose: Optional[numpy.ndarray]
    """(4, 4) T_world_camera; None: not tracked"""
    map: Optional[int]
    """the map whose world the pose refers to"""
    late: bool
    """the pose was estimated later (deferred localization)"""


@dataclasses.dataclass(frozen=True, eq=False)
class Features:
    """Features of the last frame, f of them."""

    pixels: numpy.ndarray
    """(f, 2) x y"""
    matched: numpy.ndarray
    """(f,) bool: matched to a landmark consistently with the pose"""
    static_probability: numpy.ndarray
    """(f,) probability of being static, 0 to 1"""


def _is_swapped(right: Any, depth: Any, sensor: str) -> bool:
    """The order of version 0.1, which a type that the argument cannot have gives away."""
    if sensor == "stereo":
        return right is None and getattr(depth, "dtype", None) == numpy.uint8
    return depth is None and getattr(right, "dtype", None) in (numpy.uint16, numpy.float32)


def _check_names(more_settings: Mapping[str, Any]) -> None:
    """Raises UsageError for a keyword that is neither an argument of Slam nor a setting, but near to one of the former.
    Slips in names of settings are found with the settings."""
    arguments = [name for name in inspect.signature(Slam.__init__).parameters if name not in ("self", "more_settings")]
    for name in more_settings:
        if "." not in name and name not in _core.setting_names():
            raise UsageError(f"Slam has no argument and no setting {name!r}"
                             f"{meant(name, [*arguments, *_core.setting_names()])}")


_open: "weakref.WeakSet[Slam]" = weakref.WeakSet()


class Slam:
    """Visual SLAM: images in, poses and a map out. Call finish() after the last frame, or leave the ``with`` block:
    without it the last adjustment and the poses of deferred localization are missing.

    camera: of the images; a Camera or a camera.yaml. sensor: "mono", "stereo" (camera.baseline) or "rgbd"
    (camera.depth_factor). semidense: also estimate semi-dense depth. dynamics: "auto", "off", "geometry" or "full".
    profile: "desktop" or "phone". seed: for all random numbers. localize: only estimate poses in the loaded map,
    without changing it.
    schedule: "inline" (default: all work of a frame is done when track() returns; reproducible) or "threaded"
    (track() never waits for mapping).
    config: a YAML file of settings. settings: {"tracker.extractor.features": 1500}, with the names of the program's
    ``--set``; alidade.settings() lists them all. Settings may also be passed as keywords: **{"semidense.voxel": 0.02}.
    mounting: Recording.mounting of a rectified recording; trajectory() then refers to the camera as mounted.
    record: records the stream from the first frame on, as record() does.
    imu: the inertial sensor whose readings are given to track(): an Imu, or a dict of its fields, {} if nothing is
    known of it. Lengths are then in meters once the readings tell them; see ``inertial``.
    calibrate: the camera is only approximate, such as Camera.from_fov(640, 480, 66). A monocular Slam then estimates
    focal length, distortion and rolling-shutter readout online and adapts the map; see ``camera``.

    detector: a YOLO network (.onnx), or a function of an image, (h, w, 3) blue green red or (h, w) gray, uint8, that
    returns a list of (class, score, x, y, width, height). class: a name ("person"; for other names set the function's
    attribute ``class_names``) or its number; x y: the box's top-left corner in pixels. With schedule "threaded" it is
    called in a separate thread with the newest frame whenever it is idle. If it raises, SLAM continues without it and
    logs a warning; see health(). Implies dynamics="full". The function cannot call track(), load(), reset(), finish(),
    close() and trajectory() of its own Slam, which would wait for it: they raise UsageError there.

    A forked process has no copy of the threads of schedule "threaded", view() and record(): there, all methods but
    close() raise UsageError.

    All methods may be called from any thread. track(), load(), leave_out(), reset(), finish(), view() and record() take
    turns, and trajectory() waits for a running track(); the others do not wait. Input images are copied only if their pixels are
    not contiguous within rows; none is kept.
    """

    def __init__(self, camera: Union[Camera, PathLike], *, sensor: str = "mono", semidense: bool = False,
                 dynamics: Optional[str] = None, detector: Union[None, PathLike, Detector] = None,
                 profile: str = "desktop", config: Optional[PathLike] = None,
                 settings: Optional[Mapping[str, Any]] = None, schedule: str = "inline",
                 seed: Optional[int] = None, localize: bool = False, mounting: Optional[numpy.ndarray] = None,
                 calibrate: bool = False, record: Optional[PathLike] = None,
                 imu: Union[None, Imu, Mapping[str, Any]] = None, **more_settings: Any) -> None:
        if "localise" in more_settings:
            warn("localise=", "localize=")
            localize = more_settings.pop("localise")
        _check_names(more_settings)
        options = dict(
            sensor=sensor, semidense=semidense, dynamics=dynamics, profile=profile, schedule=schedule, seed=seed,
            localize=localize, settings={**(settings or {}), **more_settings},
            detector=detector if detector is None or callable(detector) else coded(detector, "detector"),
            config=None if config is None else coded(config, "config"))
        if not isinstance(camera, (Camera, str, bytes, os.PathLike)):
            raise TypeError(f"camera must be an alidade.Camera or the path of a camera.yaml, not {described(camera)}")
        if not isinstance(camera, Camera):
            camera = Camera.from_yaml(camera, sensor)
        self._sensor = sensor
        self._has_imu = imu is not None
        if imu is not None and not isinstance(imu, Imu):
            if not isinstance(imu, Mapping):
                raise TypeError(f"imu must be an alidade.Imu or a dict of its fields, not {described(imu)}")
            imu = Imu(**imu)
        self._core = _core.Slam(camera, options, mounting, calibrate, imu)
        _open.add(self)
        if record is not None:
            self.record(record)

    # Processing; calls are serialized.

    def track(self, t: float, image: numpy.ndarray, right: Optional[numpy.ndarray] = None,
              depth: Optional[numpy.ndarray] = None, *, color: Optional[numpy.ndarray] = None,
              stamp: str = "", imu: Optional[numpy.ndarray] = None) -> TrackResult:
        """Processes one frame. Call in order of time.

        t: seconds. image: (h, w) gray or (h, w, 3) blue green red, uint8, of the camera's size (for red green blue
        pass image[..., ::-1], which costs a copy). right: stereo: the rectified right image. depth: RGB-D: (h, w),
        uint16 with camera.depth_factor per meter or float32 in meters, registered to the image; 0 or NaN = unknown.
        color: (h, w, 3) blue green red, for clouds, when image is gray. stamp: the time as text for
        save_trajectory(). imu: with Slam's imu: (n, 7), the readings since the last frame, in order of time and perhaps
        ahead of the image: time, angular rate x y z (rad/s), specific force x y z (m/s²).

        Arrays of any memory layout and byte order, and what NumPy can see as an array (tensors of PyTorch on the CPU);
        depth of another floating-point type is converted to float32.

        Raises ArrayError (an InputError and TypeError) for an array of another type or shape, UsageError for an image
        that the Slam's sensor does not have, InputError for an image of another size or a time that does not increase.
        The state is unchanged then.
        """
        t, stamp = number("t", t), text("stamp", stamp)
        if self._sensor == "mono":
            self._refuse(right=right, depth=depth)
        if _is_swapped(right, depth, self._sensor):
            warn("track(t, image, depth, right)", "track(t, image, right, depth)")
            right, depth = depth, right
        if self._sensor == "stereo":
            self._refuse(depth=depth)
        elif self._sensor == "rgbd":
            self._refuse(right=right)
        if imu is not None and not self._has_imu:
            raise UsageError("imu= is given, but this Slam knows of no inertial sensor; create it with imu=alidade.Imu()")
        try:
            told = self._core.track(t, image, depth, right, color, imu, stamp)
            if told["orientation"] is not None:
                told["orientation"] = Orientation(*told["orientation"])
            return TrackResult(**told)
        finally:
            tell_warnings()

    def _refuse(self, **images: Any) -> None:
        for name, image in images.items():
            if image is not None:
                sensor = "rgbd" if name == "depth" else "stereo"
                raise UsageError(f'{name}= is given, but this Slam has sensor="{self._sensor}", which would ignore it; '
                                 f'create it with sensor="{sensor}"')

    def load(self, map: Union[Map, PathLike]) -> None:
        """Loads a map to continue (a Map, or its path). Call before the first frame."""
        self._core.load(map._core if isinstance(map, Map) else _core.read_map(coded(map, "map")))

    def leave_out(self, mask: numpy.ndarray) -> None:
        """Leaves parts of the image out of all frames: a hood, a gripper, a caption. mask: (h, w), uint8, of the shape of
        the frames; nonzero = left out. Call before the first frame. Parts that move with the camera are found without
        it, too; counts["left_out"] is the share of the image that is left out."""
        self._core.leave_out(mask)

    def reset(self) -> None:
        """Starts a new recording with the next frame, which may have any time; keeps the maps."""
        self._core.reset()

    def forget(self) -> None:
        """Removes all maps and the poses in them; the next frame starts anew, as after reset()."""
        self._core.forget()

    def set_mapping(self, on: bool) -> None:
        """While off, poses are found in the maps as they are: no keyframe is added and no map started."""
        self._core.set_mapping(on)

    def finish(self, limit: float = math.inf) -> numpy.ndarray:
        """Completes pending work and adjusts the map, for at most `limit` seconds; Ctrl-C stops it early. Returns
        trajectory(). More frames may follow."""
        try:
            self._core.finish(number("limit", limit))
        finally:
            tell_warnings()
        return self.trajectory()

    # To be seen.

    def view(self, port: int = 0, host: str = "127.0.0.1") -> str:
        """Shows the camera, the map and the frames from now on in web browsers, as ``alidade run --viewer`` does. Returns
        the address to open. Called again: returns the same address.

        port: 0: any free one. host: an address of this machine; beyond 127.0.0.1 the returned address holds a token.
        Viewers that are too slow miss frames; track() does not wait for them. The page is served until close().
        Raises UsageError if the port is in use.
        """
        return self._core.view(integer("port", port), text("host", host))

    def record(self, path: PathLike) -> None:
        """Records the stream from now on, as ``alidade run --record`` does. finish(), close() and the end of the ``with``
        block complete it; for frames after finish(), call record() again.

        path: a folder, created if needed, in which the recording is run.stream (``alidade view FOLDER`` replays it), or
        a file that ends in .stream or, with ROS 2 messages, in .mcap. An earlier recording of the name is replaced.
        No frame is left out: track() waits if the disk is too slow.
        Raises InputError if it cannot be written, UsageError if a recording is going on or the folder holds the results
        of a run.
        """
        self._core.record(coded(path))

    def close(self) -> None:
        """Ends all threads and frees all memory."""
        self._core.close()
        _open.discard(self)

    def __enter__(self) -> Slam:
        return self

    def __exit__(self, kind: Any, *_: object) -> None:
        """Calls finish(), unless there was an error. Results remain available, and the recording is complete."""
        if self._core.closed:
            return
        if kind is None:
            self.finish()
        else:
            self._core.end_record()

    # Results.

    def trajectory(self, part: int = 0, *, live: bool = False) -> numpy.ndarray:
        """(n, 8): timestamp tx ty tz qx qy qz qw, T_world_camera of all frames so far in the map with the most frames
        (part 1: the next one), with later corrections; live: as estimated when each frame was processed."""
        return self._core.trajectory(integer("part", part), bool(live))

    def save_trajectory(self, path: PathLike, part: int = 0) -> None:
        """Writes the trajectory in TUM format. With the `stamp` arguments of track() it has the same bytes as
        trajectory.txt of ``alidade run``."""
        text = self._core.trajectory_text(integer("part", part))
        with open(coded(path), "w", encoding="ascii", newline="\n") as file:
            file.write(text)

    def frame_poses(self, since: int = 0) -> List[FramePose]:
        """All frames from number `since` on, including lost ones. Poses of the rectified camera."""
        return [FramePose(*row) for row in self._core.frame_poses(integer("since", since))]

    def map(self) -> Map:
        """An immutable snapshot of the current map; cheap."""
        return Map(self._core.map())

    def save(self, path: PathLike) -> None:
        """Writes the map as a map.alidade."""
        self.map().save(path)

    # Queries; any thread at any time.

    @property
    def camera(self) -> Camera:
        """The camera in use: scaled by the profile, with the estimated rolling-shutter readout; with ``calibrate`` also
        the estimated focal length and distortion."""
        return self._core.camera()

    @property
    def focal_sigma(self) -> Optional[float]:
        """With ``calibrate``: relative standard deviation of camera.fx; None: not estimated yet."""
        return self._core.focal_sigma()

    @property
    def settings(self) -> Dict[str, str]:
        """The settings in use, by name."""
        return self._core.settings()

    @property
    def frames(self) -> int:
        """Number of frames accepted by track()."""
        return self._core.frames()

    @property
    def inertial(self) -> Optional[Inertial]:
        """What images and inertial readings together tell so far; None without ``imu``."""
        told = self._core.inertial()
        return None if told is None else Inertial(**told)

    def features(self) -> Features:
        """The features of the last frame."""
        return Features(*self._core.features())

    def mover_mask(self) -> Optional[numpy.ndarray]:
        """(h, w) uint8, 255 at excluded moving parts of the last frame; None without dynamics, and while "auto" is not
        active."""
        return self._core.mover_mask()

    def detections(self) -> Optional[List[Tuple[Union[str, int], float, float, float, float, float]]]:
        """The newest detections; None: none yet."""
        return self._core.detections()

    def health(self) -> Dict[str, Optional[str]]:
        """Status of the parts besides the tracker ("mapping", "loop closing", "detector", ...): None if running, else
        why it failed."""
        return self._core.health()

    def counts(self) -> Dict[str, float]:
        """Number of relocalizations, loops, merges, cuts and predicted frames so far, by these names; left_out: the share
        of the image that leave_out() and what moves with the camera exclude."""
        return Renamed(self._core.counts())

    def times(self) -> Dict[str, numpy.ndarray]:
        """Processing times in milliseconds by stage (frame, extract, track, map, ...): one sample per frame; for map,
        loop and semidense per keyframe."""
        return self._core.times()


@atexit.register
def _close_all() -> None:
    # A detector's thread would wait for ever for the terminated interpreter.
    for slam in list(_open):
        slam.close()
