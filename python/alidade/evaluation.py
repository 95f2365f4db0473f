"""Errors against the truth, as ``alidade evaluate`` gives them."""

from __future__ import annotations

import dataclasses
import os
from typing import Any, List, Optional, Sequence, Tuple, Union

import numpy

from . import _core
from .camera import PathLike
from .errors import UsageError
from .results import Result

Span = Optional[Tuple[float, float]]


@dataclasses.dataclass(frozen=True, eq=False)
class ErrorStatistics:
    """Of a list of errors, all in their unit."""

    n: int
    rmse: float
    mean: float
    median: float
    std: float
    min: float
    max: float
    scale: float
    """the estimate's lengths were multiplied by"""
    coverage: float
    """share of the true poses within the recording that have an estimate, 0 to 1"""


@dataclasses.dataclass(frozen=True, eq=False)
class TrajectoryError(ErrorStatistics):
    """Absolute trajectory error, metres."""

    align: str
    """how the estimate was aligned: se3, sim3 or none"""
    align_why: str
    """one camera, depth or stereo, the sensor is not known, or it was asked for"""
    transform: numpy.ndarray
    """(4, 4): lays the estimate on the truth; with its scale in it"""
    pairs: numpy.ndarray
    """(n, 2): rows of truth and estimate that were compared"""
    errors: numpy.ndarray
    """(n,) metres, of each"""


@dataclasses.dataclass(frozen=True, eq=False)
class RelativePoseError:
    """Drift over a fixed step."""

    trans: ErrorStatistics
    """metres"""
    rot: ErrorStatistics
    """degrees"""
    align: str
    """how the estimate was aligned: se3, sim3 or none"""
    align_why: str
    """one camera, depth or stereo, the sensor is not known, or it was asked for"""


@dataclasses.dataclass(frozen=True, eq=False)
class DepthScore:
    """Of depth: errors are |scale · estimate - truth| / truth at each pixel that has both."""

    n: int
    """pixels with both"""
    median_rel: float
    p90_rel: float
    within_2: float
    """share of errors up to 2 %"""
    within_5: float
    within_10: float
    rmse_inv: float
    """of inverse depth, 1/m"""
    density: float
    """share of all pixels that carry depth"""
    density_gradient: float
    """the same of those with a gradient"""
    edge_coverage: float
    """share of edge pixels that carry depth, or a neighbour does"""
    scale: float


@dataclasses.dataclass(frozen=True, eq=False)
class DepthErrors:
    """Of all frames together, and of each."""

    all: DepthScore
    """at all pixels"""
    continuous: DepthScore
    """where the truth is continuous: for a sensor's, which reads badly beside depth steps"""
    frames: List[Tuple[DepthScore, DepthScore]]
    scales: numpy.ndarray
    """of each map, metres per unit"""


def _estimate(estimate: Any, span: Span) -> Tuple[Any, str, Span]:
    """Poses, sensor (empty: not known), span."""
    if not isinstance(estimate, Result):
        return estimate, "", span
    stats = estimate.stats
    known = stats["span"]
    return estimate.trajectory, stats["sensor"], span or ((known[0], known[1]) if known else None)


def ate(truth: numpy.ndarray, estimate: Union[numpy.ndarray, Result], *, align: str = "auto",
        association: str = "tum", max_dt: float = 0.02, span: Span = None) -> TrajectoryError:
    """Absolute trajectory error: distance to the truth after alignment.

    truth, estimate: (n, 8) timestamp tx ty tz qx qy qz qw, in any order; estimate may be a Result.
    align: "se3" (rotate and shift), "sim3" (scale as well), "none", or "auto": "sim3" for a Result of one camera, which
    has no scale of its own, else "se3". What was done is the answer's `align`.
    association: "tum" (one-to-one, best first) or "evo"; max_dt: seconds between matched stamps.
    span: first and last frame of the recording in seconds, which coverage is judged over; None: the Result's, or the
    estimate's own.
    """
    poses, sensor, span = _estimate(estimate, span)
    return TrajectoryError(**_core.ate(truth, poses, align, sensor, association, max_dt, span))


def rpe(truth: numpy.ndarray, estimate: Union[numpy.ndarray, Result], *, delta: float = 1.0, unit: str = "s",
        pairs: str = "all", align: str = "auto", max_dt: float = 0.02, span: Span = None) -> RelativePoseError:
    """Relative pose error: drift over a fixed step. delta: in seconds (unit "s") or poses ("frames"). pairs: "all",
    from every pose, as TUM's tool; "consecutive": without overlap. All else as for ate()."""
    poses, sensor, span = _estimate(estimate, span)
    trans, rot, aligned, why = _core.rpe(truth, poses, delta, unit, pairs, align, sensor, max_dt, span)
    return RelativePoseError(ErrorStatistics(**trans), ErrorStatistics(**rot), aligned, why)


def depth_errors(estimates: Sequence[numpy.ndarray], truths: Sequence[numpy.ndarray],
                 images: Sequence[numpy.ndarray], *, maps: Optional[Sequence[int]] = None,
                 fit_scale: bool = False) -> DepthErrors:
    """Depth of frames against the truth.

    estimates: (h, w) float32 along z in the map's unit, 0 = none; may be smaller than the truth.
    truths: (h, w) float32 metres, 0 = unknown. images: (h, w) uint8, whose edges should carry depth.
    maps: the map each is of, from 0; fit_scale: fit each map's unit (one camera).
    """
    numbers = [0] * len(estimates) if maps is None else list(maps)
    if not len(estimates) == len(truths) == len(images) == len(numbers):
        raise UsageError("depth_errors: as many truths, images and maps as estimates")
    scorer = _core.DepthErrors(fit_scale)
    for estimate, truth, image, number in zip(estimates, truths, images, numbers):
        scorer.add(estimate, truth, image, number)
    every, continuous, frames, scales = scorer.result()
    return DepthErrors(DepthScore(**every), DepthScore(**continuous),
                       [(DepthScore(**a), DepthScore(**b)) for a, b in frames], scales)


def read_trajectory(path: PathLike) -> numpy.ndarray:
    """(n, 8) from a file of TUM's, EuRoC's or KITTI's format, or the truth beside a recording (a folder)."""
    return _core.read_trajectory(os.fspath(path))


def write_trajectory(path: PathLike, trajectory: numpy.ndarray) -> None:
    """(n, 8) as a file of TUM's format."""
    text = _core.format_trajectory(trajectory)
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(text)
