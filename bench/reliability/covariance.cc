#include "bench/reliability/covariance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "alidade/evaluation/motion_error.h"
#include "alidade/geometry/alignment.h"
#include "alidade/slam.h"
#include "alidade/synth/recording.h"

namespace alidade::bench {
namespace {

constexpr std::array<const char*, 5> kRooms = {"room", "desk", "corridor", "street", "table"};
constexpr int kPlayed = 150;
// Consecutive frames share landmarks and their errors: these are a third of a second apart.
constexpr int kGap = 10;
constexpr int kYoung = 60;  // frames

struct Spread {
  std::vector<double> chi2;  // of 6 parameters

  double Rms() const {
    double sum = 0;
    for (const double value : chi2) sum += value;
    return std::sqrt(sum / (6.0 * static_cast<double>(chi2.size())));
  }
  // 1 for chi² with 6 degrees of freedom, whose median is 5.348.
  double OfMedian() const {
    if (chi2.empty()) return NAN;
    std::vector<double> sorted = chi2;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                     sorted.end());
    return std::sqrt(sorted[sorted.size() / 2] / 5.348);
  }
};

void Run(const SynthSettings& scene, Sensor sensor, std::array<Spread, 2>& spreads) {
  const SynthRecording recording(scene);
  SlamSettings settings;
  settings.sensor = sensor;
  Slam slam(recording.camera(), settings);
  std::vector<TrackResult> results;
  std::vector<Se3> truth;
  for (int i = 0; i < scene.frames; ++i) {
    const RenderedFrame frame = recording.Render(i);
    const cv::Mat depth = sensor == Sensor::kRgbd ? frame.depth : cv::Mat();
    const cv::Mat right = sensor == Sensor::kStereo ? frame.right : cv::Mat();
    results.push_back(slam.Track({frame.time, frame.image, right, depth}));
    truth.push_back(recording.Pose(i));
  }
  double scale = 1;
  if (sensor == Sensor::kMono) {
    std::vector<Eigen::Vector3d> at, true_at;
    for (const FramePose& pose : slam.Trajectory()) {
      if (!pose.tracked) continue;
      at.push_back(pose.T_world_camera.t);
      true_at.push_back(truth[static_cast<size_t>(pose.index)].t);
    }
    if (at.size() < 40) return;
    scale = AlignPoints(true_at, at, true).s;
  }
  int first = -1;
  for (int i = 0; i < scene.frames; ++i) {
    const auto n = static_cast<size_t>(i);
    if (results[n].state != TrackState::kTracking) {
      first = -1;
      continue;
    }
    if (first < 0) first = i;
    if (i - first < kGap) continue;
    const TrackResult &before = results[n - kGap], &now = results[n];
    if (before.quality.covariance.isZero() || now.quality.covariance.isZero()) continue;
    Se3 real = truth[n - kGap].Inverse() * truth[n];
    real.t /= scale;
    spreads[i - first - kGap < kYoung ? 0 : 1].chi2.push_back(
        MotionChiSquared({before.T_world_camera, before.quality.covariance},
                         {now.T_world_camera, now.quality.covariance}, real));
  }
}

}  // namespace

Table CovarianceTable(int seeds, int first_seed) {
  Table table;
  table.name = "error / standard deviation of the motion in a third of a second";
  table.columns = {{"normalized_rms"}, {"normalized_median"}, {"pairs"}};
  for (const Sensor sensor : {Sensor::kMono, Sensor::kStereo, Sensor::kRgbd}) {
    std::array<Spread, 2> spreads;
    for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
      for (const char* name : kRooms) {
        SynthSettings scene;
        scene.scene = name;
        scene.frames = kPlayed;
        scene.seed = static_cast<uint64_t>(seed);
        scene.stereo = sensor == Sensor::kStereo;
        Run(scene, sensor, spreads);
        std::fprintf(stderr, "covariance, %s, seed %d: %s\n", NameOf(sensor), seed, name);
      }
    }
    for (const size_t k : {size_t{0}, size_t{1}}) {
      Case of{k == 0 ? "first two seconds" : "later"};
      of.sensor = NameOf(sensor);
      table.lines.push_back(
          {of,
           {spreads[k].Rms(), spreads[k].OfMedian(), static_cast<double>(spreads[k].chi2.size())}});
    }
  }
  return table;
}

}  // namespace alidade::bench
