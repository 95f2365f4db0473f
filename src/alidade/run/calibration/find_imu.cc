#include "alidade/run/calibration/find_imu.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "alidade/base/degrees.h"
#include "alidade/base/error.h"
#include "alidade/base/median.h"
#include "alidade/base/print.h"
#include "alidade/inertial/imu_stream.h"
#include "alidade/io/read_ahead.h"
#include "alidade/map/view.h"
#include "alidade/run/sources/frame_input.h"
#include "alidade/system/slam.h"

namespace alidade {
namespace {

// A quantity is observable if its standard deviation is below this share of what was assumed.
constexpr double kOfPrior = 0.5;
constexpr double kMostTurn = 0.03;    // radians
constexpr double kWindowSeconds = 8;  // several windows tell the scatter

template <typename... Values>
std::string FoundLine(const char* format, Values... values) {
  char text[240];
  PrintTo(text, sizeof(text), format, values...);
  return text;
}

// The path in the map with the most frames.
Trajectory LongestPath(const std::vector<FramePose>& frames) {
  std::map<MapId, Trajectory> paths;
  for (const FramePose& frame : frames) {
    if (frame.tracked) paths[frame.map].push_back({frame.time, frame.T_world_camera, {}});
  }
  Trajectory longest;
  for (auto& [map, path] : paths) {
    if (path.size() > longest.size()) longest = std::move(path);
  }
  return longest;
}

double SeenDistance(const MapSnapshot& map) {
  std::vector<double> depths;
  for (KeyFrameId id : map.KeyFrames()) {
    const auto depth = MedianDepth(map, *map.Find(id));
    if (depth && *depth > 0) depths.push_back(*depth);
  }
  return depths.empty() ? 1 : UpperMedian(depths);
}

std::string Triple(const Eigen::Vector3d& value, const Eigen::Vector3d& sigma, const char* unit) {
  if (sigma.isZero(0))
    return FoundLine("%.4f %.4f %.4f %s (the recording is too short for standard deviations)",
                     value.x(), value.y(), value.z(), unit);
  return FoundLine("%.4f %.4f %.4f ± %.4f %.4f %.4f %s", value.x(), value.y(), value.z(), sigma.x(),
                   sigma.y(), sigma.z(), unit);
}

}  // namespace

InertialFinding FindImu(std::unique_ptr<FrameSource> source, const Camera& camera,
                        SlamSettings settings, const std::function<bool(int)>& go_on) {
  ImuModel model;  // what the recording says is ignored, but for its noise
  if (source->Info().imu) {
    model.rate = source->Info().imu->rate;
    model.noise = source->Info().imu->noise;
  }
  settings.threaded = false;
  settings.semidense.enabled = false;
  Slam slam(camera, settings);
  ReadAhead frames(std::move(source));
  ImuStream stream;
  std::vector<ImuSample> samples;
  int count = 0, part = 0;
  while (const std::optional<SourceFrame> frame = frames.Next()) {
    if (frame->part != std::exchange(part, frame->part)) break;  // one clock
    for (const ImuSample& sample : stream.Add(frame->imu)) {
      if (samples.empty() || sample.time > samples.back().time) samples.push_back(sample);
    }
    if (!frame->problem.empty()) continue;
    try {
      FrameInput input = InputOf(*frame);
      input.imu.clear();
      slam.Track(input);
    } catch (const Error&) {  // an unusable frame: the run itself reports it
    }
    if (!go_on(++count)) break;
  }
  const Trajectory path = LongestPath(slam.Finish());
  InertialFinding finding;
  if (!stream.broken().empty() || path.size() < 2) {
    finding.model = model;
    finding.why_not = path.size() < 2 ? "nothing could be mapped" : stream.broken();
    return finding;
  }
  if (!(model.rate > 0)) model.rate = std::round(stream.rate());
  WindowSettings windows;
  windows.distance = SeenDistance(slam.Snapshot());
  windows.seconds = kWindowSeconds;
  return FindInertial(path, samples, model, windows);
}

ImuModel ObservableOf(const InertialFinding& finding) {
  const InertialPriors priors;
  ImuModel model = finding.model;
  const bool any = finding.solved > 0;
  model.rotation_known = any && finding.rotation_sigma < kMostTurn;
  model.time_offset_known = any && finding.time_offset_sigma < kOfPrior * priors.time_offset;
  model.translation_known = model.rotation_known && finding.why_not.empty() &&
                            finding.translation_sigma < kOfPrior * priors.translation;
  if (!model.translation_known) model.T_camera_imu.t.setZero();
  return model;
}

std::vector<std::string> ImuInWords(const InertialFinding& finding) {
  const ImuModel known = ObservableOf(finding);
  std::vector<std::string> lines;
  if (finding.solved == 0) return {"inertial sensor: unknown: " + finding.why_not};
  const Eigen::AngleAxisd turn(known.T_camera_imu.R);
  const Eigen::Vector3d degrees = kDegrees * turn.angle() * turn.axis();
  lines.push_back(
      known.rotation_known
          ? FoundLine("rotation     %.2f %.2f %.2f ± %.2f degrees (rotation vector of "
                      "T_camera_imu)",
                      degrees.x(), degrees.y(), degrees.z(), kDegrees * finding.rotation_sigma)
          : std::string("rotation     not observable: turn the camera about several axes"));
  lines.push_back(known.time_offset_known
                      ? FoundLine("time offset  %.1f ± %.1f ms", 1e3 * known.time_offset,
                                  1e3 * finding.time_offset_sigma)
                      : std::string("time offset  not observable: turn the camera back and forth"));
  const Eigen::Vector3d centimeters = 100 * known.T_camera_imu.t;
  lines.push_back(known.translation_known
                      ? FoundLine("lever arm    %.1f %.1f %.1f ± %.1f cm (of T_camera_imu)",
                                  centimeters.x(), centimeters.y(), centimeters.z(),
                                  100 * finding.translation_sigma)
                      : FoundLine("lever arm    not observable (± %.1f cm): taken as 0",
                                  100 * finding.translation_sigma));
  lines.push_back("gyro bias    " +
                  Triple(finding.bias.gyro, finding.bias_sigma.head<3>(), "rad/s"));
  if (finding.why_not.empty()) {
    lines.push_back("accel bias   " +
                    Triple(finding.bias.accel, finding.bias_sigma.tail<3>(), "m/s²"));
  } else {
    lines.push_back("accel bias   not observable: " + finding.why_not);
  }
  lines.push_back(FoundLine("noise        %.1f times what is assumed, in %d of %d windows",
                            finding.noise_factor, finding.solved, finding.windows));
  return lines;
}

}  // namespace alidade
