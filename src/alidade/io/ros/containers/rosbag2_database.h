// rosbag2's SQLite files: a table of topics, and one of messages (topic, nanoseconds, bytes).
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

bool LooksLikeDatabase(std::string_view start);

// Nothing is written beside the file. A damaged one is read as far as it goes. Messages packed one
// by one (rosbag2's compression mode `message`) are unpacked. Throws Error (input) when it is none
// of rosbag2's.
std::unique_ptr<BagFile> OpenRosbag2Database(const std::string& path);
std::unique_ptr<BagFile> OpenRosbag2DatabaseOf(std::string bytes);  // for tests

}  // namespace alidade
