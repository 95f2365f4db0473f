#include "bench/reliability/reliability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "alidade/slam.h"
#include "alidade/synth/recording.h"
#include "bench/reliability/covariance.h"

namespace alidade::bench {
namespace {

constexpr const char* kScenes[] = {"room", "desk", "hall",  "corridor", "street",
                                   "road", "loop", "table", "wall"};
constexpr int kPlaces = 3;  // of a recording
// Bins by probability; the usual pose is in the last one.
constexpr std::array<double, 10> kBins = {0.05, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.99, 0.999, 1};

struct Bin {
  int frames = 0, right = 0;
  double sum = 0;
};

struct Piece {
  int place, first, frames;
};
constexpr Piece kPieces[] = {{0, 0, 75}, {1, 0, 75}, {0, 70, 80}, {2, 20, 75}, {1, 70, 80}};

struct Shown {
  int place;
  Se3 T_world_camera;
};

SynthRecording Place(int recording, int place, int seed, int width) {
  SynthSettings settings;
  settings.scene = kScenes[(recording + place * (2 + seed % 3)) % std::size(kScenes)];
  settings.frames = 150;
  settings.seed = static_cast<uint64_t>(seed);
  settings.width = width;
  settings.height = width * 3 / 4;
  // Six conditions in turns.
  switch ((recording + seed) % 6) {
    case 1:
      settings.blur = SynthSettings::kUsualBlur;
      break;
    case 2:
      settings.light = 0.2;
      break;
    case 3:
      settings.actors = 3;
      break;
    case 4:
      settings.speed = 2;
      break;
    case 5:
      settings.noise = 10;
      break;
    default:
      break;
  }
  return SynthRecording(settings);
}

bool IsRight(const Shown& frame, const Shown& reference, const Se3& T_reference_camera,
             bool depth) {
  if (frame.place != reference.place) return false;
  const Se3 error =
      (reference.T_world_camera.Inverse() * frame.T_world_camera).Inverse() * T_reference_camera;
  return error.Log().tail<3>().norm() < 0.05 && (!depth || error.t.norm() < 0.1);
}

void Run(int recording, int seed, int width, Sensor sensor, std::array<Bin, kBins.size()>& bins) {
  std::vector<SynthRecording> places;
  for (int i = 0; i < kPlaces; ++i) places.push_back(Place(recording, i, seed, width));
  SlamSettings settings;
  settings.sensor = sensor;
  settings.tracker.evidence.min_probability = 0.02;
  Slam slam(places[0].camera(), settings);
  std::vector<Shown> shown;
  std::vector<double> probabilities;
  for (const Piece& piece : kPieces) {
    for (int i = 0; i < piece.frames; ++i) {
      const RenderedFrame frame = places[piece.place].Render(piece.first + i);
      const cv::Mat depth = sensor == Sensor::kRgbd ? frame.depth : cv::Mat();
      const double time = static_cast<double>(shown.size()) / 30;
      const TrackResult result = slam.Track({time, frame.image, {}, depth});
      shown.push_back({piece.place, places[piece.place].Pose(piece.first + i)});
      probabilities.push_back(result.state == TrackState::kTracking && !result.keyframe
                                  ? result.quality.probability
                                  : -1);
    }
  }
  const MapSnapshot map = slam.Snapshot();
  for (const FramePose& pose : slam.Trajectory()) {
    const double p = probabilities[static_cast<size_t>(pose.index)];
    const KeyFrame* reference = pose.tracked && p >= 0 ? map.Find(pose.reference) : nullptr;
    if (!reference) continue;
    const Shown& frame = shown[static_cast<size_t>(pose.index)];
    const Shown& at = shown[static_cast<size_t>(reference->frame->number)];
    Bin& bin =
        bins[static_cast<size_t>(std::lower_bound(kBins.begin(), kBins.end(), p) - kBins.begin())];
    ++bin.frames;
    bin.sum += p;
    bin.right += IsRight(frame, at, pose.T_reference_camera, sensor == Sensor::kRgbd);
  }
}

}  // namespace

Section BenchReliability(int seeds, int first_seed) {
  Section section;
  section.name = "reliability";
  section.tables.push_back(CovarianceTable(seeds, first_seed));
  for (const Sensor sensor : {Sensor::kMono, Sensor::kRgbd}) {
    std::array<Bin, kBins.size()> bins;
    for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
      for (int recording = 0; recording < static_cast<int>(std::size(kScenes)); ++recording) {
        for (const int width : {320, 640}) Run(recording, seed, width, sensor, bins);
        std::fprintf(stderr, "%s, seed %d: %d of %zu recordings\n", NameOf(sensor), seed,
                     recording + 1, std::size(kScenes));
      }
    }
    Table table;
    table.name = std::string("probability of a pose, and share of right ones: ") + NameOf(sensor);
    table.columns = {{"predicted"}, {"right"}, {"poses"}};
    double least = 0;
    for (size_t i = 0; i < bins.size(); ++i) {
      char name[40];
      std::snprintf(name, sizeof name, "%g to %g", least, kBins[i]);
      least = kBins[i];
      Case of{name};
      of.sensor = NameOf(sensor);
      of.frames = bins[i].frames;
      const double count = bins[i].frames;
      table.lines.push_back({of, {bins[i].sum / count, bins[i].right / count, count}});
    }
    section.tables.push_back(std::move(table));
  }
  return section;
}

}  // namespace alidade::bench
