"""What a run leaves."""

from __future__ import annotations

import json
import os
import shutil
from typing import Any, Dict, Optional

import numpy

from . import _core
from .camera import PathLike
from .errors import InputError
from .maps import Map, _by_ending


def _poses(path: str) -> numpy.ndarray:
    with open(path, encoding="ascii") as file:
        rows = [line.split() for line in file if not line.startswith("#")]
    return numpy.array(rows, dtype=float).reshape(-1, 8)


class Result:
    """A finished run: the folder ``alidade run`` leaves (docs/reference/run-folder.md), as arrays.

    ``Result("alidade-out/desk")`` opens one that is there, whoever made it.
    """

    def __init__(self, folder: PathLike, *, _map: Optional[Map] = None, _keeper: Any = None) -> None:
        self.folder = os.fspath(folder)
        """Where its files are. Without ``out=`` a temporary folder that goes with this object."""
        if not os.path.isfile(self.file("stats.json")):
            raise InputError(f"{self.folder} holds no stats.json: it is not what a run leaves")
        self._map = _map
        self._keeper = _keeper

    def file(self, name: str) -> str:
        """Path of one of its files: "report.html", "landmarks.ply", ..."""
        return os.path.join(self.folder, name)

    def save(self, folder: PathLike) -> None:
        """Copies all files to a folder that is not there yet."""
        shutil.copytree(self.folder, os.fspath(folder))

    def export(self, path: PathLike, to: Optional[str] = None, *, format: str = "default", part: int = 0,
               min_observations: int = 1) -> str:
        """Writes what other programs read, as ``alidade export`` does of the folder; returns what it was, in words.

        to: "mcap": the run frame by frame as it was (if it was recorded, ``record=True``; else its poses), with path
            and points as they are in the end, as ROS 2 messages (docs/reference/mcap.md). Others: its map, as Map.export().
            None: by the ending of the path.
        format, part, min_observations: as of Map.export(), not for "mcap".
        """
        where = os.fspath(path)
        return _core.export_path(self.folder, where, to or _by_ending(where), format, part, min_observations)

    @property
    def trajectory(self) -> numpy.ndarray:
        """(n, 8): timestamp tx ty tz qx qy qz qw, T_world_camera of all frames placed in the largest map, corrected
        by all that was learnt until the end. The numbers of trajectory.txt."""
        return _poses(self.file("trajectory.txt"))

    @property
    def trajectory_live(self) -> numpy.ndarray:
        """(n, 8): the same as it was known when each frame was done."""
        return _poses(self.file("trajectory_live.txt"))

    @property
    def keyframes(self) -> numpy.ndarray:
        """(n, 8): poses of the keyframes."""
        return _poses(self.file("keyframes.txt"))

    @property
    def groundtruth(self) -> Optional[numpy.ndarray]:
        """(n, 8): the true poses where the recording was rendered, in a world of their own; else None."""
        path = self.file("groundtruth.txt")
        return _poses(path) if os.path.isfile(path) else None

    @property
    def stats(self) -> Dict[str, Any]:
        """stats.json."""
        with open(self.file("stats.json"), encoding="utf-8") as file:
            stats: Dict[str, Any] = json.load(file)
        return stats

    @property
    def map(self) -> Map:
        """The map; of a run of this process with its semi-dense cloud."""
        if self._map is None:
            self._map = Map.load(self.folder)
        return self._map

    def __repr__(self) -> str:
        stats = self.stats
        return (f"<alidade.Result {self.folder}: {stats['tracked']} of {stats['frames']} frames tracked, "
                f"{stats['keyframes']} keyframes>")
