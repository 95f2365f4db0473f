// Extraction and matching.
#include <memory>

#include "alidade/base/parallel.h"
#include "alidade/features/extractor.h"
#include "alidade/features/matching.h"
#include "bench/measure/reference.h"
#include "bench/parts/parts.h"

namespace alidade::bench {

Section BenchFeatures(const Recording& recording) {
  const Camera& camera = recording.info.camera;
  Extractor extractor;
  std::vector<Frame> frames;
  for (const SourceFrame& frame : recording.frames) {
    frames.push_back(extractor.Extract(frame.image, camera, frame.time, frame.number));
    frames.back().pyramid.clear();
  }
  const auto frame = [&](int turn) -> const Frame& {
    return frames[static_cast<size_t>(turn) % frames.size()];
  };
  const auto extract = [&](int turn) {
    const SourceFrame& from = recording.frames[static_cast<size_t>(turn) % frames.size()];
    extractor.Extract(from.image, camera, from.time, from.number);
  };
  const auto match_all = [&](int turn) { MatchBruteForce(frame(turn), frame(turn + 1)); };
  const auto match_window = [&](int turn) {
    std::vector<Eigen::Vector2f> guess;
    for (const Keypoint& k : frame(turn).keypoints) guess.push_back({k.x, k.y});
    MatchWindow(frame(turn), frame(turn + 1), guess, 0.16f * static_cast<float>(camera.width));
  };
  const std::string size = std::to_string(frames[0].keypoints.size()) + " keypoints";
  SetThreadCount(0);
  std::vector<Subject> subjects{{"extraction, 1 thread", extract, 1, size}};
  if (ThreadCount() > 1) {
    subjects.push_back(
        {"extraction, " + std::to_string(ThreadCount()) + " threads", extract, 0, size});
  }
  subjects.push_back({"matching, all against all", match_all, 1, size + " each"});
  subjects.push_back({"matching, in windows", match_window, 1, size + " each"});
  return TakeTurns("features", recording, std::move(subjects),
                   std::max<int>(40, static_cast<int>(frames.size())));
}

}  // namespace alidade::bench
