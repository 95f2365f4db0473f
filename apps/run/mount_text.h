// Where a camera is on a robot, as --mount takes it.
#pragma once

#include <string>

#include "alidade/geometry/se3.h"

namespace alidade {

// What --help says of it, up to the default.
inline constexpr char kMountHelp[] =
    "Where the camera is on the base: \"x y z roll pitch yaw\" in meters and radians, or \"x y z "
    "qx "
    "qy qz qw\" of the optical frame. Default: ";

// T_base_camera of "x y z roll pitch yaw" of a camera that looks along its x axis, as tf2's
// static_transform_publisher takes them, or of "x y z qx qy qz qw" of its optical frame. Throws
// Error (usage) for other text.
Se3 MountOf(const std::string& text);

}  // namespace alidade
