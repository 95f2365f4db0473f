"""Inertial sensors."""

from __future__ import annotations

import dataclasses
from typing import Optional

import numpy

from . import _core


@dataclasses.dataclass(frozen=True, eq=False)
class Imu:
    """What is known of an inertial sensor that is fixed to the camera. Its readings come with the frames: an (n, 7)
    array of time, angular rate x y z (rad/s), specific force x y z (m/s²: acceleration minus gravity, 9.81 upwards at
    rest), in the sensor's axes.

    Raises UsageError for invalid values.
    """

    T_camera_imu: Optional[numpy.ndarray] = None
    """(4, 4), pose of the sensor in the (left, rectified) camera's frame; None: estimated"""
    rate: float = 0.0
    """readings per second; 0: unknown"""
    gyro_noise: float = 1e-3
    """white noise of the angular rates, rad/s/√Hz"""
    accel_noise: float = 1e-2
    """white noise of the specific forces, m/s²/√Hz"""
    gyro_walk: float = 1e-4
    """random walk of the gyroscope's bias, rad/s²/√Hz"""
    accel_walk: float = 1e-3
    """random walk of the accelerometer's bias, m/s³/√Hz"""
    time_offset: Optional[float] = None
    """seconds: an image at t was taken at t + time_offset on the clock of the readings; None: estimated"""

    def __post_init__(self) -> None:
        _core.check_imu(self)


@dataclasses.dataclass(frozen=True, eq=False)
class Orientation:
    """Orientation of the camera by an inertial sensor, with a map and without. The z axis of its world is up, and its x
    axis is the horizontal direction in which the camera looked in the first frame."""

    rotation: numpy.ndarray
    """(3, 3) R_world_camera; the camera's axes are x right, y down, z forward"""
    tilt_sigma: float
    """standard deviation of the vertical, along its less known direction, radians"""
    heading_sigma: float
    """standard deviation of the angle about the vertical since the first frame, radians"""


@dataclasses.dataclass(frozen=True, eq=False)
class Inertial:
    """What images and inertial readings together tell so far."""

    samples: int
    """readings so far"""
    metric: bool
    """lengths of the newest map are meters because of the sensor"""
    scale_sigma: Optional[float]
    """relative standard deviation of those lengths; None: unknown"""
    gravity: Optional[numpy.ndarray]
    """(3,), unit vector in the world of the newest map, in which things fall; None: unknown"""
    gravity_sigma: Optional[float]
    """standard deviation of its direction, radians; None: unknown"""
    gyro_bias: numpy.ndarray
    """(3,), rad/s, in the sensor's axes"""
    accel_bias: numpy.ndarray
    """(3,), m/s², in the sensor's axes"""
    imu: Imu
    """the sensor as given, with what was estimated of it"""
    rotation_sigma: Optional[float]
    """standard deviation of the sensor's rotation, radians; None: given, or unknown"""
    time_offset_sigma: Optional[float]
    """standard deviation of the time offset, seconds; None: given, or unknown"""
    left_out: str
    """why the readings are not used, as a sentence; empty: they are"""
    missing: str
    """what the readings do not tell yet, as a sentence; empty: nothing"""
