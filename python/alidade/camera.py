"""Cameras."""

from __future__ import annotations

import dataclasses
import os
from typing import Optional, Sequence, Tuple, Union

import numpy

from . import _core
from ._arguments import integer, number, text
from ._paths import coded

PathLike = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]


@dataclasses.dataclass(frozen=True)
class Camera:
    """A pinhole camera with radial-tangential distortion, and the parameters of its depth sensor or stereo pair.

    Raises InputError for invalid values. Pixels as in OpenCV: 0, 0 is the center of the top-left pixel.
    """

    width: int
    """pixels"""
    height: int
    """pixels"""
    fx: float
    """horizontal focal length, pixels"""
    fy: float
    """vertical focal length, pixels"""
    cx: float
    """x of the principal point, pixels"""
    cy: float
    """y of the principal point, pixels"""
    distortion: Sequence[float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """k1 k2 p1 p2 [k3], as in OpenCV"""
    baseline: float = 0.0
    """distance of the right camera from the left one, meters; 0: no right camera"""
    depth_factor: float = 0.0
    """value of a uint16 depth image per meter; 0: no depth. float32 depth images are in meters, but
    ``sensor="rgbd"`` requires a factor nevertheless"""
    fps: float = 30.0
    """frames per second, for sources without time stamps"""
    readout: Optional[Tuple[float, float]] = None
    """rolling-shutter readout time, seconds from the first to the last column and row; None: estimated"""

    def __post_init__(self) -> None:
        values = tuple(float(value) for value in self.distortion)
        object.__setattr__(self, "distortion", values + (0.0,) * (5 - len(values)))
        _core.check_camera(self)

    @property
    def matrix(self) -> numpy.ndarray:
        """The matrix K, (3, 3)."""
        return numpy.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], dtype=float)

    @classmethod
    def from_fov(cls, width: int, height: int, degrees: float) -> Camera:
        """A pinhole camera without distortion, with this horizontal field of view in degrees."""
        return _core.camera_from_fov(integer("width", width), integer("height", height), number("degrees", degrees))

    @classmethod
    def from_yaml(cls, path: PathLike, sensor: str = "mono") -> Camera:
        """Reads a camera.yaml (docs/reference/camera.md). ``sensor``: its use, "mono", "stereo" or "rgbd".
        Fisheye cameras and unrectified stereo pairs require a Rectifier. Raises InputError."""
        return _core.read_camera(coded(path), text("sensor", sensor))

    def to_yaml(self, path: PathLike) -> None:
        """Writes a camera.yaml for from_yaml() and the program's ``--camera``."""
        _core.write_camera(coded(path), self)


class Rectifier:
    """Converts raw images (of a fisheye camera or an unrectified stereo pair) to those of a Camera.

    ``path``: a camera.yaml; ``sensor``: "mono", "stereo" or "rgbd". Raises InputError.
    """

    def __init__(self, path: PathLike, sensor: str = "mono") -> None:
        self._core = _core.Rectifier(coded(path), text("sensor", sensor))

    @property
    def camera(self) -> Camera:
        """The camera of the converted images, for Slam."""
        return self._core.camera

    def left(self, image: numpy.ndarray) -> numpy.ndarray:
        """Converts an (h, w) or (h, w, 3) uint8 image of the (left) camera. Returns the same array if no conversion is
        needed."""
        return self._core.left(image)

    def right(self, image: numpy.ndarray) -> numpy.ndarray:
        """The same for the right camera."""
        return self._core.right(image)

    def depth(self, depth: numpy.ndarray) -> numpy.ndarray:
        """Converts an (h, w) uint16 or float32 depth image by nearest-neighbor sampling."""
        return self._core.depth(depth)
