#include "alidade/system/inertial/orientation_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/inertial/rotation_match.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMapView = -2;         // the map, among the views of the filter
constexpr double kWaits = 4;         // seconds of frames that wait for the sensor to be known
constexpr double kLate = 0.3;        // seconds that a frame waits for readings
constexpr double kCovers = 0.05;     // seconds that readings are extrapolated by
constexpr size_t kFewestPoses = 15;  // whose rotations are compared
constexpr int kMatchEvery = 5;       // frames
constexpr double kSensorRotation = 0.1, kSensorOffset = 0.01;  // radians, seconds: enough to begin
// The filter starts from a match of the same images, whose errors are not independent: with this
// many standard deviations.
constexpr double kWidening = 3;
constexpr double kLeastRotation = 0.01, kLeastOffset = 2e-3;
// Errors of rotations to one view are alike for about this long (parallax changes slowly): each of
// the images in that time is given its share of what one of them would tell.
constexpr double kAlike = 0.5;  // seconds
// A camera that turns at a spot: the way of the sensor, which is beside it, and of what is seen
// from afar; and the distance, with which parallax is turned into motion.
constexpr double kSway = 0.05, kDistance = 10;  // meters
constexpr double kFirstSpot = 1;  // seconds: in less, gravity is not known better than 2 degrees
constexpr double kUnknownPose = 1e-2;  // radians: of a pose without covariance: two views
// Radians, of poses of one map in common: a young map bends.
constexpr double kMapErrors = 3e-3;
constexpr int kRefused = 15;         // poses in a row: the map has changed
constexpr double kLongestPause = 2;  // seconds between frames

std::vector<double> LensOf(const Camera& camera) {
  std::vector<double> lens(camera.distortion.begin(), camera.distortion.end());
  for (double value : {camera.fx, camera.fy, camera.cx, camera.cy}) lens.push_back(value);
  return lens;
}

}  // namespace

void OrientationWatch::SetImu(const ImuModel& model) {
  given_ = model;
  sensor_.reset();
  if (model.rotation_known) {
    const InertialPriors usual;
    AttitudePriors priors;
    priors.rotation = usual.rotation_known;
    priors.time_offset = model.time_offset_known ? usual.time_offset_known : usual.time_offset;
    sensor_ = {model, priors};
  }
  Restart();
}

void OrientationWatch::Restart() {
  if (filter_) {
    sensor_ = {filter_->model(), {}};
    sensor_->model.noise = given_.noise;
    sensor_->priors.bias = filter_->bias();
    sensor_->priors.rotation = filter_->RotationSigma();
    sensor_->priors.time_offset = filter_->TimeOffsetSigma();
  }
  filter_.reset();
  views_.Reset();
  waiting_.clear();
  last_.reset();
  map_ = {};
}

std::optional<CameraOrientation> OrientationWatch::See(const Frame& frame, const Camera& camera,
                                                       double time,
                                                       std::span<const ImuSample> samples,
                                                       const std::optional<MapPose>& pose) {
  if (last_ && !(time > last_->time && time - last_->time < kLongestPause)) Restart();
  last_ = EventOf(frame, camera, time, samples, pose);
  waiting_.push_back(*last_);
  if (!filter_) {
    if (!sensor_) FindSensor(samples);
    Begin(samples);
  }
  while (!filter_ && time - waiting_.front().time > kWaits) waiting_.pop_front();
  if (!filter_ || samples.empty()) return std::nullopt;
  UseCovered(samples);
  if (waiting_.empty()) return Told(*filter_, pose);
  // Readings are late, or the clock of the images is: what they do not cover is extrapolated.
  AttitudeFilter ahead = *filter_;
  for (const Event& event : waiting_) Use(event, samples, ahead);
  return Told(ahead, pose);
}

// By the gyroscope, R_last_now of the camera.
std::optional<Matrix3d> OrientationWatch::TurnSince(double time,
                                                    std::span<const ImuSample> samples) const {
  if (!filter_ || !last_ || samples.empty()) return std::nullopt;
  const ImuModel& model = filter_->model();
  if (time + model.time_offset > samples.back().time + kCovers) return std::nullopt;
  const Matrix3d turn = TurnOf(samples, last_->time + model.time_offset, time + model.time_offset,
                               filter_->bias().gyro);
  const Matrix3d& R = model.T_camera_imu.R;
  return R * turn * R.transpose();
}

OrientationWatch::Event OrientationWatch::EventOf(const Frame& frame, const Camera& camera,
                                                  double time, std::span<const ImuSample> samples,
                                                  const std::optional<MapPose>& pose) {
  Event event;
  event.time = time;
  const double share = last_ ? std::min(1.0, (time - last_->time) / kAlike) : 1;
  Matrix3d covariance = Matrix3d::Zero();
  if (pose) {
    covariance = pose->covariance;
    if (covariance.isZero(0)) covariance = kUnknownPose * kUnknownPose * Matrix3d::Identity();
    covariance += kMapErrors * kMapErrors * Matrix3d::Identity();
  }
  if (pose && pose->map == map_) {
    event.seen = TurnViews::Seen{kMapView, pose->R_map_camera, covariance / share};
    event.R_start_camera = R_start_map_ * pose->R_map_camera;
    event.known = true;
    views_.Turned(event.R_start_camera);
    return event;
  }
  if (std::vector<double> lens = LensOf(camera); lens != lens_) {
    views_.Reset();
    if (last_) views_.Turned(last_->R_start_camera);
    lens_ = std::move(lens);
  }
  const TurnViews::Step step = views_.Add(frame, camera, TurnSince(time, samples));
  event.R_start_camera = step.R_start_camera;
  event.known = step.known;
  event.seen = step.seen;
  if (event.seen) {
    event.seen->covariance /= share;
    if (event.seen->at_spot && time - spot_since_ > kFirstSpot)
      event.spot_sigma = std::hypot(kSway, kDistance * event.seen->moved) / std::sqrt(share);
  }
  event.new_spot = step.new_spot;
  if (event.new_spot) spot_since_ = time;
  if (step.dropped) event.dropped.push_back(*step.dropped);
  if (step.added) event.added.push_back({*step.added, Matrix3d::Identity(), Matrix3d::Zero()});
  // A lost map may be found again, and tells the heading then.
  if (pose) {
    if (map_.valid()) event.dropped.push_back(kMapView);
    map_ = pose->map;
    event.added.push_back({kMapView, pose->R_map_camera.transpose(), covariance});
    R_start_map_ = event.R_start_camera * pose->R_map_camera.transpose();
  }
  return event;
}

// Compares the rotations of the camera with the gyroscope's.
void OrientationWatch::FindSensor(std::span<const ImuSample> samples) {
  if (--until_match_ > 0) return;
  until_match_ = kMatchEvery;
  std::vector<TimedPose> poses;
  for (const Event& event : waiting_) {
    if (!event.known) continue;
    poses.push_back({event.time, {event.R_start_camera, Vector3d::Zero()}});
  }
  if (poses.size() < kFewestPoses) return;
  const RotationMatch match = MatchRotations(poses, samples, given_);
  if (!match.Tells() || match.Contradicts() || match.rotation_sigma > kSensorRotation ||
      match.time_offset_sigma > kSensorOffset)
    return;
  Learned found{given_, {}};
  found.model.T_camera_imu.R = match.R_camera_imu;
  found.model.time_offset = match.time_offset;
  found.priors.bias.gyro = match.gyro_bias;
  found.priors.rotation = std::max(kLeastRotation, kWidening * match.rotation_sigma);
  found.priors.time_offset = given_.time_offset_known
                                 ? InertialPriors{}.time_offset_known
                                 : std::max(kLeastOffset, kWidening * match.time_offset_sigma);
  sensor_ = std::move(found);
}

void OrientationWatch::Begin(std::span<const ImuSample> samples) {
  const Event& first = waiting_.front();
  if (!sensor_ || samples.empty() ||
      samples.back().time < first.time + sensor_->model.time_offset - kCovers)
    return;
  filter_.emplace(sensor_->model, sensor_->priors, first.time, samples, first.R_start_camera);
}

// False: the measured rotation contradicts the filter.
bool OrientationWatch::Use(const Event& event, std::span<const ImuSample> samples,
                           AttitudeFilter& filter) {
  bool agrees = true;
  filter.Advance(event.time, samples);
  for (int id : event.dropped) filter.DropView(id);
  if (event.seen && !filter.HasView(event.seen->view)) {  // from before the filter began
    filter.AddView(event.seen->view, event.seen->R_view_camera.transpose());
  } else if (event.seen) {
    agrees = filter.See(event.seen->view, event.seen->R_view_camera, event.seen->covariance);
  }
  if (event.spot_sigma > 0) filter.StayAtSpot(event.spot_sigma);
  if (event.new_spot) filter.MoveOn();
  for (const View& view : event.added) filter.AddView(view.id, view.R_camera_view, view.covariance);
  return agrees;
}

void OrientationWatch::UseCovered(std::span<const ImuSample> samples) {
  while (!waiting_.empty()) {
    const Event& event = waiting_.front();
    const double covered = samples.back().time - filter_->model().time_offset;
    if (event.time > covered && last_->time - event.time < kLate) return;
    refused_ = Use(event, samples, *filter_) ? 0 : refused_ + 1;
    if (refused_ >= kRefused && event.seen->view == kMapView) {
      filter_->AddView(kMapView, event.seen->R_view_camera.transpose());
      refused_ = 0;
    }
    waiting_.pop_front();
  }
}

// While tracking it follows the pose, in the attitude of the map. What the map tells of gravity is
// used by the inverse variances. The readings are the same as the filter's: the errors are taken as
// those of the better one.
CameraOrientation OrientationWatch::Told(const AttitudeFilter& filter,
                                         const std::optional<MapPose>& pose) {
  const Attitude camera = filter.Camera();
  CameraOrientation told{camera.R_world_camera, camera.TiltSigma(), camera.HeadingSigma()};
  if (!pose || !pose->world || !(pose->world->down_sigma > 0) || !filter.HasView(kMapView))
    return told;
  const Attitude map = filter.View(kMapView);
  const double own = map.TiltSigma(), other = pose->world->down_sigma;
  const Eigen::AngleAxisd upright(Eigen::Quaterniond::FromTwoVectors(
      -(map.R_world_camera * pose->world->down), Vector3d::UnitZ()));
  const double weight = own * own / (own * own + other * other);
  told.R_world_camera =
      Eigen::AngleAxisd(weight * upright.angle(), upright.axis()) * told.R_world_camera;
  told.tilt_sigma = std::min(told.tilt_sigma, other);
  return told;
}

}  // namespace alidade
