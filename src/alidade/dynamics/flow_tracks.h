// Points followed from frame to frame by pyramidal Lucas–Kanade flow (Bouguet 2000), with where
// they were in the last second.
#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/features/frame.h"

namespace alidade {

struct FlowTrack {
  uint32_t id = 0;
  int first = 0;  // number of the frame it was first seen in
  std::deque<cv::Point2f>
      path;  // raw pixels, one for each frame since (or since the history's begin)
  cv::Point2f at() const { return path.back(); }
  int length() const { return static_cast<int>(path.size()); }
  // Where it was `ago` frames ago; needs ago < length().
  cv::Point2f Before(int ago) const { return path[path.size() - 1 - static_cast<size_t>(ago)]; }
};

class FlowTracks {
 public:
  static constexpr int kHistory = 32;  // frames

  // The next frame (CV_8U, always of one size): every track is followed into it both ways; those
  // that do not come back where they were are dropped. A frame that has no match for most of them
  // (a cut) leaves none.
  void Advance(const cv::Mat& gray);
  // Begins tracks at keypoints of that frame where there are none nearby.
  void Seed(std::span<const Keypoint> keypoints, cv::Size image);
  const std::vector<FlowTrack>& tracks() const { return tracks_; }

 private:
  std::vector<cv::Mat> pyramid_;  // of the last frame, at half size
  std::vector<FlowTrack> tracks_;
  uint32_t next_id_ = 0;
  int frames_ = 0;
};

}  // namespace alidade
