// ROS bag 2.0: records of fields `name=value` and data; messages are in chunks, which may be packed
// (bz2, lz4), each followed by an index of its messages; at the end of the file all connections and
// chunks are told once more. librosbag_storage reads these too, but brings Boost, console_bridge,
// pluginlib and GnuPG with it, and gives a file up whose index is missing or damaged.
#pragma once

#include <memory>

#include "alidade/io/ros/containers/bags_module.h"
#include "alidade/io/ros/containers/byte_source.h"

namespace alidade {

bool LooksLikeRos1Bag(std::string_view start);  // of any version

// A bag without an index (cut short, never closed) or with a damaged one is read from its start, as
// far as it goes. Throws Error (input) when it is no such bag, or of version 1.
std::unique_ptr<BagFile> OpenRos1Bag(std::unique_ptr<ByteSource> source);

}  // namespace alidade
