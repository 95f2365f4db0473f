#include "bench/measure/reference.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"

namespace alidade::bench {

Reference::Reference() : orb_(cv::ORB::create(1000)) {}

double Reference::Run(const cv::Mat& image) {
  constexpr int kWidth = 640;
  cv::Mat scaled = image;
  if (image.cols != kWidth) {
    cv::resize(image, scaled, {kWidth, image.rows * kWidth / image.cols}, 0, 0, cv::INTER_AREA);
  }
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::setNumThreads(1);
  const Stopwatch watch;
  orb_->detectAndCompute(scaled, cv::noArray(), keypoints, descriptors);
  return watch.Milliseconds();
}

Timing TimingOf(const std::string& name, const Recording& recording,
                std::vector<double> milliseconds, const std::string& note) {
  Case of{name};
  of.source = recording.source;
  of.frames = static_cast<int>(recording.frames.size());
  return {std::move(of), std::move(milliseconds), note};
}

Section TakeTurns(const std::string& name, const Recording& recording,
                  std::vector<Subject> subjects, int turns) {
  Section section{name};
  for (const Subject& subject : subjects)
    section.timings.push_back(TimingOf(subject.name, recording, {}, subject.note));
  Reference reference;
  for (int turn = -1; turn < turns; ++turn) {  // the first to warm up
    const int now = std::max(turn, 0);
    const double u =
        reference.Run(recording.frames[static_cast<size_t>(now) % recording.frames.size()].image);
    if (turn >= 0) section.u_milliseconds.push_back(u);
    for (size_t i = 0; i < subjects.size(); ++i) {
      SetThreadCount(subjects[i].threads);
      ParallelFor(16, [](int) {});  // starts the threads, and wakes them
      const Stopwatch watch;
      subjects[i].run(now);
      if (turn >= 0) section.timings[i].milliseconds.push_back(watch.Milliseconds());
    }
  }
  SetThreadCount(0);
  return section;
}

}  // namespace alidade::bench
