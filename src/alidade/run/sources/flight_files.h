// The files of a flight: its path, its inertial readings, its sensor.
#pragma once

#include "alidade/synth/flight.h"
#include "alidade/synth/settings.h"

namespace alidade {

// Reads SynthSettings::path (poses T_world_camera, in a format of ReadTrajectory()), ::imu unless
// "off" (lines of seconds, rad/s x y z, m/s² x y z) and ::imu_model (EuRoC's sensor.yaml of the
// camera: T_BS is the camera's pose in the sensor's frame; noise densities as in that of imu0 are
// taken if given). Warns if path and gyroscope
// contradict each other. Throws Error (input) naming the file.
Flight ReadFlight(const SynthSettings& settings);

}  // namespace alidade
