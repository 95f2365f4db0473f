// Uses a ROS recording as a run does: chooses topics, reads stamps, decodes images.
#pragma once

#include <string_view>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade::fuzz {

// `size`: size of the file in bytes, which bounds its content.
void UseBag(BagFile& bag, size_t size);

// Reads one message as each supported type. Throws Error when it is none of them.
void UseMessage(std::string_view message, Serialization serialization);

}  // namespace alidade::fuzz
