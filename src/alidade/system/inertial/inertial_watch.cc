#include "alidade/system/inertial/inertial_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/map/view.h"

namespace alidade {
namespace {

constexpr double kSpacing = 0.09;      // seconds between poses that are fitted
constexpr size_t kMostPoses = 240;     // about 24 s
constexpr size_t kFewest = 8;          // poses
constexpr double kFirstSeconds = 1.5;  // span of the poses of the first fit
constexpr double kAskEvery = 0.5;      // seconds
constexpr double kMargin = 0.3;        // seconds of readings kept beside the poses
// A map is in meters when its scale is known to 5 %: refined from then on.
constexpr double kScaleSigma = 0.05;
// In standard deviations of the scale: a map is scaled again when it is off by more than the first,
// and one that must not be scaled is in meters when it is off by less than the second.
constexpr double kRescale = 0.3, kMetric = 3;
constexpr double kGravitySigma = 0.035;  // radians: 2 degrees
// Noise several times what is assumed: the model is wrong.
constexpr double kMostNoise = 6;
// Rotations contradict each other when the camera turns and the gyroscope explains less than half
// of it, in this many fits in a row.
constexpr double kTurning = 0.1;  // rad/s
constexpr int kContradictions = 3;
// Readings are used once rotations have agreed in this many fits: until then nothing tells that
// they are of this camera.
constexpr int kAgreements = 2;
// The rotation of the sensor is known well enough to predict frames.
constexpr double kRotationSigma = 0.03;  // radians
// Poses of a map have errors in common that their covariance does not contain.
constexpr double kLeastRotation = 7e-4;    // radians
constexpr double kLeastPosition = 1.5e-3;  // relative to the distance of what is seen

}  // namespace

InertialAnswer AnswerOf(const InertialQuestion& question) {
  InertialAnswer answer;
  answer.map = question.map;
  answer.reference = question.reference;
  answer.scale = question.scale;
  const InertialFit* start = question.start ? &*question.start : nullptr;
  ImuModel found = question.model;
  if (start) {
    found.T_camera_imu.R = start->model.T_camera_imu.R;
    found.time_offset = start->model.time_offset;
    found.rotation_known = found.time_offset_known = true;
  }
  answer.rotation = MatchRotations(question.poses, question.samples, found);
  answer.fit =
      FitInertial(question.poses, question.samples, question.model, question.priors, start);
  if (!answer.fit.solved && start)
    answer.fit = FitInertial(question.poses, question.samples, question.model, question.priors);
  return answer;
}

void InertialWatch::SetImu(const ImuModel& model) {
  report_.given = true;
  report_.model = given_model_ = model;
  ForgetMap();
}

void InertialWatch::ForgetMap() {
  fit_.reset();
  report_.metric = false;
  report_.gravity.reset();
  report_.scale_sigma = report_.gravity_sigma = 0;
  report_.missing = "scale is not observable yet";
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
  asked_at_ = kNever;
}

void InertialWatch::Placed(double time, const Anchor& anchor, MapId map,
                           const Matrix6d& covariance) {
  if (!given()) return;
  if (map != map_) {
    placements_.clear();
    map_ = map;
    ForgetMap();
  }
  if (!placements_.empty() && time - placements_.back().time < kSpacing) return;
  placements_.push_back({time, anchor, covariance});
  while (placements_.size() > kMostPoses) placements_.pop_front();
}

void InertialWatch::Reanchor(const MapSnapshot& map) {
  for (Placement& placement : placements_)
    placement.anchor = Reanchored(map.state(), placement.anchor);
  std::erase_if(placements_,
                [](const Placement& placement) { return !placement.anchor.keyframe.valid(); });
}

std::vector<TimedPose> InertialWatch::PosesIn(const MapSnapshot& map) const {
  std::vector<TimedPose> poses;
  for (const Placement& placement : placements_) {
    if (map.MapOf(placement.anchor.keyframe) != map_) continue;
    TimedPose pose;
    pose.time = placement.time;
    pose.T_world_camera = PoseOf(map.state(), placement.anchor).Inverse();
    pose.covariance = placement.covariance;
    const double growth = map.ScaleOf(placement.anchor.keyframe) / placement.anchor.scale;
    pose.covariance.topRows<3>() *= growth;
    pose.covariance.leftCols<3>() *= growth;
    poses.push_back(pose);
  }
  if (poses.empty()) return poses;
  double distance = 1;
  if (const KeyFrame* newest = map.Find(placements_.back().anchor.keyframe))
    distance = MedianDepth(map, *newest).value_or(1);
  Vector6d least;
  least << Eigen::Vector3d::Constant(std::pow(kLeastPosition * distance, 2)),
      Eigen::Vector3d::Constant(kLeastRotation * kLeastRotation);
  for (TimedPose& pose : poses) pose.covariance.diagonal() += least;
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
  question.model = given_model_;  // the priors are about what was given
  if (sensor_ != Sensor::kMono) question.priors.scale = 0.01;
  question.start = fit_;
  question.map = map_;
  question.reference = placements_.back().anchor.keyframe;
  question.scale = map.ScaleOf(question.reference);
  asked_at_ = newest;
  awaiting_ = true;
  return question;
}

void InertialWatch::Answer(InertialAnswer answer) {
  const std::lock_guard<std::mutex> lock(mutex_);
  answer_ = std::move(answer);
}

bool InertialWatch::Accepts(const InertialFit& fit) const {
  return agreements_ >= kAgreements && fit.solved && fit.noise_factor < kMostNoise &&
         fit.scale_sigma < kScaleSigma && fit.gravity_sigma < kGravitySigma;
}

// Readings of another device, or images that were stabilized, do not turn as the camera does.
void InertialWatch::Judge(const InertialAnswer& answer) {
  const RotationMatch& match = answer.rotation;
  if (!match.ok || match.turning < kTurning) return;
  const bool agree = match.residual < 0.5 * match.turning;
  contradictions_ = agree ? 0 : contradictions_ + 1;
  if (agree) ++agreements_;
  if (contradictions_ < kContradictions) return;
  report_.left_out =
      "the inertial readings contradict the images: the gyroscope does not turn as the camera does "
      "(stabilized images, or readings of another device?)";
}

std::optional<InertialWatch::Growth> InertialWatch::UseAnswer(const MapSnapshot& map) {
  std::optional<InertialAnswer> answer;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    answer = std::exchange(answer_, std::nullopt);
  }
  if (!answer) return std::nullopt;
  awaiting_ = false;
  Judge(*answer);
  if (!report_.left_out.empty() || !answer->fit.solved || answer->map != map_ ||
      !map.Find(answer->reference))
    return std::nullopt;
  InertialFit& fit = answer->fit;
  // The map may have been scaled since the question.
  fit.scale /= map.ScaleOf(answer->reference) / answer->scale;
  report_.bias = fit.states.back().bias;
  report_.model.T_camera_imu = fit.model.T_camera_imu;
  report_.model.time_offset = fit.model.time_offset;
  report_.rotation_sigma = fit.rotation_sigma;
  report_.time_offset_sigma = fit.time_offset_sigma;
  std::optional<Growth> growth;
  if (Accepts(fit)) {
    const double off = std::abs(std::log(fit.scale)) / fit.scale_sigma;
    if (sensor_ == Sensor::kMono && may_scale_ && off > kRescale) {
      growth = Growth{map_, fit.scale};
      fit.scale = 1;
    }
    report_.metric = growth || off < kMetric;
    report_.missing = report_.metric ? "" : "the map is in another unit, and it is not changed";
    report_.gravity = fit.gravity.normalized();
    report_.gravity_sigma = fit.gravity_sigma;
    report_.scale_sigma = fit.scale_sigma;
  }
  fit_ = std::move(fit);
  return growth;
}

std::optional<Eigen::Matrix3d> InertialWatch::TurnBetween(double from, double to) const {
  if (agreements_ < kAgreements || !report_.left_out.empty() || samples_.size() < 2)
    return std::nullopt;
  const ImuModel& model = report_.model;
  const bool known = model.rotation_known ||
                     (report_.rotation_sigma > 0 && report_.rotation_sigma < kRotationSigma);
  from += model.time_offset;
  to += model.time_offset;
  if (!known || from < samples_.front().time || to > samples_.back().time + 0.01 || to < from)
    return std::nullopt;
  const auto samples = SamplesFrom(from - 0.1);
  const Eigen::Matrix3d turn = TurnOf(samples, from, to, report_.bias.gyro);
  const Eigen::Matrix3d& R = model.T_camera_imu.R;
  return R * turn.transpose() * R.transpose();
}

}  // namespace alidade
