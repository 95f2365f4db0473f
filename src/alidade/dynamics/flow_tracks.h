// Tracks points from frame to frame by pyramidal Lucas–Kanade optical flow (Bouguet 2000), and
// keeps their positions in the last kHistory frames.
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
  int first = 0;  // number of the frame in which the track started
  // Raw pixels, one per frame since the start, limited to the last kHistory frames.
  std::deque<cv::Point2f> path;
  cv::Point2f at() const { return path.back(); }
  int length() const { return static_cast<int>(path.size()); }
  // Position `ago` frames ago; requires ago < length().
  cv::Point2f Before(int ago) const { return path[path.size() - 1 - static_cast<size_t>(ago)]; }
};

class FlowTracks {
 public:
  static constexpr int kHistory = 32;  // frames

  // Tracks every point into the next frame (CV_8U, constant size) and back, and drops those with a
  // large forward-backward error. When most tracks fail (a cut), drops all.
  void Advance(const cv::Mat& gray);
  // Starts tracks at keypoints of that frame with no track nearby.
  void Seed(std::span<const Keypoint> keypoints, cv::Size image);
  // The same at corners of the image. `left_out`: see Marks() (features/mask.h); no track starts
  // there.
  void SeedCorners(const cv::Mat& left_out, const Camera& camera);
  const std::vector<FlowTrack>& tracks() const { return tracks_; }

 private:
  std::vector<cv::Mat> pyramid_;  // of the previous frame, at half size
  std::vector<FlowTrack> tracks_;
  uint32_t next_id_ = 0;
  int frames_ = 0;
};

}  // namespace alidade
