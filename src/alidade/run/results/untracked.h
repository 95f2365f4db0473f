// Why frames have no pose, and what helps: in words for people.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/run/results/image_condition.h"

namespace alidade {

// Frames on end without a pose that have the same reason and look alike.
struct UntrackedFrames {
  double from = 0, to = 0;  // times of the first and the last, seconds
  std::string reason;       // TrackResult::reason
  Look look = Look::kOrdinary;
  int frames = 0;
};

// As a run goes on. Grows with the changes there are, not with the frames.
class UntrackedLog {
 public:
  void set_look(const LookSettings& settings) { look_ = settings; }

  // A keyframe: says how sharp pictures are when all is well.
  void AddKeyFrame(const cv::Mat& gray);
  // A frame without a pose. `corners`: found, as a share of those wanted.
  void Add(double time, const std::string& reason, const cv::Mat& gray, double corners);
  void Tracked() { going_on_ = false; }  // a frame with one

  const std::vector<UntrackedFrames>& all() const { return all_; }

 private:
  std::vector<UntrackedFrames> all_;
  bool going_on_ = false;
  double blur_ = 0;  // sum over keyframes
  int sharp_ = 0;    // how many
  LookSettings look_;
};

// "3.10 s to 4.20 s: the picture was blurred. More light, or moving more slowly, helps." Times are
// told since `start`. Empty spans: empty.
std::vector<std::string> LostInWords(const std::vector<std::array<double, 2>>& spans,
                                     const std::vector<UntrackedFrames>& untracked, double start);

// Why the first `until` seconds since `start` have no poses; empty: not known.
std::string StartInWords(const std::vector<UntrackedFrames>& untracked, double start, double until);

// What helps against one of TrackResult's reasons, as a sentence; empty: nothing is known.
std::string AdviceOn(const std::string& reason);

}  // namespace alidade
