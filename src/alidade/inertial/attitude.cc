#include "alidade/inertial/attitude.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/inertial/largest_sigma.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kUp(0, 0, 1);
constexpr double kFirstTilt = 0.3;     // radians: an acceleration of 3 m/s² at the start
constexpr double kFirstSeconds = 0.5;  // of readings on either side that tell the first tilt
constexpr double kLongestPause = 0.1;  // seconds between readings; what is longer is a gap
// Of a camera without readings: rates that last for about kGapSeconds.
constexpr double kGapSeconds = 1;
constexpr double kGapRate = 1;           // rad/s
constexpr double kGapForce = 2;          // m/s²
constexpr double kMotionSeconds = 0.04;  // that one measurement of the motion averages, at most
// 99.9 % of chi² with 3 degrees of freedom.
constexpr double kGate = 16.27;
constexpr int kStart = -1;  // SeenView::id of the camera at the start
constexpr double kNoGate = std::numeric_limits<double>::infinity();

// Mean specific force of the second around `time`, in the axes of the sensor at that time.
Vector3d MeanForce(std::span<const ImuSample> samples, double time, const ImuBias& bias) {
  const Matrix3d R_first_then = TurnOf(samples, time - kFirstSeconds, time, bias.gyro);
  Matrix3d R = R_first_then.transpose();
  double last = time - kFirstSeconds;
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const ImuSample& sample : samples) {
    if (std::abs(sample.time - time) > kFirstSeconds) continue;
    R = R * TurnOf(samples, last, sample.time, bias.gyro);
    last = sample.time;
    sum += R * (sample.specific_force - bias.accel);
    ++count;
  }
  return count > 0 ? (sum / count).eval() : ReadingAt(samples, time).specific_force;
}

}  // namespace

double Attitude::TiltSigma() const {
  Matrix3d horizontal = Matrix3d::Zero();
  horizontal.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>();
  return LargestSigma(horizontal);
}
double Attitude::HeadingSigma() const { return std::sqrt(std::max(0.0, covariance(2, 2))); }

AttitudeFilter::AttitudeFilter(const ImuModel& model, const AttitudePriors& priors,
                               double image_time, std::span<const ImuSample> samples,
                               const Matrix3d& R_start_camera)
    : model_(model), priors_(priors), time_(image_time + model.time_offset), bias_(priors.bias) {
  model_.noise = InUse(model.noise);
  angular_rate_ = ReadingAt(samples, time_).angular_rate;
  const Vector3d force = MeanForce(samples, time_, bias_);
  R_world_imu_ = Eigen::Quaterniond::FromTwoVectors(force, kUp).toRotationMatrix();
  Eigen::VectorXd sigma(int{kViews});
  sigma.segment<3>(kAttitude) << kFirstTilt, kFirstTilt, 0;  // any heading: see Told()
  sigma.segment<3>(kGyro).setConstant(priors.gyro_bias);
  sigma.segment<3>(kAccel).setConstant(priors.accel_bias);
  sigma.segment<3>(kVelocity).setConstant(priors.held_speed);
  sigma.segment<3>(kPosition).setZero();
  sigma.segment<3>(kMounting).setConstant(priors.rotation);
  sigma(kClock) = priors.time_offset;
  covariance_ = sigma.cwiseAbs2().asDiagonal();
  AddView(kStart, R_start_camera.transpose());
}

// A direction of the camera at the start that was not vertical, in the world of the state.
Vector3d AttitudeFilter::StartAhead() const {
  const Matrix3d& R = views_.front().R_world_view;
  if (R.col(2).head<2>().norm() > 0.2) return R.col(2);
  return (R(2, 2) < 0 ? -1 : 1) * R.col(1);
}

// `R` in the world whose heading is 0 at the start. With the horizontal direction h of that time,
// the heading is atan2(h_y, h_x), and errors e of its attitude change it by
// e_z - h_z (h_x e_x + h_y e_y) / (h_x² + h_y²).
Attitude AttitudeFilter::Told(const Matrix3d& R, const Rows3& by_state) const {
  const Vector3d ahead = StartAhead();
  const Matrix3d turn = ExpSo3(-std::atan2(ahead.y(), ahead.x()) * kUp);
  const double slope = ahead.z() / ahead.head<2>().squaredNorm();
  Rows3 by = by_state;
  by.block<1, 3>(2, kViews) += Eigen::RowVector3d(slope * ahead.x(), slope * ahead.y(), -1);
  by = turn * by;
  return {turn * R, by * covariance_ * by.transpose()};
}

Matrix3d AttitudeFilter::R_world_camera() const {
  return R_world_imu_ * model_.T_camera_imu.R.transpose();
}

// R_world_camera of the image = R_world_imu Exp(rate * offset error) R_camera_imu'.
AttitudeFilter::Rows3 AttitudeFilter::ByCamera() const {
  Rows3 by = Rows3::Zero(3, covariance_.cols());
  by.middleCols<3>(kAttitude).setIdentity();
  by.middleCols<3>(kMounting) = -R_world_imu_;
  by.col(kClock) = R_world_imu_ * (angular_rate_ - bias_.gyro);
  return by;
}

Attitude AttitudeFilter::Camera() const { return Told(R_world_camera(), ByCamera()); }

int AttitudeFilter::IndexOf(int id) const {
  for (size_t i = 0; i < views_.size(); ++i) {
    if (views_[i].id == id) return static_cast<int>(i);
  }
  return -1;
}

bool AttitudeFilter::HasView(int id) const { return IndexOf(id) >= 0; }

Attitude AttitudeFilter::View(int id) const {
  const int index = IndexOf(id);
  Rows3 by = Rows3::Zero(3, covariance_.cols());
  by.middleCols<3>(kViews + 3 * index).setIdentity();
  return Told(views_[index].R_world_view, by);
}

void AttitudeFilter::AddView(int id, const Matrix3d& R_camera_view, const Matrix3d& covariance) {
  DropView(id);
  const long size = covariance_.rows();
  const Rows3 by = ByCamera();
  const Rows3 cross = by * covariance_;
  const Matrix3d R = R_world_camera();
  const Matrix3d own = cross * by.transpose() + R * covariance * R.transpose();
  covariance_.conservativeResize(size + 3, size + 3);
  covariance_.block(size, 0, 3, size) = cross;
  covariance_.block(0, size, size, 3) = cross.transpose();
  covariance_.block<3, 3>(size, size) = own;
  views_.push_back({id, R * R_camera_view});
}

void AttitudeFilter::DropView(int id) {
  const int index = IndexOf(id);
  if (index < 0) return;
  const long at = kViews + 3 * index, size = covariance_.rows(), after = size - at - 3;
  Eigen::MatrixXd kept(size - 3, size - 3);
  kept.topLeftCorner(at, at) = covariance_.topLeftCorner(at, at);
  kept.topRightCorner(at, after) = covariance_.topRightCorner(at, after);
  kept.bottomLeftCorner(after, at) = covariance_.bottomLeftCorner(after, at);
  kept.bottomRightCorner(after, after) = covariance_.bottomRightCorner(after, after);
  covariance_ = std::move(kept);
  views_.erase(views_.begin() + index);
}

void AttitudeFilter::Advance(double image_time, std::span<const ImuSample> samples) {
  const double until = image_time + model_.time_offset;
  if (!(until > time_) || samples.empty()) return;
  auto sample = std::upper_bound(samples.begin(), samples.end(), time_,
                                 [](double at, const ImuSample& s) { return at < s.time; });
  ImuSample last = ReadingAt(samples, time_);
  // What the motion is measured by: the mean of the last readings.
  double seconds = 0;
  Vector3d force = Vector3d::Zero();
  const auto step = [&](const ImuSample& next, bool covered) {
    const double span = next.time - last.time;
    if (!covered) {
      Gap(span);
    } else if (span > 0) {
      Step(last, next);
      seconds += span;
      force +=
          R_world_imu_ * ((last.specific_force + next.specific_force) / 2 - bias_.accel) * span;
      if (seconds >= kMotionSeconds) {
        MeasureMotion(seconds, force / seconds);
        seconds = 0;
        force.setZero();
      }
    }
    last = next;
  };
  const auto covered_to = [&](double time) {
    return sample == samples.begin() || time - std::prev(sample)->time <= kLongestPause;
  };
  for (; sample != samples.end() && sample->time < until; ++sample)
    step(*sample, covered_to(sample->time));
  step(ReadingAt(samples, until), covered_to(sample == samples.end() ? until : sample->time));
  if (seconds > 0) MeasureMotion(seconds, force / seconds);
  time_ = until;
  angular_rate_ = last.angular_rate;
}

// Readings are taken at the middle of the step. Only the rows of attitude and velocity change.
void AttitudeFilter::Step(const ImuSample& from, const ImuSample& to) {
  const double dt = to.time - from.time;
  const Vector3d turn = ((from.angular_rate + to.angular_rate) / 2 - bias_.gyro) * dt;
  const Matrix3d R = R_world_imu_ * ExpSo3(turn / 2);
  const Vector3d force = R * ((from.specific_force + to.specific_force) / 2 - bias_.accel);
  R_world_imu_ = R_world_imu_ * ExpSo3(turn);
  position_ += velocity_ * dt;
  velocity_ += (force - kGravity * kUp) * dt;

  Eigen::MatrixXd& P = covariance_;
  const auto rows = [&](int at) { return P.middleRows<3>(at); };
  const auto columns = [&](int at) { return P.middleCols<3>(at); };
  const Matrix3d v_by_attitude = -dt * Skew(force), by_bias = -dt * R;
  rows(kPosition) += dt * rows(kVelocity);
  rows(kVelocity) += v_by_attitude * rows(kAttitude) + by_bias * rows(kAccel);
  rows(kAttitude) += by_bias * rows(kGyro);
  columns(kPosition) += dt * columns(kVelocity);
  columns(kVelocity) +=
      columns(kAttitude) * v_by_attitude.transpose() + columns(kAccel) * by_bias.transpose();
  columns(kAttitude) += columns(kGyro) * by_bias.transpose();
  const ImuNoise& noise = model_.noise;
  const auto add = [&](int at, double density) {
    P.diagonal().segment<3>(at).array() += density * density * dt;
  };
  add(kAttitude, noise.gyro);
  add(kVelocity, noise.accel);
  add(kGyro, noise.gyro_walk);
  add(kAccel, noise.accel_walk);
}

void AttitudeFilter::Gap(double seconds) {
  const auto wander = [&](int at, double rate) {
    covariance_.diagonal().segment<3>(at).array() += rate * rate * kGapSeconds * seconds;
  };
  wander(kAttitude, kGapRate);
  wander(kVelocity, kGapForce);
  wander(kPosition, priors_.held_speed);
}

// `force`: mean of R (f - bias) over the last `seconds`. The derivative by the attitude is that at
// the expected force g - v/τ: with the measured one, which contains the noise of this measurement,
// it would tell the heading (errors in variables).
void AttitudeFilter::MeasureMotion(double seconds, const Vector3d& force) {
  const double tau = priors_.held_seconds;
  Rows3 by = Rows3::Zero(3, covariance_.cols());
  by.middleCols<3>(kAttitude) = -Skew(kGravity * kUp - velocity_ / tau);
  by.middleCols<3>(kAccel) = -R_world_imu_;
  by.middleCols<3>(kVelocity) = Matrix3d::Identity() / tau;
  const double density = 2 * priors_.held_speed * priors_.held_speed / tau;
  const Vector3d innovation = kGravity * kUp - force - velocity_ / tau;
  Measure(by, innovation, Matrix3d::Identity() * (density / seconds), kNoGate);
}

void AttitudeFilter::StayAtSpot(double sigma) {
  Rows3 by = Rows3::Zero(3, covariance_.cols());
  by.middleCols<3>(kPosition).setIdentity();
  Measure(by, -position_, sigma * sigma * Matrix3d::Identity(), kNoGate);
}

void AttitudeFilter::MoveOn() {
  position_.setZero();
  covariance_.middleRows<3>(kPosition).setZero();
  covariance_.middleCols<3>(kPosition).setZero();
}

bool AttitudeFilter::See(int id, const Matrix3d& R_view_camera, const Matrix3d& covariance) {
  const int index = IndexOf(id);
  if (index < 0) return false;
  const Matrix3d R = R_world_camera();
  Rows3 by = ByCamera();
  by.middleCols<3>(kViews + 3 * index) -= Matrix3d::Identity();
  // In the axes of the world, of the measured camera against the believed one.
  const Vector3d residual = R * LogSo3(R.transpose() * views_[index].R_world_view * R_view_camera);
  return Measure(by, residual, R * covariance * R.transpose(), kGate);
}

bool AttitudeFilter::Measure(const Rows3& by, const Vector3d& residual, const Matrix3d& noise,
                             double gate) {
  const Rows3 cross = by * covariance_;
  const Eigen::LLT<Matrix3d> solver(cross * by.transpose() + noise);
  if (solver.info() != Eigen::Success) return false;
  const Vector3d weighed = solver.solve(residual);
  if (!(residual.dot(weighed) <= gate)) return false;
  const Rows3 solved = solver.solve(cross);
  covariance_ -= cross.transpose() * solved;
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  Increase(cross.transpose() * weighed);
  return true;
}

void AttitudeFilter::Increase(const Eigen::VectorXd& step) {
  const auto turn = [&step](Matrix3d& R, int at) {
    const Matrix3d turned = ExpSo3(step.segment<3>(at)) * R;
    R = Eigen::Quaterniond(turned).normalized().toRotationMatrix();
  };
  turn(R_world_imu_, kAttitude);
  bias_.gyro += step.segment<3>(kGyro);
  bias_.accel += step.segment<3>(kAccel);
  velocity_ += step.segment<3>(kVelocity);
  position_ += step.segment<3>(kPosition);
  Matrix3d& R = model_.T_camera_imu.R;
  R = Eigen::Quaterniond(R * ExpSo3(step.segment<3>(kMounting))).normalized().toRotationMatrix();
  model_.time_offset += step(kClock);
  for (size_t i = 0; i < views_.size(); ++i)
    turn(views_[i].R_world_view, kViews + 3 * static_cast<int>(i));
}

double AttitudeFilter::RotationSigma() const {
  return LargestSigma(covariance_.block<3, 3>(kMounting, kMounting));
}

double AttitudeFilter::TimeOffsetSigma() const {
  return std::sqrt(std::max(0.0, covariance_(kClock, kClock)));
}

}  // namespace alidade
