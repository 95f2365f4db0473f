#include "alidade/system/inertial/inertial_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/base/print.h"
#include "alidade/map/view.h"

namespace alidade {
namespace {

constexpr double kSpacing = 0.09;      // seconds between poses that are fitted
constexpr size_t kMostPoses = 240;     // about 24 s
constexpr size_t kFewest = 8;          // poses
constexpr double kFirstSeconds = 1.5;  // span of the poses of the first fit
constexpr double kAskEvery = 0.5;      // seconds
constexpr double kMargin = 0.3;        // seconds of readings kept beside the poses
// In standard deviations of the scale: a map is scaled again when it is off by more than the first,
// and one that must not be scaled is in meters when it is off by less than the second.
constexpr double kRescale = 0.3, kMetric = 3;
// Relative standard deviation of the lengths that a depth camera or a stereo pair tells: errors of
// its calibration.
constexpr double kDepthScale = 0.01;
// Readings are left out when rotations contradict each other in this many fits in a row.
constexpr int kContradictions = 3;
// Readings are used once rotations have agreed in this many fits: until then nothing tells that
// they are of this camera.
constexpr int kAgreements = 2;
// The rotation of the sensor is known well enough to predict frames.
constexpr double kRotationSigma = 0.03;  // radians
constexpr size_t kPast = 60;   // poses, at least 5 s: a map is split where it began 1.5 s before
constexpr double kNewest = 1;  // seconds of poses whose rotations tell whether the sensor works
// Readings without a pose are kept this long, seconds.
constexpr double kLongestGap = 30;

// `meters`: of a unit of the map, by the readings.
std::string AnotherUnit(double meters, Sensor sensor) {
  if (sensor == Sensor::kMono) return "the map is in another unit, and it is not changed";
  char text[120];
  PrintTo(text, sizeof(text), "by the inertial readings lengths are %.1f %% %s than by the %s",
          100 * std::abs(meters - 1), meters > 1 ? "longer" : "shorter",
          sensor == Sensor::kStereo ? "stereo pair" : "depth camera");
  return text;
}

}  // namespace

InertialAnswer AnswerOf(const InertialQuestion& question) {
  InertialAnswer answer;
  answer.map = question.map;
  answer.reference = question.reference;
  answer.T_reference_world = question.T_reference_world;
  answer.scale = question.scale;
  const InertialFit* start = question.start ? &*question.start : nullptr;
  ImuModel found = question.model;
  if (start) {
    found.T_camera_imu.R = start->model.T_camera_imu.R;
    found.time_offset = start->model.time_offset;
    found.rotation_known = found.time_offset_known = true;
  }
  answer.rotation = MatchRotations(question.poses, question.samples, found);
  if (question.accepted && !question.poses.empty()) {
    const std::span<const TimedPose> poses(question.poses);
    size_t first = poses.size() - 1;
    while (first > 0 && poses[first - 1].time > poses.back().time - kNewest) --first;
    const auto& [model, bias] = *question.accepted;
    answer.newest = CompareRotations(poses.subspan(first), question.samples, model, bias.gyro);
  }
  answer.fit =
      FitInertial(question.poses, question.samples, question.model, question.priors, start);
  if (!answer.fit.solved && start)
    answer.fit = FitInertial(question.poses, question.samples, question.model, question.priors);
  return answer;
}

void InertialWatch::SetImu(const ImuModel& model) {
  report_.given = true;
  report_.model = model;
  calibration_ = {model, {}};
  learned_.reset();
  ForgetMap();
}

void InertialWatch::Take(std::span<const ImuSample> samples) {
  if (samples.empty()) return;
  if (!report_.given) SetImu({});
  for (const ImuSample& sample : stream_.Add({samples.begin(), samples.end()})) {
    if (!samples_.empty() && sample.time <= samples_.back().time) samples_.clear();  // set back
    samples_.push_back(sample);
    ++report_.samples;
  }
  if (report_.left_out.empty()) report_.left_out = stream_.broken();
  if (samples_.empty()) return;
  // What no pose will need any more.
  if (!placements_.empty() && samples_.back().time - placements_.back().time > kLongestGap) {
    placements_.clear();
    reckoner_.Forget();
    past_.clear();
  }
  const double oldest =
      (placements_.empty() ? samples_.back().time - 5 : placements_.front().time) - 2 * kMargin;
  const auto keep =
      std::lower_bound(samples_.begin(), samples_.end(), oldest,
                       [](const ImuSample& sample, double time) { return sample.time < time; });
  // Erased in large pieces, so that the cost per frame is small.
  if (keep - samples_.begin() > static_cast<long>(samples_.size() / 2))
    samples_.erase(samples_.begin(), keep);
}

void InertialWatch::Cut() {
  stream_.Restart();
  samples_.clear();
  placements_.clear();
  reckoner_.Forget();
  past_.clear();
  former_.reset();
  asked_at_ = kNever;
}

void InertialWatch::Placed(double time, const Anchor& anchor, const Matrix6d& covariance,
                           const MapSnapshot& map) {
  if (!given()) return;
  const MapId in = map.MapOf(anchor.keyframe);
  if (in != map_) Enter(in, time, map);
  if (!placements_.empty() && time - placements_.back().time < kSpacing) return;
  placements_.push_back({time, anchor, covariance});
  while (placements_.size() > kMostPoses) placements_.pop_front();
  FollowPoses(map);
}

// Takes the poses since the last fit into account.
void InertialWatch::FollowPoses(const MapSnapshot& map) {
  if (!reckoner_.known() || placements_.empty()) return;
  const double distance = DistanceIn(map);
  const double covered =
      samples_.empty() ? kNever : samples_.back().time - report_.model.time_offset;
  for (const Placement& placement : placements_) {
    if (!reckoner_.known()) return;
    if (placement.time <= reckoner_.time() || placement.time > covered) continue;
    if (map.MapOf(placement.anchor.keyframe) != map_) continue;
    past_.push_back(reckoner_);
    if (past_.size() > kPast) past_.pop_front();
    reckoner_.See(PoseIn(map, placement, distance), placement.anchor.keyframe, map, samples_);
    ahead_ = reckoner_;
  }
}

void InertialWatch::Reanchor(const MapSnapshot& map) {
  for (Placement& placement : placements_)
    placement.anchor = Reanchored(map.state(), placement.anchor);
  std::erase_if(placements_,
                [](const Placement& placement) { return !placement.anchor.keyframe.valid(); });
  if (reckoner_.known()) reckoner_.Reanchor(map);
  for (DeadReckoner& past : past_) past.Reanchor(map);
  std::erase_if(past_, [](const DeadReckoner& past) { return !past.known(); });
  if (former_) former_->Reanchor(map);
  if (ahead_.known()) ahead_.Reanchor(map);
}

double InertialWatch::DistanceIn(const MapSnapshot& map) const {
  const KeyFrame* newest = map.Find(placements_.back().anchor.keyframe);
  return newest ? MedianDepth(map, *newest).value_or(1) : 1;
}

TimedPose InertialWatch::PoseIn(const MapSnapshot& map, const Placement& placement,
                                double distance) const {
  TimedPose pose;
  pose.time = placement.time;
  pose.T_world_camera = PoseOf(map.state(), placement.anchor).Inverse();
  pose.covariance = placement.covariance;
  const double growth = map.ScaleOf(placement.anchor.keyframe) / placement.anchor.scale;
  pose.covariance.topRows<3>() *= growth;
  pose.covariance.leftCols<3>() *= growth;
  pose.covariance += CommonErrors(distance);
  return pose;
}

std::vector<TimedPose> InertialWatch::PosesIn(const MapSnapshot& map) const {
  std::vector<TimedPose> poses;
  if (placements_.empty()) return poses;
  const double distance = DistanceIn(map);
  for (const Placement& placement : placements_) {
    if (map.MapOf(placement.anchor.keyframe) == map_)
      poses.push_back(PoseIn(map, placement, distance));
  }
  return poses;
}

std::span<const ImuSample> InertialWatch::SamplesFrom(double time) const {
  const auto first =
      std::lower_bound(samples_.begin(), samples_.end(), time,
                       [](const ImuSample& sample, double at) { return sample.time < at; });
  return std::span(samples_).subspan(static_cast<size_t>(first - samples_.begin()));
}

std::optional<InertialQuestion> InertialWatch::Ask(const MapSnapshot& map) {
  if (!given() || awaiting_ || placements_.size() < kFewest || !report_.left_out.empty())
    return std::nullopt;
  const double newest = placements_.back().time;
  if (newest - asked_at_ < kAskEvery || newest - placements_.front().time < kFirstSeconds)
    return std::nullopt;
  InertialQuestion question;
  question.poses = PosesIn(map);
  const double offset = report_.model.time_offset;
  // The newest poses may be later than the readings.
  while (!question.poses.empty() && !samples_.empty() &&
         question.poses.back().time + offset > samples_.back().time)
    question.poses.pop_back();
  if (question.poses.size() < kFewest) return std::nullopt;
  const auto samples = SamplesFrom(question.poses.front().time + offset - kMargin);
  question.samples.assign(samples.begin(), samples.end());
  question.model = calibration_.model;
  question.priors = calibration_.priors;
  if (sensor_ != Sensor::kMono) question.priors.scale = kDepthScale;
  if (sensor_ == Sensor::kMono && known_scale_ > 0) question.priors.scale = known_scale_;
  question.start = fit_;
  if (accepted_) question.accepted = {accepted_->model, accepted_->states.back().bias};
  question.map = map_;
  question.reference = placements_.back().anchor.keyframe;
  question.T_reference_world = map.state().PoseOf(question.reference);
  question.scale = map.ScaleOf(question.reference);
  asked_at_ = newest;
  awaiting_ = true;
  return question;
}

void InertialWatch::Answer(InertialAnswer answer) {
  const std::lock_guard<std::mutex> lock(mutex_);
  answer_ = std::move(answer);
}

bool InertialWatch::Accepts(const InertialAnswer& answer) const {
  const InertialFit& fit = answer.fit;
  return agreements_ >= kAgreements && !answer.newest.Contradicts() && fit.solved &&
         fit.noise_factor < kMostNoiseFactor && fit.scale_sigma < kMostScaleSigma &&
         fit.gravity_sigma < kMostGravitySigma;
}

// Readings of another device, or images that were stabilized, do not turn as the camera does.
void InertialWatch::Judge(const InertialAnswer& answer) {
  const RotationMatch& match = answer.rotation;
  if (!match.Tells()) return;
  contradictions_ = match.Contradicts() ? contradictions_ + 1 : 0;
  if (!match.Contradicts()) ++agreements_;
  if (contradictions_ < kContradictions) return;
  report_.left_out =
      "the inertial readings contradict the images: the gyroscope does not turn as the camera does "
      "(stabilized images, or readings of another device?)";
}

// Whether the newest readings are used: not while poses and readings contradict each other because
// of the readings (a sensor that failed, a clock that jumped). If the newest rotations agree
// it is the map that is bent, and its motions hold it. A fit has poses and readings of up
// to 24 s, so that those since the last one that agreed stay in doubt when a later one agrees
// again.
void InertialWatch::Trust(const InertialAnswer& answer) {
  const InertialFit& fit = answer.fit;
  const bool turns = answer.newest.Tells() && !answer.newest.Contradicts();
  const bool agrees = turns || (fit.solved && fit.noise_factor < kMostNoiseFactor);
  if (!agrees) {
    doubtful_ = accepted_.has_value();
    if (!doubtful_) return;
    reckoner_.Forget();
    ahead_.Forget();
    past_.clear();
    return;
  }
  if (std::exchange(doubtful_, false)) doubted_until_ = fit.first.time;
  if (fit.solved) agreed_until_ = fit.last.time;
}

InertialWatch::Changes InertialWatch::UseAnswer(const MapSnapshot& map) {
  std::optional<InertialAnswer> answer;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    answer = std::exchange(answer_, std::nullopt);
  }
  if (!answer) return {};
  awaiting_ = false;
  Judge(*answer);
  if (!report_.left_out.empty() || answer->map != map_ || !map.Find(answer->reference)) return {};
  InertialFit& fit = answer->fit;
  Trust(*answer);
  if (!fit.solved) return {};
  report_.bias = fit.states.back().bias;
  report_.model.T_camera_imu = fit.model.T_camera_imu;
  report_.model.time_offset = fit.model.time_offset;
  report_.rotation_sigma = fit.rotation_sigma;
  report_.time_offset_sigma = fit.time_offset_sigma;
  Changes changes;
  const bool accepted = Accepts(*answer);
  // The map may have been scaled since the question.
  const double grown = map.ScaleOf(answer->reference) / answer->scale;
  fit.scale /= grown;
  fit.first.common.scale /= grown;
  if (accepted) {
    changes.join = JoinBy(fit, map);
    const double unit = sensor_ == Sensor::kMono ? 0 : kDepthScale;
    const double off = std::abs(std::log(fit.scale)) / std::hypot(fit.scale_sigma, unit);
    if (sensor_ == Sensor::kMono && may_scale_ && off > kRescale) {
      changes.growth = Growth{map_, fit.scale};
      fit.scale = 1;
    }
    report_.metric = changes.growth || off < kMetric;
    report_.missing = report_.metric ? "" : AnotherUnit(fit.scale, sensor_);
    report_.gravity = fit.gravity.normalized();
    report_.gravity_sigma = fit.gravity_sigma;
    report_.scale_sigma = fit.scale_sigma;
    learned_ = LearnedFrom(fit);
    accepted_ = fit;
    reckoner_.Start(
        fit.last,
        {answer->reference,
         fit.last.T_world_camera().Inverse() * answer->T_reference_world.Inverse(), answer->scale});
    ahead_ = reckoner_;
    while (!past_.empty() && past_.back().time() >= reckoner_.time()) past_.pop_back();
    FollowPoses(map);
  }
  fit_ = std::move(fit);
  if (changes.join) {
    // The map takes the axes and the unit of the older one.
    changes.growth.reset();
    report_.gravity = changes.join->T_older_younger.R * *report_.gravity;
    map_ = changes.join->older;
    fit_.reset();
    reckoner_.Forget();
    past_.clear();
    former_.reset();
  }
  return changes;
}

std::optional<Eigen::Matrix3d> InertialWatch::TurnBetween(double from, double to) const {
  if (agreements_ < kAgreements || doubtful_ || !report_.left_out.empty() || samples_.size() < 2)
    return std::nullopt;
  const ImuModel& model = report_.model;
  const bool known = model.rotation_known ||
                     (report_.rotation_sigma > 0 && report_.rotation_sigma < kRotationSigma);
  from += model.time_offset;
  to += model.time_offset;
  if (!known || from < samples_.front().time || to > samples_.back().time + 0.01 || to < from)
    return std::nullopt;
  const auto samples = SamplesFrom(from - 0.1);
  if (!TellMotion(samples, from, to)) return std::nullopt;
  const Eigen::Matrix3d turn = TurnOf(samples, from, to, report_.bias.gyro);
  const Eigen::Matrix3d& R = model.T_camera_imu.R;
  return R * turn.transpose() * R.transpose();
}

}  // namespace alidade
