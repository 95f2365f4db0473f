// Aligns a finished result with inertial readings or measured positions.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace alidade {

struct GeoreferenceSettings {
  std::string to;                     // table of inertial readings or of positions
  std::string kind = "auto";          // imu, positions; auto: by the columns
  std::optional<std::string> camera;  // camera.yaml, whose block `imu` says what is known
  // An image taken at t was taken at t + time_offset on the clock of the table, seconds; nullopt:
  // estimated.
  std::optional<double> time_offset;
  // Of the receiver of the positions in the camera's frame (x right, y down, z forward), meters.
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();
  void Check() const;  // throws Error (usage)
};

// Writes the result folder `out`: every file of the result folder `result` in meters, with z up.
// Maps of the result that cannot be aligned are left out. Returns what was found as lines for
// users. Throws Error: usage; input if the largest map cannot be aligned, with the reason in
// figures, if a file cannot be read, or if `out` holds other things than an earlier result of this
// function.
std::vector<std::string> Georeference(const std::string& result, const std::string& out,
                                      const GeoreferenceSettings& settings);

}  // namespace alidade
