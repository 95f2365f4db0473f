#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"
#include "alidade/run/synth_source.h"
#include "bench/bench.h"

namespace alidade::bench {

Recording LoadRecording(const std::string& source, int count) {
  SourceOptions options;
  options.last = count - 1;
  const auto opened =
      IsSynthSource(source) ? OpenSynthSource(source, options) : OpenSource(source, options);
  Recording recording{source, opened->Info(), {}};
  while (auto frame = opened->Next()) {
    if (frame->problem.empty()) recording.frames.push_back(std::move(*frame));
  }
  if (recording.frames.size() < 2)
    ThrowInput("bench: " + source + " has fewer than 2 frames that can be read");
  return recording;
}

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

Section TakeTurns(const std::string& name, const Recording& recording,
                  std::vector<Subject> subjects, int turns) {
  Section section;
  section.name = name;
  for (const Subject& subject : subjects) section.rows.push_back({subject.name, {}, subject.note});
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
      if (turn >= 0) section.rows[i].milliseconds.push_back(watch.Milliseconds());
    }
  }
  SetThreadCount(0);
  return section;
}

}  // namespace alidade::bench
