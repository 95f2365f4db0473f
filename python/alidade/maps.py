"""Maps as NumPy arrays."""

from __future__ import annotations

import dataclasses
import os
from typing import Dict, List, Optional, Tuple

import numpy

from . import _core
from .camera import Camera, PathLike
from .errors import UsageError


@dataclasses.dataclass(frozen=True, eq=False)
class KeyFrames:
    """Frames the map remembers, n of them, by id."""

    ids: numpy.ndarray
    """(n,) uint32"""
    times: numpy.ndarray
    """(n,) seconds"""
    poses: numpy.ndarray
    """(n, 4, 4) T_world_camera"""
    numbers: numpy.ndarray
    """(n,) frame numbers: calls of track() so far, those of a loaded map included"""
    parents: numpy.ndarray
    """(n,) ids in the spanning tree; -1: none"""
    scales: numpy.ndarray
    """(n,) what loops of a monocular map multiplied lengths around it by"""


@dataclasses.dataclass(frozen=True, eq=False)
class Points:
    """Landmarks, m of them, by id."""

    ids: numpy.ndarray
    """(m,) uint32"""
    positions: numpy.ndarray
    """(m, 3) in the world, metres (one camera: map units)"""
    normals: numpy.ndarray
    """(m, 3) mean viewing direction, from the cameras to the point; unit"""
    static_probability: numpy.ndarray
    """(m,) how likely it stands still, 0 to 1"""
    seen_by: numpy.ndarray
    """(m,) keyframes that see it"""


@dataclasses.dataclass(frozen=True, eq=False)
class Observations:
    """Which keyframe sees which point where, k rows."""

    keyframes: numpy.ndarray
    """(k,) keyframe ids"""
    points: numpy.ndarray
    """(k,) point ids"""
    pixels: numpy.ndarray
    """(k, 2) x y in the image as taken, lens distortion and all"""


@dataclasses.dataclass(frozen=True, eq=False)
class Cloud:
    """Semi-dense depth of keyframes as p points."""

    points: numpy.ndarray
    """(p, 3) float32 in the world"""
    colors: numpy.ndarray
    """(p, 3) uint8, red green blue"""
    sigmas: numpy.ndarray
    """(p,) standard deviation along the ray it was seen by, in the map's unit"""


class MapPart:
    """One of the maps in a Map, with a world of its own. Arrays are made when they are asked for."""

    def __init__(self, core: _core.MapPart) -> None:
        self._core = core

    @property
    def keyframes(self) -> KeyFrames:
        return KeyFrames(**self._core.keyframes())

    @property
    def points(self) -> Points:
        return Points(**self._core.points())

    @property
    def observations(self) -> Observations:
        return Observations(**self._core.observations())

    @property
    def covisibility(self) -> numpy.ndarray:
        """(e, 3): ids of two keyframes, the smaller first, and how many points both saw when that was last counted."""
        return self._core.covisibility()

    @property
    def loops(self) -> numpy.ndarray:
        """(l, 2): ids of keyframes that closed loops tie together."""
        return self._core.loops()

    def cloud(self, voxel: float = 0.0) -> Cloud:
        """The semi-dense cloud (``semidense=True``); of a map read from a file it is empty: files don't hold it.

        voxel: edge of the cubes whose points become one, in the map's unit; 0: every pixel is a point.
        """
        return Cloud(**self._core.cloud(voxel))

    def depth(self, keyframe: int) -> Optional[Tuple[numpy.ndarray, numpy.ndarray]]:
        """Semi-dense depth of a keyframe (an id), and its standard deviation: two (h, w) float32 along z, 0 where
        nothing is known; of the undistorted image. None: it has none."""
        return self._core.depth(int(keyframe))


def _by_ending(path: str) -> str:
    """What the ending of a file's name says is to be written."""
    to = {".ply": "ply", ".pcd": "pcd", ".txt": "tum", ".tum": "tum", ".mcap": "mcap"}.get(os.path.splitext(path)[1])
    if to is None:
        raise UsageError(f'{path}: its ending does not say what to write; give to="ply", "pcd", "tum", "colmap" '
                         'or "mcap"')
    return to


class Map:
    """A map: a value that never changes. From Slam.map(), Result.map or Map.load().

    What was never joined lies in several worlds: ``parts``, the one with the most keyframes first. The properties
    ``keyframes``, ``points``, ``observations``, ``covisibility``, ``loops`` and ``cloud()`` are of that one.
    """

    def __init__(self, core: _core.Map) -> None:
        self._core = core

    @classmethod
    def load(cls, path: PathLike) -> Map:
        """Reads a map.alidade, or the one in the folder a run left."""
        return cls(_core.read_map(os.fspath(path)))

    @classmethod
    def from_bytes(cls, data: bytes) -> Map:
        """What to_bytes() gave."""
        return cls(_core.decode_map(data))

    def to_bytes(self) -> bytes:
        """As the file has it. Equal maps give equal bytes."""
        return self._core.encode()

    def save(self, path: PathLike) -> None:
        """Writes a map.alidade: whole, or not at all."""
        self._core.save(os.fspath(path))

    def export(self, path: PathLike, to: Optional[str] = None, *, format: str = "default", part: int = 0,
               min_observations: int = 1) -> str:
        """Writes what other programs read, as ``alidade export`` does; returns what it was, in words.

        to: "ply", "pcd" (the points), "tum" (the keyframes' trajectory), "colmap" (a model of both, a folder), "mcap"
            (both as ROS 2 messages). None: by the ending of the path.
        format: "text", "binary", "both" (colmap) or "default".
        min_observations: points that fewer keyframes see are left out.
        """
        where = os.fspath(path)
        return self._core.export(where, to or _by_ending(where), format, part, min_observations)

    @property
    def parts(self) -> List[MapPart]:
        return [MapPart(part) for part in self._core.parts()]

    def _main(self) -> MapPart:
        parts = self.parts
        if not parts:
            raise UsageError("the map is empty")
        return parts[0]

    @property
    def keyframes(self) -> KeyFrames:
        return self._main().keyframes

    @property
    def points(self) -> Points:
        return self._main().points

    @property
    def observations(self) -> Observations:
        return self._main().observations

    @property
    def covisibility(self) -> numpy.ndarray:
        """(e, 3): ids of two keyframes, the smaller first, and how many points both saw when that was last counted."""
        return self._main().covisibility

    @property
    def loops(self) -> numpy.ndarray:
        """(l, 2): ids of keyframes that closed loops tie together."""
        return self._main().loops

    def cloud(self, voxel: float = 0.0) -> Cloud:
        """As MapPart.cloud()."""
        return self._main().cloud(voxel)

    @property
    def camera(self) -> Camera:
        """That of its keyframes' pixels."""
        return self._core.camera

    @property
    def sensor(self) -> str:
        return self._core.sensor

    @property
    def settings(self) -> Dict[str, str]:
        """Those it was made with, by name."""
        return self._core.settings

    def __repr__(self) -> str:
        return f"<alidade.Map {self.sensor}: {self._core.keyframe_count} keyframes, {self._core.point_count} points>"
