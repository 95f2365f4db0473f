// Where frames are relative to each other, by /tf_static.
#pragma once

#include <optional>
#include <string>

#include "alidade/geometry/se3.h"
#include "alidade/io/ros/source/bag_file.h"

namespace alidade {

// T_from_to along the tree of the static transforms; nullopt: not connected, or a name is empty.
// A damaged message tells nothing.
std::optional<Se3> StaticTransform(BagFile& bag, std::string from, std::string to);

}  // namespace alidade
