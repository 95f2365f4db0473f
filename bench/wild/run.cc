#include "bench/wild/run.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "alidade/base/timing.h"
#include "alidade/evaluation/false_poses.h"
#include "alidade/io/read_ahead.h"
#include "alidade/run/calibration/unknown_camera.h"
#include "alidade/run/results/run_results.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/frame_input.h"
#include "alidade/slam.h"

namespace alidade::bench {
namespace {

// Motion that a map can be made of has begun when the camera is this share of what it sees' depth
// away from where it was first: 1.7 degrees of parallax.
constexpr double kUsableMotion = 0.03;
// Where no map can be made, one that says the camera moved by more than this share of the depth of
// what it sees is false; one that says it stood is of no use, but does no harm.
constexpr double kHarmlessMotion = 0.05;

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double MedianDepth(const cv::Mat& depth) {
  std::vector<double> values;
  for (int y = 0; y < depth.rows; y += 8) {
    for (int x = 0; x < depth.cols; x += 8) {
      if (depth.at<float>(y, x) > 0) values.push_back(depth.at<float>(y, x));
    }
  }
  return MedianOf(std::move(values));
}

// Of the landmarks keyframes of a map see, in the map's units.
double MedianDepth(const MapSnapshot& map, MapId id) {
  std::vector<double> depths;
  for (const KeyFrameId keyframe_id : map.KeyFramesOf(id)) {
    const KeyFrame* keyframe = map.Find(keyframe_id);
    for (const LandmarkId landmark_id : keyframe->landmarks) {
      const Landmark* landmark = map.Find(landmark_id);
      if (landmark) depths.push_back((keyframe->T_camera_world * landmark->p_world).z());
    }
  }
  return MedianOf(std::move(depths));
}

double Reach(const Trajectory& trajectory) {
  double reach = 0;
  for (const StampedPose& pose : trajectory)
    reach = std::max(reach, (pose.T_world_camera.t - trajectory.front().T_world_camera.t).norm());
  return reach;
}

class UsableMotion {
 public:
  void Add(const SourceFrame& frame) {
    const Eigen::Vector3d& p = frame.T_world_camera->t;
    if (!first_) first_ = p;
    if (frame_ >= 0) return;
    const double moved = (p - *first_).norm();
    if (moved > kUsableMotion * MedianDepth(frame.true_depth)) frame_ = frame.number;
  }
  int frame() const { return frame_; }  // -1: it has not begun

 private:
  std::optional<Eigen::Vector3d> first_;
  int frame_ = -1;
};

void Judge(const WildCase& of, const RunLog& log, const RunResults& results, WildRun& run) {
  for (size_t i = 0; i < results.maps.size(); ++i) {
    const MapResults& map = results.maps[i];
    if (map.trajectory.empty()) continue;
    ++run.maps;
    if (!of.map) {
      const double depth = MedianDepth(results.map, map.id);
      if (Reach(map.trajectory) <= kHarmlessMotion * depth) continue;
      ++run.false_maps;
      run.false_poses += static_cast<int>(map.trajectory.size());
      continue;
    }
    const FalsePoses found = FindFalsePoses(log.truth, map.trajectory, Alignment::kSim3);
    run.false_poses += static_cast<int>(found.wrong.size());
    if (i > 0 || found.pairs.size() < 3) continue;
    run.ate_cm = 100 * found.metres.rmse;
    if (found.path > 0) run.ate_percent = run.ate_cm / found.path;
    run.scale_drift = found.scale_drift;
  }
}

}  // namespace

WildRun RunWild(const WildCase& of, uint64_t seed, int frames, SlamSettings settings,
                const std::function<void(int)>& progress) {
  SourceOptions options;
  options.sensor = settings.sensor = Sensor::kMono;
  options.last = frames - 1;  // -1: to the end
  const std::string source_name = of.source + "&seed=" + std::to_string(seed);
  ReadAhead source(OpenAnySource(source_name, options));
  RunLog log;
  SourceInfo info = source.Info();
  if (info.camera_guessed) {  // as `alidade run` does
    settings.WaryOfTurns();
    const CameraFound found = FindCamera([&] { return OpenAnySource(source_name, options); },
                                         settings, {}, [](const auto&) { return true; });
    if (found.usable) {
      info.camera = found.estimate.camera;
      settings.start.two_view.lens_uncertainty = 3 * found.estimate.focal_sigma;
    }
  }
  Slam slam(info.camera, settings);
  WildRun run;
  run.seed = seed;
  UsableMotion usable;
  std::map<std::string, int> reasons;
  Stopwatch clock;
  double milliseconds = 0;
  while (const auto frame = source.Next()) {
    usable.Add(*frame);
    log.truth.push_back({frame->time, *frame->T_world_camera, frame->stamp});
    log.stamps.Add({frame->stamp, frame->number});
    clock = Stopwatch();
    const TrackResult result = slam.Track(InputOf(*frame));
    milliseconds += clock.Milliseconds();
    if (result.state != TrackState::kTracking) ++reasons[result.reason()];
    progress(++log.frames);
  }
  slam.Finish();
  const RunResults results = ResultsOf(slam, log, info.R_camera_rectified);
  run.frames = log.frames;
  run.usable = usable.frame();
  run.start = results.initialized_at.value_or(-1);
  run.tracked = results.tracked;
  run.milliseconds = milliseconds / std::max(1, run.frames);
  if (run.usable >= 0) {
    const int from = run.usable + static_cast<int>(std::ceil(info.camera.fps));
    int tracked = 0;
    for (const FramePose& pose : results.frames) tracked += pose.tracked && pose.index >= from;
    if (from < run.frames) run.coverage = static_cast<double>(tracked) / (run.frames - from);
  }
  const auto most =
      std::max_element(reasons.begin(), reasons.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most != reasons.end()) run.reason = most->first;
  Judge(of, log, results, run);
  return run;
}

}  // namespace alidade::bench
