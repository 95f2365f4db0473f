// ROS bag 2.0: records consist of `name=value` fields and data. Messages are stored in chunks,
// which may be compressed (bz2, lz4); an index of its messages follows each chunk. All connections
// and chunks are listed at the end of the file. librosbag_storage is not used: it depends on Boost,
// console_bridge, pluginlib and GnuPG, and it fails on a file whose index is missing or damaged.
#pragma once

#include <memory>

#include "alidade/io/ros/containers/bags_module.h"
#include "alidade/io/ros/containers/byte_source.h"

namespace alidade {

bool LooksLikeRos1Bag(std::string_view start);  // true for any version of the format

// A bag without an index (truncated, never closed) or with a damaged one is read from its start as
// far as possible. Throws Error (input) when it is not a ROS bag or has version 1.
std::unique_ptr<BagFile> OpenRos1Bag(std::unique_ptr<ByteSource> source);

}  // namespace alidade
