"""Recordings as NumPy arrays."""

from __future__ import annotations

import dataclasses
from typing import Iterator, Optional

import numpy

from . import _core
from ._arguments import suggesting
from ._log import tell_warnings
from ._paths import coded
from .camera import Camera, PathLike
from .imu import Imu


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    """One frame of a recording."""

    time: float
    """seconds"""
    stamp: str
    """the time as written in the recording"""
    number: int
    """index in the recording, from 0"""
    image: Optional[numpy.ndarray]
    """(h, w) uint8, gray; None when it could not be read (see ``problem``)"""
    right: Optional[numpy.ndarray] = None
    """stereo: the right image, (h, w) uint8, rectified"""
    depth: Optional[numpy.ndarray] = None
    """RGB-D: (h, w) uint16 with camera.depth_factor per meter, or float32 in meters"""
    color: Optional[numpy.ndarray] = None
    """(h, w, 3) uint8, blue green red; only if requested and available"""
    problem: str = ""
    """why the frame could not be read; empty: no problem"""
    true_pose: Optional[numpy.ndarray] = None
    """rendered recordings: true pose, (4, 4) T_world_camera, in the scene's world frame"""
    true_depth: Optional[numpy.ndarray] = None
    """rendered recordings: true depth, (h, w) float32, meters along z, 0 = no surface"""
    imu: Optional[numpy.ndarray] = None
    """(n, 7), inertial readings since the last frame, for Slam.track(); None: the recording has none"""


class Recording:
    """Iterates over the frames of a recording: ``for frame in recording``. Created by alidade.open()."""

    def __init__(self, core: _core.Source) -> None:
        self._core = core
        info = core.info()
        self.name: str = info["name"]
        """short, usable in a file name"""
        self.kind: str = info["kind"]
        """tum, euroc, kitti, images, video, synth, camera"""
        self.sensor: str = info["sensor"]
        """mono, stereo or rgbd"""
        self.camera: Camera = info["camera"]
        """after rectification, for Slam"""
        self.camera_guessed: bool = info["camera_guessed"]
        """no calibration is known: the field of view is assumed"""
        self.imu: Optional[Imu] = info["imu"]
        """what is known of the inertial sensor, for Slam; None: there are no readings"""
        self.frames: Optional[int] = info["frames"] if info["frames"] >= 0 else None
        """number of frames; None: unknown"""
        self.mounting: numpy.ndarray = info["mounting"]
        """(4, 4), from the rectified camera's frame to that of the camera as mounted, for Slam"""

    def __iter__(self) -> Iterator[Frame]:
        return self

    def __next__(self) -> Frame:
        frame = self._core.next()
        tell_warnings()
        if frame is None:
            raise StopIteration
        return Frame(**frame)

    def close(self) -> None:
        self._core.close()

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@suggesting
def open(source: PathLike, *, sensor: Optional[str] = None, camera: Optional[PathLike] = None,
         fov: Optional[float] = None, first: int = 0, last: int = -1, color: bool = False,
         imu: Optional[PathLike] = None) -> Recording:
    """Opens any source of ``alidade run`` for reading frame by frame as arrays.

    source: folder (TUM RGB-D, EuRoC, KITTI, images), ROS recording, video, "camera:0" or "synth:SCENE?frames=N".
    sensor: "mono", "stereo" or "rgbd"; None: depth or stereo if available.
    camera: a camera.yaml to use instead of the recording's calibration.
    fov: horizontal field of view in degrees, used instead of a calibration.
    first, last: frame numbers from 0, both included; -1: to the end.
    color: also read the frames' colors, if available.
    imu: a table of inertial readings, used instead of the recording's; "off": none.

    Raises InputError or UsageError.
    """
    options = {"source": coded(source, "source"), "sensor": sensor, "fov": fov, "first": first, "last": last,
               "imu": None if imu is None else coded(imu, "imu"),
               "camera_file": None if camera is None else coded(camera, "camera")}
    return Recording(_core.open(options, color))
