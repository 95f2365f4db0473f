"""Maps as NumPy arrays."""

from __future__ import annotations

import dataclasses
import os
from typing import Callable, Dict, List, Optional, Tuple

import numpy

from . import _core
from ._arguments import described, integer, number
from ._paths import coded, decoded
from .camera import Camera, PathLike
from .errors import UsageError


@dataclasses.dataclass(frozen=True, eq=False)
class KeyFrames:
    """Keyframes, n of them, sorted by id."""

    ids: numpy.ndarray
    """(n,) uint32"""
    times: numpy.ndarray
    """(n,) seconds"""
    poses: numpy.ndarray
    """(n, 4, 4) T_world_camera"""
    numbers: numpy.ndarray
    """(n,) frame numbers: previous calls of track(), including those of a loaded map"""
    parents: numpy.ndarray
    """(n,) ids of the parents in the spanning tree; -1: none"""
    scales: numpy.ndarray
    """(n,) local scale: the factor by which loop closures of a monocular map changed lengths"""


@dataclasses.dataclass(frozen=True, eq=False)
class Points:
    """Landmarks, m of them, sorted by id."""

    ids: numpy.ndarray
    """(m,) uint32"""
    positions: numpy.ndarray
    """(m, 3) in the world, meters (monocular: map units)"""
    normals: numpy.ndarray
    """(m, 3) mean viewing direction from the cameras to the point, unit vectors"""
    static_probability: numpy.ndarray
    """(m,) probability of being static, 0 to 1"""
    seen_by: numpy.ndarray
    """(m,) number of keyframes that observe it"""


@dataclasses.dataclass(frozen=True, eq=False)
class Observations:
    """Observations of points in keyframes, k rows."""

    keyframes: numpy.ndarray
    """(k,) keyframe ids"""
    points: numpy.ndarray
    """(k,) point ids"""
    pixels: numpy.ndarray
    """(k, 2) x y in the raw (distorted) image"""


@dataclasses.dataclass(frozen=True, eq=False)
class Cloud:
    """Semi-dense depth of keyframes as p points."""

    points: numpy.ndarray
    """(p, 3) float32 in the world"""
    colors: numpy.ndarray
    """(p, 3) uint8, red green blue"""
    sigmas: numpy.ndarray
    """(p,) standard deviation along the viewing ray, in the map's unit"""


class MapPart:
    """One of the unconnected maps in a Map, with its own world frame. Arrays are created on access."""

    def __init__(self, core: _core.MapPart) -> None:
        self._core = core

    @property
    def keyframes(self) -> KeyFrames:
        """The keyframes as arrays."""
        return KeyFrames(**self._core.keyframes())

    @property
    def points(self) -> Points:
        """The landmarks as arrays."""
        return Points(**self._core.points())

    @property
    def observations(self) -> Observations:
        """Which keyframe sees which point, and where."""
        return Observations(**self._core.observations())

    @property
    def covisibility(self) -> numpy.ndarray:
        """(e, 3): ids of two keyframes, the smaller first, and their number of common points when last counted."""
        return self._core.covisibility()

    @property
    def loops(self) -> numpy.ndarray:
        """(l, 2): ids of keyframes connected by loop closures."""
        return self._core.loops()

    @property
    def metric(self) -> bool:
        """Whether lengths are meters: by stereo or depth, an inertial sensor, or a survey."""
        return self._core.metric

    @property
    def scale_sigma(self) -> Optional[float]:
        """Relative standard deviation of the lengths; None: unknown."""
        return self._core.scale_sigma

    @property
    def gravity(self) -> Optional[numpy.ndarray]:
        """(3,), unit vector in the world, in which things fall; None: unknown."""
        return self._core.gravity

    @property
    def gravity_sigma(self) -> Optional[float]:
        """Standard deviation of the direction of gravity, radians; None: unknown."""
        return self._core.gravity_sigma

    def cloud(self, voxel: float = 0.0) -> Cloud:
        """The semi-dense cloud (``semidense=True``). Empty for a map read from a file, because files do not contain it.

        voxel: edge length of the cubes within which points are merged, in the map's unit; 0: no merging.
        """
        return Cloud(**self._core.cloud(number("voxel", voxel)))

    def depth(self, keyframe: int) -> Optional[Tuple[numpy.ndarray, numpy.ndarray]]:
        """Semi-dense depth of a keyframe (by id) and its standard deviation, as two (h, w) float32 arrays along z of
        the undistorted image, 0 = unknown. None if the keyframe has no depth."""
        return self._core.depth(integer("keyframe", keyframe))


def _by_ending(path: str) -> str:
    """The export format for a file name's ending."""
    to = {".ply": "ply", ".pcd": "pcd", ".txt": "tum", ".tum": "tum", ".mcap": "mcap"}.get(os.path.splitext(path)[1])
    if to is None:
        raise UsageError(f'{path}: its ending does not say what to write; give to="ply", "pcd", "tum", "colmap", '
                         '"gsplat", "nerfstudio" or "mcap"')
    return to


class Map:
    """An immutable map, from Slam.map(), Result.map or Map.load().

    Maps that were never connected have separate world frames: ``parts``, sorted by descending number of keyframes.
    The properties ``keyframes``, ``points``, ``observations``, ``covisibility``, ``loops``, ``metric``,
    ``scale_sigma``, ``gravity``, ``gravity_sigma`` and ``cloud()`` refer to the first part.
    """

    def __init__(self, core: _core.Map) -> None:
        self._core = core

    @classmethod
    def load(cls, path: PathLike) -> Map:
        """Reads a map.alidade, or the one in the folder of a run. Raises InputError."""
        return cls(_core.read_map(coded(path)))

    @classmethod
    def from_bytes(cls, data: bytes) -> Map:
        """Decodes the result of to_bytes(). Raises InputError."""
        if not isinstance(data, bytes):
            raise TypeError(f"data must be bytes, not {described(data)}")
        return cls(_core.decode_map(data))

    def to_bytes(self) -> bytes:
        """The content of map.alidade. Equal maps give equal bytes."""
        return self._core.encode()

    def __reduce__(self) -> Tuple[Callable[[bytes], Map], Tuple[bytes]]:
        """Pickles what a file would hold: all but the semi-dense cloud."""
        return Map.from_bytes, (self.to_bytes(),)

    def __copy__(self) -> Map:
        return self

    def __deepcopy__(self, memo: Dict[int, object]) -> Map:
        return self

    def save(self, path: PathLike) -> None:
        """Writes a map.alidade; the file is complete or absent."""
        self._core.save(coded(path))

    def export(self, path: PathLike, to: Optional[str] = None, *, format: str = "default", part: int = 0,
               min_observations: Optional[int] = None) -> str:
        """Exports to another format, as ``alidade export`` does. Returns a description of what was written.

        to: "ply", "pcd" (the points), "tum" (the keyframes' trajectory), "colmap" (a folder with both; with images:
            Result.export()), "mcap" (both as ROS 2 messages). None: by the ending of the path.
        format: "text", "binary", "both" (colmap) or "default". part: index into ``parts``.
        min_observations: omits points observed by fewer keyframes; None: 2 for "colmap", else 1.
        """
        return self._core.export(coded(path), to or _by_ending(decoded(path)), format, part, min_observations or 0)

    @property
    def parts(self) -> List[MapPart]:
        """The unconnected maps, most keyframes first."""
        return [MapPart(part) for part in self._core.parts()]

    def _main(self) -> MapPart:
        parts = self.parts
        if not parts:
            raise UsageError("the map is empty")
        return parts[0]

    @property
    def keyframes(self) -> KeyFrames:
        """The keyframes of the first part as arrays."""
        return self._main().keyframes

    @property
    def points(self) -> Points:
        """The landmarks of the first part as arrays."""
        return self._main().points

    @property
    def observations(self) -> Observations:
        """Which keyframe of the first part sees which point, and where."""
        return self._main().observations

    @property
    def covisibility(self) -> numpy.ndarray:
        """(e, 3): ids of two keyframes, the smaller first, and their number of common points when last counted."""
        return self._main().covisibility

    @property
    def loops(self) -> numpy.ndarray:
        """(l, 2): ids of keyframes connected by loop closures."""
        return self._main().loops

    @property
    def metric(self) -> bool:
        """Whether lengths are meters: by stereo or depth, an inertial sensor, or a survey."""
        return self._main().metric

    @property
    def scale_sigma(self) -> Optional[float]:
        """Relative standard deviation of the lengths; None: unknown."""
        return self._main().scale_sigma

    @property
    def gravity(self) -> Optional[numpy.ndarray]:
        """(3,), unit vector in the world, in which things fall; None: unknown."""
        return self._main().gravity

    @property
    def gravity_sigma(self) -> Optional[float]:
        """Standard deviation of the direction of gravity, radians; None: unknown."""
        return self._main().gravity_sigma

    def cloud(self, voxel: float = 0.0) -> Cloud:
        """As MapPart.cloud()."""
        return self._main().cloud(voxel)

    @property
    def camera(self) -> Camera:
        """The camera of the keyframes."""
        return self._core.camera

    @property
    def sensor(self) -> str:
        """What the map was made with: mono, stereo or rgbd."""
        return self._core.sensor

    @property
    def settings(self) -> Dict[str, str]:
        """The settings the map was made with, by name."""
        return self._core.settings

    def __repr__(self) -> str:
        return f"<alidade.Map {self.sensor}: {self._core.keyframe_count} keyframes, {self._core.point_count} points>"
