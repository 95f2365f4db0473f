// Opens ROS recordings with the module of io/ros/containers, which is loaded on first use.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

// Parsed form of a source such as "walk.bag?image=/cam0/image_raw&depth=".
struct BagQuery {
  std::string path;
  // Requested topics. Empty: do not use any of that kind. nullopt: choose automatically.
  std::optional<std::string> image, right, depth, info, right_info, imu;
  std::optional<double> max_dt;  // largest time difference between associated messages, seconds
};

// true for a ROS recording: a file with a known ending (.bag, .bag.active, .mcap, .db3, and
// .mcap.zstd or .db3.zstd), a file with the first bytes of such a container, or a folder that
// contains a file with a known ending.
bool IsBagRecording(const std::string& path);
// The same for a path followed by `?name=value&…`. A path that exists with the `?` in its name is
// taken literally.
bool IsBagSource(const std::string& source);
BagQuery ParseBagQuery(const std::string& source);  // throws Error (usage)

// The files of a recording in order: `path` itself, or those in the folder (name_2 before name_10).
std::vector<std::string> FilesOfBag(const std::string& path);

// Throws Error (input) when the recording cannot be read or the module is missing.
std::unique_ptr<BagFile> OpenBagFile(const std::string& path);

}  // namespace alidade
