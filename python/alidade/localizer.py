"""Poses of single pictures in a map."""

from __future__ import annotations

import dataclasses
from typing import Optional, Union

import numpy

from ._arguments import number
from ._paths import coded
from . import _core
from .camera import Camera, PathLike
from .errors import UsageError
from .maps import Map


@dataclasses.dataclass(frozen=True, eq=False)
class Placement:
    """Where a picture was taken, or why that is not known."""

    placed: bool
    """whether there is a pose that is believed"""
    pose: Optional[numpy.ndarray]
    """(4, 4) T_world_camera in the world of that part; if not placed, the best guess or None"""
    covariance: Optional[numpy.ndarray]
    """(6, 6) of (translation; rotation) in the camera's frame, relative to the map aligned as a whole; None: unknown"""
    probability: float
    """that the pose is right, and not that of a place that looks alike"""
    reason: str
    """without a pose: blank, unknown, unlikely or several; else empty"""
    why: str
    """the same as a sentence"""
    metric: bool
    """whether lengths are meters, and not map units"""
    part: Optional[int]
    """index in Map.parts of the part with the pose"""
    keyframe: Optional[int]
    """id of the keyframe that shares the most landmarks with the picture"""
    expected: int
    """landmarks that should be visible from the pose"""
    inliers: int
    """of these, found where they should be"""
    agreement: float
    """share of the expected landmarks that was found, relative to that of the keyframe itself; 0.7 to 1.1 is usual"""
    keypoints: int
    """keypoints of the picture"""


class Localizer:
    """Finds where single pictures were taken, in a map of any sensor and lens, as ``alidade serve`` does.

    map: a Map, or the path of one or of a result folder. Raises InputError.

    The map does not change. Any number of threads may call localize() at the same time; they share the map, and the
    library releases the GIL.
    """

    def __init__(self, map: Union[Map, PathLike]) -> None:
        self._map = map if isinstance(map, Map) else Map.load(map)
        self._core = _core.Localizer(self._map._core)

    @property
    def map(self) -> Map:
        """The map."""
        return self._map

    def localize(self, image: numpy.ndarray, camera: Union[None, Camera, PathLike] = None, *,
                 fov: Optional[float] = None, min_probability: float = 0.0) -> Placement:
        """Finds the pose of a picture.

        image: (h, w) or (h, w, 3), uint8, gray or blue green red, as the camera took it.
        camera: of the picture: a Camera, or a camera.yaml, also of a fisheye. Its size is the picture's.
        fov: instead of a camera: horizontal field of view in degrees.
        min_probability: of a pose that is believed; 0: that of the map's settings (pose.min_probability).

        Without camera and fov it is the map's own camera. Raises ArrayError, InputError, UsageError.
        """
        if camera is not None and fov is not None:
            raise UsageError("give camera or fov, not both")
        shape = numpy.shape(image)
        if fov is not None and len(shape) >= 2:  # others are refused below
            camera = Camera.from_fov(shape[1], shape[0], fov)
        if camera is None:
            camera = self._map.camera
        given = camera if isinstance(camera, Camera) else coded(camera)
        probability = number("min_probability", min_probability)
        if not 0 <= probability < 1:
            raise UsageError(f"min_probability must be at least 0 and below 1, not {probability}")
        return Placement(**self._core.localize(image, given, probability))

    def __repr__(self) -> str:
        return f"<alidade.Localizer in {self._map!r}>"
