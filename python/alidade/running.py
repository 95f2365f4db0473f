"""Whole runs: a recording in, a trajectory and a map out."""

from __future__ import annotations

import dataclasses
import os
import tempfile
from typing import Any, Callable, Dict, Iterable, Mapping, Optional, Tuple, Union

from . import _core
from ._arguments import suggesting
from ._log import tell_warnings
from ._paths import coded
from ._renamed import warn
from .camera import Camera, PathLike
from .maps import Map
from .results import Result

Detection = Tuple[Union[str, int], float, float, float, float, float]
Detector = Callable[[Any], Iterable[Detection]]


@dataclasses.dataclass(frozen=True)
class Progress:
    """Progress of a run."""

    stage: str
    """opening, calibrating (self-calibration before the run), running, finishing"""
    frames: int
    """processed frames"""
    total: Optional[int]
    """None: unknown"""
    state: str
    """initializing, tracking or lost"""
    keyframes: int
    """number of keyframes in the map"""
    points: int
    """number of landmarks in the map"""
    viewer: Optional[str] = None
    """URL of the viewer, with ``viewer=``"""


@suggesting
def run(source: PathLike, *, sensor: Optional[str] = None, semidense: bool = False, dynamics: Optional[str] = None,
        detector: Union[None, PathLike, Detector] = None, camera: Union[None, PathLike, Camera] = None,
        fov: Union[None, float, str] = None, calibrate_first: bool = True, profile: str = "desktop",
        config: Optional[PathLike] = None, settings: Optional[Mapping[str, Any]] = None,
        load: Union[None, PathLike, Map] = None, out: Optional[PathLike] = None, schedule: Optional[str] = None,
        rate: Union[None, float, str] = None, repeat: int = 0, threads: int = 0, seed: Optional[int] = None,
        first: int = 0, last: int = -1, record: bool = False, record_to: Optional[PathLike] = None,
        viewer: bool = False, port: Optional[int] = None, host: Optional[str] = None, mask: Optional[PathLike] = None,
        imu: Optional[PathLike] = None, write_masks: bool = False, overwrite: bool = False,
        progress: Optional[Callable[[Progress], None]] = None) -> Result:
    """Runs SLAM on a recording, video or live camera, as ``alidade run`` does: with the same options and names, and
    the same bytes in every file.

    source: folder (TUM RGB-D, EuRoC, KITTI, images), ROS recording, video, "camera:0" or "synth:SCENE?frames=N".
    sensor: "mono", "stereo" or "rgbd"; None: depth or stereo if the recording has it.
    semidense: also estimate semi-dense depth at pixels with texture.
    dynamics: "auto" (as "off" until a large part of the image moves), "off", "geometry" (exclude moving objects) or
        "full" (also exclude objects the detector classifies as movable).
    detector: a YOLO network (.onnx), or a function of an image that returns (class, score, x, y, width, height) for
        each detection; see Slam. Implies dynamics="full".
    camera: a camera.yaml or a Camera, used instead of the recording's calibration; fov: horizontal field of view in
        degrees (70, or "~70" if approximate). calibrate_first: calibrate an unknown camera by playing the recording
        beforehand.
    profile: "desktop" or "phone"; config: a YAML file of settings; settings: {"tracker.extractor.features": 1500},
        with the names of ``--set`` (alidade.settings() lists them all).
    load: a map to continue (a Map, or its path).
    out: folder for the results. None: a temporary folder, which is deleted with the Result. Results of another source
        in it are refused. Earlier results of the same source are kept when the run fails, is interrupted or has fewer
        frames; its own are then in the folder's last-attempt. overwrite: replace whatever results are there.
    schedule: "inline" (reproducible) or "threaded" (as live); rate: "realtime", "max" or frames per second.
        repeat: number of times to play forwards and backwards. threads: for parallel loops, 0 = all cores; does not
        change results.
    first, last: frame numbers, both included.
    record: record the stream as run.stream in the results folder, for `alidade view`; record_to: record it to this
        file instead, as MCAP if it ends in .mcap. viewer: show the run in a browser (Progress.viewer is the URL);
        port, host: where it listens (8090 or the next free port, 127.0.0.1). mask: an image of
        the shape of the frames; what is white in it is left out of all of them. imu: a table of inertial
        readings, used instead of the recording's, or "off". write_masks: write images of the
        excluded moving parts.
    progress: called in this thread with a Progress when it changed, at most 20 times per second; an exception it
        raises ends the run.

    Raises Error. Ctrl-C, or an exception of `progress`, ends the run early: the results so far are written, and the
    exception is raised with the Result, if there is one, in its attribute ``result``. Only one run executes at a
    time; others wait.
    """
    return _run(dict(
        source=coded(source, "source"), sensor=sensor, semidense=semidense, dynamics=dynamics, fov=fov,
        calibrate_first=calibrate_first, profile=profile, settings=settings, schedule=schedule, rate=rate,
        repeat=repeat, threads=threads, seed=seed, first=first, last=last, mask=_path(mask, "mask"), imu=_path(imu, "imu"),
        write_masks=write_masks, overwrite=overwrite, **_watched(record, record_to, viewer, port, host)),
        detector, camera, config, load, out, progress)


@suggesting
def localize(source: PathLike, map: Union[PathLike, Map], *, sensor: Optional[str] = None,
             dynamics: Optional[str] = None, detector: Union[None, PathLike, Detector] = None,
             camera: Union[None, PathLike, Camera] = None, fov: Union[None, float, str] = None,
             calibrate_first: bool = True, profile: str = "desktop", config: Optional[PathLike] = None,
             settings: Optional[Mapping[str, Any]] = None, out: Optional[PathLike] = None,
             schedule: Optional[str] = None, rate: Union[None, float, str] = None, repeat: int = 0, threads: int = 0,
             seed: Optional[int] = None, first: int = 0, last: int = -1,
             record: bool = False, record_to: Optional[PathLike] = None, viewer: bool = False,
             port: Optional[int] = None, host: Optional[str] = None, mask: Optional[PathLike] = None,
             imu: Optional[PathLike] = None, write_masks: bool = False, overwrite: bool = False,
             progress: Optional[Callable[[Progress], None]] = None) -> Result:
    """Estimates the poses of a recording in an existing map without changing it, as ``alidade localize`` does. Poses
    are in the map's world. map: a Map, or its path; other arguments as for run()."""
    return _run(dict(
        source=coded(source, "source"), sensor=sensor, dynamics=dynamics, fov=fov, calibrate_first=calibrate_first,
        profile=profile, settings=settings, schedule=schedule, rate=rate, repeat=repeat, threads=threads, seed=seed,
        first=first, last=last, mask=_path(mask, "mask"), imu=_path(imu, "imu"), write_masks=write_masks, overwrite=overwrite, localize=True,
        **_watched(record, record_to, viewer, port, host)),
        detector, camera, config, map, out, progress)


def _path(path: Optional[PathLike], argument: str) -> Optional[bytes]:
    return None if path is None else coded(path, argument)


def _watched(record: Any, record_to: Optional[PathLike], viewer: Any, port: Optional[int],
             host: Optional[str]) -> Dict[str, Any]:
    """Options of recorder and viewer. Accepts what version 0.1 took, a path as `record` and a port as `viewer`."""
    if record is not None and not isinstance(record, bool):
        warn("record=PATH", "record_to=PATH", 4)
        record, record_to = False, record
    if viewer is not None and not isinstance(viewer, bool):
        warn("viewer=PORT", "viewer=True, port=PORT", 4)
        viewer, port = True, viewer
    return dict(record=record, record_to=_path(record_to, "record_to"), viewer=viewer, port=port,
                host=host)


def _run(options: Dict[str, Any], detector: Any, camera: Any, config: Any, load: Any, out: Any,
         progress: Optional[Callable[[Progress], None]]) -> Result:
    scratch = tempfile.TemporaryDirectory(prefix="alidade-")  # deleted with its last reference
    options["detector"] = detector if detector is None or callable(detector) else coded(detector, "detector")
    if isinstance(camera, Camera):
        options["camera_file"] = os.path.join(scratch.name, "camera.yaml")
        camera.to_yaml(options["camera_file"])
    elif camera is not None:
        options["camera_file"] = coded(camera, "camera")
    if isinstance(load, Map):
        options["load"] = os.path.join(scratch.name, "map.alidade")
        load.save(options["load"])
    elif load is not None:
        options["load"] = coded(load, "map" if options.get("localize") else "load")
    options["config"] = None if config is None else coded(config, "config")
    options["out"] = os.path.join(scratch.name, "result") if out is None else coded(out, "out")

    outcome: Dict[str, Any] = {}
    last: Dict[str, Any] = {}

    def told(values: Dict[str, Any]) -> None:
        tell_warnings()
        if progress is None or values == last:
            return
        last.update(values)
        values["total"] = values["total"] if values["total"] >= 0 else None
        values["viewer"] = values["viewer"] or None
        progress(Progress(**values))

    def result() -> Result:
        made = outcome.get("map")
        return Result(outcome["folder"], _map=None if made is None else Map(made),
                      _keeper=scratch if out is None else None)

    try:
        _core.run(options, told, outcome)
    except BaseException as error:
        if "folder" in outcome:
            error.result = result()  # type: ignore[attr-defined]
        raise
    finally:
        tell_warnings()
    return result()
