#include "alidade/stream/settings.h"

#include <string>

#include "alidade/base/error.h"

namespace alidade {

void StreamSettings::Check() const {
  const auto check = [](bool good, const char* name, const char* range) {
    if (!good) ThrowUsage("stream." + std::string(name) + " must be " + range);
  };
  check(edge_shared >= 1, "edge_shared", "at least 1");
  check(landmark_tolerance >= 0 && landmark_tolerance < 0.1, "landmark_tolerance", "within 0…0.1");
  check(depth_points >= 0 && depth_points <= 1000000, "depth_points", "within 0…1000000");
  check(outline_tolerance >= 0 && outline_tolerance <= 100, "outline_tolerance", "within 0…100");
  check(path_frames >= 100, "path_frames", "at least 100");
  check(detection_seconds >= 0, "detection_seconds", "at least 0");
}

}  // namespace alidade
