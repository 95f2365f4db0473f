"""Results of a run."""

from __future__ import annotations

import base64
import html
import json
import os
import shutil
from typing import Any, Dict, Optional

import numpy

from . import _core
from ._paths import coded, decoded
from ._renamed import Renamed
from .camera import PathLike
from .errors import InputError
from .maps import Map, _by_ending


def _poses(path: str) -> numpy.ndarray:
    with open(path, encoding="ascii") as file:
        rows = [line.split() for line in file if not line.startswith("#")]
    return numpy.array(rows, dtype=float).reshape(-1, 8)


class Result:
    """The results of a run: the files of ``alidade run`` (docs/reference/run-folder.md) as arrays.

    ``Result("alidade-out/desk")`` opens an existing folder of results. Raises InputError for any other folder.
    """

    def __init__(self, folder: PathLike, *, _map: Optional[Map] = None, _keeper: Any = None) -> None:
        self.folder = decoded(folder)
        """Folder of the files. Without ``out=`` a temporary folder that is deleted with this object."""
        if not os.path.isfile(self.file("stats.json")):
            raise InputError(f"{self.folder} holds no stats.json: it is not what a run leaves")
        self._map = _map
        self._keeper = _keeper

    def file(self, name: str) -> str:
        """Path of a file by name: "report.html", "landmarks.ply", ..."""
        return os.path.join(self.folder, name)

    def save(self, folder: PathLike) -> None:
        """Copies all files to a new folder."""
        shutil.copytree(self.folder, decoded(folder))

    def export(self, path: PathLike, to: Optional[str] = None, *, format: str = "default", part: int = 0,
               min_observations: Optional[int] = None, images: Optional[str] = "keyframes", masks: bool = False,
               source: Optional[PathLike] = None, camera: Optional[PathLike] = None) -> str:
        """Exports to another format, as ``alidade export`` does. Returns a description of what was written.

        to: "mcap": the run frame by frame (if recorded with ``record=True``; else its poses) and the final path and
            points, as ROS 2 messages (docs/reference/mcap.md). "colmap", "gsplat", "nerfstudio": a folder with
            undistorted images to train on (docs/guides/training.md). Other formats: the map, as Map.export(). None: by
            the ending of the path.
        format, part, min_observations: as in Map.export(), not for "mcap".
        images: "keyframes", "every:N" or "sharpest:RATE"; None: the model alone ("colmap").
        masks: also masks of moving objects, if the run wrote them. source, camera: where the recording and its
            calibration file are now; None: where the run read them.
        """
        return _core.export_path(coded(self.folder), coded(path), to or _by_ending(decoded(path)), format, part,
                                 min_observations or 0, images, masks, None if source is None else coded(source),
                                 None if camera is None else coded(camera))

    @property
    def trajectory(self) -> numpy.ndarray:
        """(n, 8): timestamp tx ty tz qx qy qz qw, T_world_camera of all frames in the largest map, with all later
        corrections. The content of trajectory.txt."""
        return _poses(self.file("trajectory.txt"))

    @property
    def trajectory_live(self) -> numpy.ndarray:
        """(n, 8): the poses as estimated when each frame was processed."""
        return _poses(self.file("trajectory_live.txt"))

    @property
    def keyframes(self) -> numpy.ndarray:
        """(n, 8): poses of the keyframes."""
        return _poses(self.file("keyframes.txt"))

    @property
    def groundtruth(self) -> Optional[numpy.ndarray]:
        """(n, 8): true poses of a rendered recording, in the scene's world frame; else None."""
        path = self.file("groundtruth.txt")
        return _poses(path) if os.path.isfile(path) else None

    @property
    def stats(self) -> Dict[str, Any]:
        """The content of stats.json."""
        with open(self.file("stats.json"), encoding="utf-8") as file:
            return Renamed(json.load(file))

    @property
    def map(self) -> Map:
        """The map; for a run of this process including its semi-dense cloud."""
        if self._map is None:
            self._map = Map.load(self.folder)
        return self._map

    def _repr_html_(self) -> str:
        """For notebooks: a picture of the place and the camera's path, and what happened."""
        stats = self.stats
        told = (f"{html.escape(os.path.basename(self.folder.rstrip('/')))}: {stats['tracked']} of {stats['frames']} "
                f"frames tracked, {stats['keyframes']} keyframes")
        picture = _core.result_picture(coded(self.folder))
        if picture is None:
            return f"<p>{told}</p>"
        kind = "png" if picture.startswith(b"\x89PNG") else "jpeg"
        return (f'<figure style="margin:0"><img style="max-width:100%" alt="The mapped place and the path of the camera" '
                f'src="data:image/{kind};base64,{base64.b64encode(picture).decode()}"><figcaption>{told}</figcaption>'
                "</figure>")

    def __repr__(self) -> str:
        stats = self.stats
        return (f"<alidade.Result {self.folder}: {stats['tracked']} of {stats['frames']} frames tracked, "
                f"{stats['keyframes']} keyframes>")
