"""Evaluation against ground truth, with the same results as ``alidade evaluate``."""

from __future__ import annotations

import dataclasses
from typing import Any, List, Optional, Sequence, Tuple, Union

import numpy

from . import _core
from ._arguments import number, text
from ._paths import coded
from .camera import PathLike
from .errors import UsageError
from .results import Result

Span = Optional[Tuple[float, float]]


@dataclasses.dataclass(frozen=True, eq=False)
class ErrorStatistics:
    """Statistics of a list of errors, in their unit."""

    n: int
    """number of errors"""
    rmse: float
    """root of the mean square"""
    mean: float
    """arithmetic mean"""
    median: float
    """half of the errors are smaller"""
    std: float
    """standard deviation about the mean"""
    min: float
    """smallest error"""
    max: float
    """largest error"""
    scale: float
    """factor applied to the estimate's lengths"""
    coverage: float
    """share of the true poses within the recording that were matched, 0 to 1"""


@dataclasses.dataclass(frozen=True, eq=False)
class TrajectoryError(ErrorStatistics):
    """Absolute trajectory error, meters."""

    align: str
    """how the estimate was aligned: se3, sim3 or none"""
    align_why: str
    """the reason: monocular, depth or stereo, unknown sensor, or requested"""
    transform: numpy.ndarray
    """(4, 4): aligns the estimate to the ground truth; includes the scale"""
    pairs: numpy.ndarray
    """(n, 2): indices of matched rows of truth and estimate"""
    errors: numpy.ndarray
    """(n,) error of each pair, meters"""


@dataclasses.dataclass(frozen=True, eq=False)
class RelativePoseError:
    """Drift over a fixed step."""

    trans: ErrorStatistics
    """meters"""
    rot: ErrorStatistics
    """degrees"""
    align: str
    """how the estimate was aligned: se3, sim3 or none"""
    align_why: str
    """the reason: monocular, depth or stereo, unknown sensor, or requested"""


@dataclasses.dataclass(frozen=True, eq=False)
class DepthScore:
    """Scores of depth images. Errors are |scale · estimate - truth| / truth at each pixel that has both."""

    n: int
    """pixels that have both"""
    median_rel: float
    """median of the relative errors; 0.01: 1 %"""
    p90_rel: float
    """90 % of the relative errors are smaller"""
    within_2: float
    """share of errors up to 2 %"""
    within_5: float
    """share of errors up to 5 %"""
    within_10: float
    """share of errors up to 10 %"""
    rmse_inv: float
    """of inverse depth, 1/m"""
    density: float
    """share of all pixels that have depth"""
    density_gradient: float
    """share of the pixels with a strong gradient that have depth"""
    edge_coverage: float
    """share of edge pixels that have depth themselves or at a neighbor"""
    scale: float
    """factor by which the estimate was multiplied; 1 without fit_scale"""


@dataclasses.dataclass(frozen=True, eq=False)
class DepthErrors:
    """Scores of all frames together and of each frame."""

    all: DepthScore
    """at all pixels"""
    continuous: DepthScore
    """only where the true depth is continuous, because depth sensors are unreliable at discontinuities"""
    frames: List[Tuple[DepthScore, DepthScore]]
    """for each frame its scores at all pixels, and where the true depth is continuous"""
    scales: numpy.ndarray
    """of each map, meters per unit"""


def _estimate(estimate: Any, span: Span) -> Tuple[Any, str, Span]:
    """Returns poses, sensor ("" if unknown) and span."""
    if not isinstance(estimate, Result):
        return estimate, "", span
    stats = estimate.stats
    known = stats["span"]
    return estimate.trajectory, stats["sensor"], span or ((known[0], known[1]) if known else None)


def ate(truth: numpy.ndarray, estimate: Union[numpy.ndarray, Result], *, align: str = "auto",
        association: str = "tum", max_dt: float = 0.02, span: Span = None) -> TrajectoryError:
    """Absolute trajectory error: distance to the ground truth after alignment (Sturm et al. 2012).

    truth, estimate: (n, 8) timestamp tx ty tz qx qy qz qw, in any order; estimate may be a Result.
    align: "se3" (rotation and translation), "sim3" (also scale), "none", or "auto": "sim3" for a monocular Result,
        whose scale is unknown, otherwise "se3". The returned `align` says which was used.
    association: "tum" (one-to-one, closest first) or "evo"; max_dt: largest difference of matched stamps, seconds.
    span: times of the first and last frame of the recording, seconds, used for coverage; None: the Result's, or the
    estimate's own.

    Raises InputError for values that are not finite, and for fewer than 3 matched poses.
    """
    poses, sensor, span = _estimate(estimate, span)
    return TrajectoryError(**_core.ate(truth, poses, text("align", align), sensor, text("association", association),
                                       number("max_dt", max_dt), span))


def rpe(truth: numpy.ndarray, estimate: Union[numpy.ndarray, Result], *, delta: float = 1.0, unit: str = "s",
        pairs: str = "all", align: str = "auto", max_dt: float = 0.02, span: Span = None) -> RelativePoseError:
    """Relative pose error: drift over a fixed step (Sturm et al. 2012). delta: seconds (unit "s") or poses ("frames").
    pairs: "all", one from every pose as in TUM's tool; "consecutive": without overlap. Other arguments and errors as
    for ate()."""
    poses, sensor, span = _estimate(estimate, span)
    trans, rot, aligned, why = _core.rpe(truth, poses, number("delta", delta), text("unit", unit), text("pairs", pairs),
                                              text("align", align), sensor, number("max_dt", max_dt), span)
    return RelativePoseError(ErrorStatistics(**trans), ErrorStatistics(**rot), aligned, why)


def depth_errors(estimates: Sequence[numpy.ndarray], truths: Sequence[numpy.ndarray],
                 images: Sequence[numpy.ndarray], *, maps: Optional[Sequence[int]] = None,
                 fit_scale: bool = False) -> DepthErrors:
    """Errors of depth images relative to true depth.

    estimates: (h, w) float32 depth along z in the map's unit, 0 = none; may be smaller than the truth.
    truths: (h, w) float32, meters, 0 = unknown. images: (h, w) uint8, for the gradients and edges.
    maps: index of each frame's map, from 0; fit_scale: estimate each map's unit (monocular).

    Raises UsageError when the lists differ in length, InputError for invalid images.
    """
    numbers = [0] * len(estimates) if maps is None else list(maps)
    if not len(estimates) == len(truths) == len(images) == len(numbers):
        raise UsageError("depth_errors: as many truths, images and maps as estimates")
    scorer = _core.DepthErrors(fit_scale)
    for estimate, truth, image, map_index in zip(estimates, truths, images, numbers):
        scorer.add(estimate, truth, image, map_index)
    every, continuous, frames, scales = scorer.result()
    return DepthErrors(DepthScore(**every), DepthScore(**continuous),
                       [(DepthScore(**a), DepthScore(**b)) for a, b in frames], scales)


def read_trajectory(path: PathLike) -> numpy.ndarray:
    """Reads a trajectory, (n, 8), from a file in TUM, EuRoC or KITTI format, or the ground truth in a recording's
    folder. Raises InputError."""
    return _core.read_trajectory(coded(path))


def write_trajectory(path: PathLike, trajectory: numpy.ndarray) -> None:
    """Writes a trajectory, (n, 8), in TUM format."""
    text = _core.format_trajectory(trajectory)
    with open(coded(path), "w", encoding="ascii", newline="\n") as file:
        file.write(text)
