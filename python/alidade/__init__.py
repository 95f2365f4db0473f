"""Alidade: from what a moving camera sees to where it is and what the place looks like.

Three levels, from one call to the parts:

1. A whole recording: ``result = alidade.run("desk")``. The same work, settings and files as the
   program ``alidade run``; ``result.trajectory``, ``result.map`` and ``result.stats`` are what came
   out. ``alidade.localize`` finds the poses of a recording in a map that is there.

2. Frame by frame, from NumPy arrays::

       camera = alidade.Camera(640, 480, fx=525, fy=525, cx=319.5, cy=239.5, depth_factor=5000)
       with alidade.Slam(camera, sensor="rgbd") as slam:
           for time, image, depth in frames:
               result = slam.track(time, image, depth=depth)
               print(result.pose if result.pose is not None else result.reason)

   ``alidade.open`` gives the frames of any recording as arrays.

3. The map as arrays: ``slam.map()`` or ``alidade.Map.load("map.alidade")`` has keyframes, points,
   covisibility and the semi-dense cloud; it can be saved, localised in and exported.

``alidade.ate``, ``rpe`` and ``depth_errors`` compare with the truth.

Units and frames, everywhere: metres, seconds, pixels (the centre of the top-left one is 0, 0). A
pose is a (4, 4) array ``T_world_camera``, which takes points of the camera's frame into the world;
``world`` is the first keyframe's (left) camera: x right, y down, z forward. One camera alone knows
no metres: its maps have a unit of their own. A trajectory is (n, 8): timestamp tx ty tz qx qy qz qw.

Errors are ``alidade.Error`` (``UsageError``, ``InputError``, ``NothingMapped``) and say what to do.
Warnings go to the logger ``alidade``. See docs/guides/python.md.
"""

from . import _core
from .camera import Camera, Rectifier
from .errors import Error, InputError, NothingMapped, RunStopped, UsageError
from .evaluation import (DepthErrors, DepthScore, ErrorStatistics, RelativePoseError, TrajectoryError, ate,
                         depth_errors, read_trajectory, rpe, write_trajectory)
from .maps import Cloud, KeyFrames, Map, MapPart, Observations, Points
from .recordings import Frame, Recording, open
from .results import Result
from .running import Progress, localize, run
from .slam import Features, FramePose, Slam, TrackResult

__version__: str = _core.version


def set_threads(threads: int) -> None:
    """How many threads parallel loops of all Slams use; 0: one for each core. Results are the same."""
    if not 0 <= threads <= 256:
        raise UsageError(f"threads must be from 0 (one for each core) to 256, not {threads}")
    _core.set_threads(threads)


def settings() -> "dict[str, str]":
    """Every setting with its default: the names ``settings=`` and the program's ``--set`` take."""
    return _core.setting_names()


__all__ = [
    "Camera", "Cloud", "DepthErrors", "DepthScore", "Error", "ErrorStatistics", "Features", "Frame", "FramePose",
    "InputError", "KeyFrames", "Map", "MapPart", "NothingMapped", "Observations", "Points", "Progress", "Recording",
    "Rectifier", "RelativePoseError", "Result", "RunStopped", "Slam", "TrackResult", "TrajectoryError", "UsageError",
    "ate", "depth_errors", "localize", "open", "read_trajectory", "rpe", "run", "set_threads", "settings",
    "write_trajectory",
]
