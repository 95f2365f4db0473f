// Times beside U: the median time of OpenCV's ORB on the same frames, on the same machine, in the
// same run (docs/benchmarks/index.md).
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <string>
#include <vector>

#include "bench/measure/recording.h"
#include "bench/measure/result.h"

namespace alidade::bench {

// The reference: cv::ORB, 1000 features, on one thread, on the frame scaled to 640 pixels in width.
// Milliseconds.
class Reference {
 public:
  Reference();
  double Run(const cv::Mat& image);

 private:
  cv::Ptr<cv::Feature2D> orb_;
};

// Something to time.
struct Subject {
  std::string name;
  std::function<void(int turn)> run;
  int threads = 1;  // of ParallelFor; 0 = all
  std::string note = {};
};

// Times the reference and every subject in turns, `turns` times each.
Section TakeTurns(const std::string& name, const Recording& recording,
                  std::vector<Subject> subjects, int turns);

// A time of work on frames of a recording.
Timing TimingOf(const std::string& name, const Recording& recording,
                std::vector<double> milliseconds, const std::string& note = "");

}  // namespace alidade::bench
