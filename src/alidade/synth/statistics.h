// How hard a recording is, in figures: what `alidade synth` prints and tests hold the scenes to.
#pragma once

#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/synth/recording.h"

namespace alidade {

struct SynthStatistics {
  int frames = 0;
  double path_length = 0;    // metres
  double median_speed = 0;   // metres per second
  double median_turn = 0;    // degrees per second, median over frames of the angle to the next
  double plain_share = 0;    // of the image area nearly without texture, mean over frames
  double missing_depth = 0;  // share of pixels without a depth reading, mean over frames
  double actor_share = 0;    // of the image area, mean over frames
};

// Share of 16 × 16 pixel blocks in which the noise-free image has a standard deviation below 3 grey
// levels: less than its noise (4 by default), so that nothing is found there.
double PlainShare(const cv::Mat& clean);

class StatisticsCollector {
 public:
  explicit StatisticsCollector(double fps) : fps_(fps) {}
  // Frames in order; poses of all, pictures of as many as one cares to give.
  void AddPose(const Se3& T_world_camera);
  void AddFrame(const RenderedFrame& frame);
  SynthStatistics Result() const;

 private:
  double fps_;
  std::vector<Se3> poses_;
  double plain_ = 0, missing_ = 0, actors_ = 0;  // sums over the frames given
  int pictures_ = 0;
};

}  // namespace alidade
