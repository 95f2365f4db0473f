// What a run does with a ROS recording: topics chosen, stamps read, pictures taken out of messages.
#pragma once

#include <string_view>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade::fuzz {

// `size`: bytes of the file, which bounds how much there can be in it.
void UseBag(BagFile& bag, size_t size);

// One message as each of the types that are read. Throws Error when it is none of them.
void UseMessage(std::string_view message, Serialization serialization);

}  // namespace alidade::fuzz
