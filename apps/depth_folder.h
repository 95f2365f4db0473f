// Reads the semi-dense depth in a result folder of `alidade run --semidense`
// (docs/guides/shape.md).
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
  std::optional<Sensor> sensor;  // of the run; nullopt: unknown
  std::vector<DepthFile> files;  // of all maps, by time
};

// Throws Error (input) for an invalid line, and if there is no list, unless stats.json says that
// --semidense was given: then the result has no depth.
DepthFolder ReadDepthFolder(const std::string& folder);

// CV_32F in map units, 0 = none. Throws Error (input) if it cannot be read.
cv::Mat ReadKeyframeDepth(const std::string& path);

}  // namespace alidade
