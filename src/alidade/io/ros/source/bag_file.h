// ROS recordings by the module that reads their containers (io/ros/containers), loaded when the
// first is met.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

// What the user typed, taken apart: "walk.bag?image=/cam0/image_raw&depth=".
struct BagQuery {
  std::string path;
  // Topics asked for; an empty one: none of that kind. Nothing: to be found.
  std::optional<std::string> image, right, depth, info, right_info;
  std::optional<double> max_dt;  // seconds between what belongs together
};

// Files of a ROS recording by their names' endings (.bag, .bag.active, .mcap, .db3, those of the
// latter with .zstd) or by how they begin; folders with such files in them.
bool IsBagRecording(const std::string& path);
// The same with `?name=value&…` behind it. A file whose own name has a `?` is taken as it is.
bool IsBagSource(const std::string& source);
BagQuery ParseBagQuery(const std::string& source);  // throws Error (usage)

// The files of a recording in order: `path` itself, or those in the folder (name_2 before name_10).
std::vector<std::string> FilesOfBag(const std::string& path);

// Throws Error (input) when it cannot be read, or the module is missing.
std::unique_ptr<BagFile> OpenBagFile(const std::string& path);

}  // namespace alidade
