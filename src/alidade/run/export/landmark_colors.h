// Colors of landmarks, from the images of the keyframes that observe them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <set>

#include "alidade/run/sources/saved_map.h"

namespace alidade {

class LandmarkColors {
 public:
  // `recorded`: size of the recording's images, which may be larger than those of the map.
  LandmarkColors(const SavedMap& saved, const MapPart& part, cv::Size recorded);

  // `image`: that of the keyframe as recorded, gray or blue green red.
  void Add(const cv::Mat& image, const KeyFrame& keyframe);
  // Red green blue: mean over all observations; nullopt: no image that observes it was added.
  std::optional<std::array<uint8_t, 3>> Of(LandmarkId id) const;

 private:
  struct Sum {
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
    int count = 0;
  };
  double scale_x_, scale_y_;  // recorded pixels per pixel of the map
  std::set<LandmarkId> used_;
  std::map<LandmarkId, Sum> sums_;
};

}  // namespace alidade
