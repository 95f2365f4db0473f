// rosbag2's SQLite files: a table of topics, and a table of messages (topic, nanoseconds, bytes).
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

bool LooksLikeDatabase(std::string_view start);

// Writes nothing beside the file. Reads a damaged file as far as possible. Decompresses single
// messages (rosbag2's compression mode `message`). Throws Error (input) when the file is not a
// rosbag2 database.
std::unique_ptr<BagFile> OpenRosbag2Database(const std::string& path);
std::unique_ptr<BagFile> OpenRosbag2DatabaseOf(std::string bytes);  // for tests

}  // namespace alidade
