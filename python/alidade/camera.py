"""Cameras."""

from __future__ import annotations

import dataclasses
import os
from typing import Optional, Sequence, Tuple, Union

import numpy

from . import _core

PathLike = Union[str, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True)
class Camera:
    """A pinhole camera with radial-tangential distortion, and what measures depth beside it.

    Lengths in pixels; the centre of the top-left pixel is 0, 0 (as in OpenCV).
    """

    width: int
    """pixels"""
    height: int
    fx: float
    """focal lengths, pixels"""
    fy: float
    cx: float
    """principal point, pixels"""
    cy: float
    distortion: Sequence[float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """k1 k2 p1 p2 [k3], as OpenCV has them"""
    baseline: float = 0.0
    """metres between the left and the right camera; 0: there is none"""
    depth_factor: float = 0.0
    """value of a uint16 depth image per metre; 0: there is none. float32 images are metres, but any
    factor must be given for ``sensor="rgbd"``"""
    fps: float = 30.0
    """frames per second, where time stamps don't say"""
    readout: Optional[Tuple[float, float]] = None
    """rolling shutter: seconds from the first to the last column and row; None: to be found"""

    def __post_init__(self) -> None:
        values = tuple(float(value) for value in self.distortion)
        object.__setattr__(self, "distortion", values + (0.0,) * (5 - len(values)))
        _core.check_camera(self)

    @property
    def matrix(self) -> numpy.ndarray:
        """K, (3, 3)."""
        return numpy.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], dtype=float)

    @classmethod
    def from_fov(cls, width: int, height: int, degrees: float) -> Camera:
        """A plain pinhole of a horizontal field of view."""
        return _core.camera_from_fov(width, height, degrees)

    @classmethod
    def from_yaml(cls, path: PathLike, sensor: str = "mono") -> Camera:
        """Reads a camera.yaml (docs/reference/camera.md). ``sensor``: what it is to be used as, "mono",
        "stereo" or "rgbd". Fisheyes, and stereo pairs that are not rectified yet, need a Rectifier."""
        return _core.read_camera(os.fspath(path), sensor)

    def to_yaml(self, path: PathLike) -> None:
        """Writes a camera.yaml, which from_yaml() and the program's ``--camera`` read."""
        _core.write_camera(os.fspath(path), self)


class Rectifier:
    """Turns images as taken (fisheye, a stereo pair as mounted) into those of a plain camera.

    ``path``: a camera.yaml; ``sensor``: "mono", "stereo" or "rgbd".
    """

    def __init__(self, path: PathLike, sensor: str = "mono") -> None:
        self._core = _core.Rectifier(os.fspath(path), sensor)

    @property
    def camera(self) -> Camera:
        """That of the images it gives: for Slam."""
        return self._core.camera

    def left(self, image: numpy.ndarray) -> numpy.ndarray:
        """(h, w) or (h, w, 3) uint8 of the (left) camera. The same array when there is nothing to do."""
        return self._core.left(image)

    def right(self, image: numpy.ndarray) -> numpy.ndarray:
        """The same of the right camera."""
        return self._core.right(image)

    def depth(self, depth: numpy.ndarray) -> numpy.ndarray:
        """(h, w) uint16 or float32: nearest pixels, values as they are."""
        return self._core.depth(depth)
