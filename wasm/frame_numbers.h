// Numbers that JavaScript reads from the module's memory. web/tools/generate.mjs
// reads this file, so that names and order exist once: each field is one double.
#pragma once

// Of a frame.
struct FrameNumbers {
  double number = 0;
  double state = 0;      // TrackState
  double failure = 0;    // TrackFailure
  double placed = 0;     // 1: there is a pose, below
  double predicted = 0;  // 1: that pose is a guess
  double keyframes = 0;
  double landmarks = 0;
  double matches = 0;
  double features = 0;
  double maps = 0;
  double milliseconds = 0;
  double fov = 0;
  double fov_sigma = 0;
  double camera_changes = 0;
  double tx = 0;
  double ty = 0;
  double tz = 0;
  double qx = 0;
  double qy = 0;
  double qz = 0;
  double qw = 1;
  double oriented = 0;  // 1: the orientation by the inertial sensor is known, below
  double ox = 0;
  double oy = 0;
  double oz = 0;
  double ow = 1;
  double tilt_sigma = 0;
  double heading_sigma = 0;
};

// Of what the inertial sensor tells (InertialReport).
struct InertialNumbers {
  double samples = 0;
  double metric = 0;       // 1: lengths are meters
  double scale_sigma = 0;  // relative
  double falls = 0;        // 1: the direction of gravity is known, below
  double gx = 0;
  double gy = 0;
  double gz = 0;
  double gravity_sigma = 0;
  double time_offset = 0;
  double time_offset_sigma = 0;
};
