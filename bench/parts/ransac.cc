// Two views: homography and fundamental matrix in RANSAC, 200 samples of 8 matches each, serial and
// parallel.
#include "alidade/base/error.h"
#include "alidade/base/median.h"
#include "alidade/base/parallel.h"
#include "alidade/features/extractor.h"
#include "alidade/features/matching.h"
#include "alidade/geometry/two_view.h"
#include "alidade/geometry/two_view_ransac.h"
#include "bench/measure/reference.h"
#include "bench/parts/parts.h"

namespace alidade::bench {
namespace {

struct Pair {
  std::vector<Eigen::Vector2d> a, b;                  // pixels
  std::vector<Eigen::Vector2d> centred_a, centred_b;  // as FitTwoViewModels wants them
};

// Frames some way apart, with what brute force matches between them: outliers included.
std::vector<Pair> MakePairs(const Recording& recording) {
  constexpr size_t kGap = 8;  // frames: enough to move, little enough to match
  constexpr size_t kMost = 40;
  const Camera& camera = recording.info.camera;
  const size_t gap = std::min(kGap, recording.frames.size() - 1);
  Extractor extractor;
  std::vector<Frame> frames;
  for (size_t i = 0; i < std::min(kMost + gap, recording.frames.size()); ++i) {
    const SourceFrame& from = recording.frames[i];
    frames.push_back(extractor.Extract(from.image, camera, from.time, from.number));
    frames.back().pyramid.clear();
  }
  const Eigen::Vector2d centre(camera.width / 2.0, camera.height / 2.0);
  std::vector<Pair> pairs;
  for (size_t i = 0; i + gap < frames.size(); ++i) {
    Pair pair;
    for (const IndexMatch& match : MatchBruteForce(frames[i], frames[i + gap], {.ratio = 0.9})) {
      pair.a.push_back(frames[i].keypoints[match.a].pixel());
      pair.b.push_back(frames[i + gap].keypoints[match.b].pixel());
      pair.centred_a.push_back(pair.a.back() - centre);
      pair.centred_b.push_back(pair.b.back() - centre);
    }
    if (pair.a.size() >= 50) pairs.push_back(std::move(pair));
  }
  if (pairs.empty())
    ThrowInput("ransac: no two frames of " + recording.source + " have 50 matches");
  return pairs;
}

}  // namespace

Section BenchRansac(const Recording& recording) {
  const std::vector<Pair> pairs = MakePairs(recording);
  const auto pair = [&](int turn) -> const Pair& {
    return pairs[static_cast<size_t>(turn) % pairs.size()];
  };
  std::vector<double> sizes;
  for (const Pair& p : pairs) sizes.push_back(static_cast<double>(p.a.size()));
  const std::string size = std::to_string(static_cast<int>(UpperMedian(sizes))) + " matches";

  SetThreadCount(0);
  const std::string all = std::to_string(ThreadCount()) + " threads";
  std::vector<Subject> subjects;
  for (const bool parallel : {false, true}) {
    if (parallel && ThreadCount() == 1) continue;
    const std::string how = parallel ? ", parallel, " + all : ", serial";
    subjects.push_back({"RANSAC of H and F" + how,
                        [&pair, parallel](int turn) {
                          const Pair& p = pair(turn);
                          FitTwoViewModels(p.centred_a, p.centred_b, 200, 1, parallel);
                        },
                        parallel ? 0 : 1, size});
    subjects.push_back({"two-view reconstruction" + how,
                        [&pair, &recording, parallel](int turn) {
                          TwoViewSettings settings;
                          settings.parallel = parallel;
                          ReconstructTwoViews(recording.info.camera, pair(turn).a, pair(turn).b,
                                              settings);
                        },
                        parallel ? 0 : 1, size});
  }
  return TakeTurns("ransac", recording, std::move(subjects), 100);
}

}  // namespace alidade::bench
