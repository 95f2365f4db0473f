// Explains to users why frames have no pose, and what helps.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/run/results/image_condition.h"

namespace alidade {

// Consecutive frames without a pose that have the same reason and image condition.
struct UntrackedFrames {
  double from = 0, to = 0;  // times of the first and the last, seconds
  std::string reason;       // TrackResult::reason
  Look look = Look::kOrdinary;
  int frames = 0;
};

// Collects them during a run. Memory grows with the number of changes, not of frames.
class UntrackedLog {
 public:
  void set_look(const LookSettings& settings) { look_ = settings; }

  // A keyframe: its sharpness is the reference for blur.
  void AddKeyFrame(const cv::Mat& gray);
  // A frame without a pose. `corners`: number found, as a share of those wanted.
  void Add(double time, const std::string& reason, const cv::Mat& gray, double corners);
  void Tracked() { going_on_ = false; }  // a frame with a pose

  const std::vector<UntrackedFrames>& all() const { return all_; }

 private:
  std::vector<UntrackedFrames> all_;
  bool going_on_ = false;
  double blur_ = 0;  // sum over keyframes
  int sharp_ = 0;    // number of keyframes
  LookSettings look_;
};

// "3.10 s to 4.20 s: the image was blurred. Move more slowly, or use more light." Times are
// relative to `start`. One line per span.
std::vector<std::string> LostInWords(const std::vector<std::array<double, 2>>& spans,
                                     const std::vector<UntrackedFrames>& untracked, double start);

// Why the first `until` seconds after `start` have no poses; empty: unknown.
std::string StartInWords(const std::vector<UntrackedFrames>& untracked, double start, double until);

// Advice for one of the reasons of TrackResult, as a sentence; empty: none.
std::string AdviceOn(const std::string& reason);

}  // namespace alidade
