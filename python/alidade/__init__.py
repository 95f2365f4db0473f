"""Alidade: visual SLAM. Estimates a moving camera's trajectory and a map of its surroundings.

Three levels of use:

1. A whole recording: ``result = alidade.run("desk")``. The same processing, settings and files as the
   program ``alidade run``, with the results in ``result.trajectory``, ``result.map`` and
   ``result.stats``. ``alidade.localize`` estimates the poses of a recording in an existing map.

2. Frame by frame, from NumPy arrays::

       camera = alidade.Camera(640, 480, fx=525, fy=525, cx=319.5, cy=239.5, depth_factor=5000)
       with alidade.Slam(camera, sensor="rgbd") as slam:
           for time, image, depth in frames:
               result = slam.track(time, image, depth=depth)
               print(result.pose if result.pose is not None else result.reason)

   ``alidade.open`` returns the frames of any recording as arrays.

3. The map as arrays: ``slam.map()`` or ``alidade.Map.load("map.alidade")`` contains keyframes, points,
   covisibility and the semi-dense cloud. Maps can be saved, exported and used for localization.

``alidade.ate``, ``rpe`` and ``depth_errors`` evaluate results against ground truth.

Units and frames, everywhere: meters, seconds, pixels (0, 0 is the center of the top-left pixel). A
pose is a (4, 4) array ``T_world_camera``, which maps points of the camera's frame to the world;
``world`` is the first keyframe's (left) camera: x right, y down, z forward. The scale of a monocular
map is unknown: it has a unit of its own. A trajectory is (n, 8): timestamp tx ty tz qx qy qz qw.

Errors are raised as ``alidade.Error`` (``UsageError``, ``InputError``, ``NothingMapped``, …); the message
says what to do. Warnings go to the logger ``alidade``. See docs/guides/python.md.
"""

from . import _core
from ._arguments import integer
from ._fields import document_fields
from .camera import Camera, Rectifier
from .errors import ArrayError, Error, InputError, NothingMapped, RunStopped, UsageError
from .evaluation import (DepthErrors, DepthScore, ErrorStatistics, RelativePoseError, TrajectoryError, ate,
                         depth_errors, read_trajectory, rpe, write_trajectory)
from .imu import Imu, Inertial, Orientation
from .localizer import Localizer, Placement
from .maps import Cloud, KeyFrames, Map, MapPart, Observations, Points
from .recordings import Frame, Recording, open
from .results import Result
from .running import Progress, localize, run
from .slam import Features, FramePose, Slam, TrackResult

__version__: str = _core.version


def set_threads(threads: int) -> None:
    """Sets the number of threads for parallel loops of all Slams; 0: one per core. Does not change results.

    Raises UsageError outside 0 to 256.
    """
    threads = integer("threads", threads)
    if not 0 <= threads <= 256:
        raise UsageError(f"threads must be from 0 (one for each core) to 256, not {threads}")
    _core.set_threads(threads)


def settings() -> "dict[str, str]":
    """All settings with their defaults, by the names used in ``settings=`` and the program's ``--set``."""
    return _core.setting_names()


def describe_setting(name: str) -> "dict[str, object]":
    """What a setting does: a dict of name, default, unit, range, meaning and public (stable, or expert).

    Raises UsageError for an unknown name. ``alidade settings`` prints the same for all of them.
    """
    for setting in _core.setting_list():
        if name in (setting["name"], setting["name"].removeprefix("expert.")):
            return setting
    raise UsageError(f"unknown setting '{name}'; alidade.settings() has all names")


__all__ = [
    "ArrayError", "Camera", "Cloud", "DepthErrors", "DepthScore", "Error", "ErrorStatistics", "Features", "Frame", "FramePose",
    "Imu", "Inertial", "InputError", "KeyFrames", "Localizer", "Map", "MapPart", "NothingMapped", "Observations", "Orientation", "Placement", "Points", "Progress", "Recording",
    "Rectifier", "RelativePoseError", "Result", "RunStopped", "Slam", "TrackResult", "TrajectoryError", "UsageError",
    "ate", "depth_errors", "describe_setting", "localize", "open", "read_trajectory", "rpe", "run", "set_threads",
    "settings", "write_trajectory",
]

document_fields(thing for thing in map(globals().get, __all__) if isinstance(thing, type))
