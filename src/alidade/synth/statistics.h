// Difficulty measures of a recording; printed by `alidade synth` and used by tests.
#pragma once

#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/synth/recording.h"

namespace alidade {

struct SynthStatistics {
  int frames = 0;
  double path_length = 0;   // meters
  double median_speed = 0;  // meters per second
  // Degrees per second, median over frames of the rotation to the next frame.
  double median_turn = 0;
  double plain_share = 0;    // share of the image area almost without texture, mean over frames
  double missing_depth = 0;  // share of pixels without a depth reading, mean over frames
  double actor_share = 0;    // of the image area, mean over frames
};

// Share of 16 × 16 pixel blocks whose noise-free image has a standard deviation below 3 gray
// levels: below the noise (4 by default), so no features are found there.
double PlainShare(const cv::Mat& clean);

class StatisticsCollector {
 public:
  explicit StatisticsCollector(double fps) : fps_(fps) {}
  // Add the poses of all frames in order, and any number of the images.
  void AddPose(const Se3& T_world_camera);
  void AddFrame(const RenderedFrame& frame);
  SynthStatistics Result() const;

 private:
  double fps_;
  std::vector<Se3> poses_;
  double plain_ = 0, missing_ = 0, actors_ = 0;  // sums over the images added
  int pictures_ = 0;
};

}  // namespace alidade
