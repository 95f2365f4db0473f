// The semi-dense depth in the folder `alidade run --semidense` left (docs/guides/shape.md).
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/frame_source.h"

namespace alidade {

struct DepthFile {
  double time = 0;    // seconds
  std::string stamp;  // as written
  std::string path;
  int map = 0;  // 0: listed in depth.txt, 1: in depth.1.txt, ...
};

struct DepthFolder {
  std::optional<Sensor> sensor;  // of the run; nothing: stats.json does not say
  std::vector<DepthFile> files;  // of all maps, in the order of time
};

// Throws Error (input) when a line cannot be used, and when there is no list, unless stats.json
// says that --semidense was given: then no depth could be told, which is a result too.
DepthFolder ReadDepthFolder(const std::string& folder);

// CV_32F in the map's unit, 0 = none. Throws Error (input) when it cannot be read.
cv::Mat ReadKeyframeDepth(const std::string& path);

}  // namespace alidade
