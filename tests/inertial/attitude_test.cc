// The orientation of a held camera against motions drawn from the model and true ones: errors are
// as large as the filter says.
#include "alidade/inertial/attitude.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "alidade/base/random.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kRate = 200;        // readings per second
constexpr double kViewSigma = 2e-3;  // radians

Vector3d Noise3(Random& random, double sigma) {
  const double x = random.Gaussian(), y = random.Gaussian(), z = random.Gaussian();
  return sigma * Vector3d(x, y, z);
}

// The camera looks about: R_world_camera; x right, y down, z forward; it looks along x at 0 s.
Matrix3d Look(double time) {
  const double yaw = 0.7 * std::sin(0.5 * time) + 0.1 * std::sin(3 * time);
  const double pitch = 0.2 * std::sin(0.9 * time), roll = 0.08 * std::sin(2.1 * time);
  Matrix3d R_ahead;
  R_ahead << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return ExpSo3({0, 0, yaw}) * R_ahead * ExpSo3({pitch, 0, 0}) * ExpSo3({0, 0, roll});
}

// A phone and what it reads until `seconds`, by the model of AttitudeFilter.
struct HeldPhone {
  ImuModel model;  // as believed
  AttitudePriors priors;
  ImuBias bias;
  std::vector<ImuSample> samples;

  HeldPhone(double seconds, uint64_t seed) {
    Random random(seed, 5);
    priors.gyro_bias = 0.03;
    priors.accel_bias = 0.1;
    priors.rotation = 0.02;
    priors.time_offset = 5e-3;
    bias = {Noise3(random, priors.gyro_bias), Noise3(random, priors.accel_bias)};
    const Matrix3d R_camera_imu = ExpSo3({0.1, 3.0, -0.3});
    model.T_camera_imu.R = R_camera_imu * ExpSo3(Noise3(random, -priors.rotation));
    model.time_offset = -priors.time_offset * random.Gaussian();  // the true one is 0
    const double noise = std::sqrt(kRate);
    const double pushes = priors.held_speed * std::sqrt(2 / priors.held_seconds) * noise;
    Vector3d velocity = Noise3(random, priors.held_speed), acceleration = Vector3d::Zero();
    const ImuNoise used = InUse(model.noise);
    for (double t = -0.5; t < seconds; t += 1 / kRate) {
      velocity += acceleration / kRate;
      acceleration = Noise3(random, pushes) - velocity / priors.held_seconds;
      const Matrix3d R = Look(t) * R_camera_imu;
      constexpr double kBeside = 1e-4;
      const Vector3d rate = LogSo3((Look(t - kBeside) * R_camera_imu).transpose() *
                                   Look(t + kBeside) * R_camera_imu) /
                            (2 * kBeside);
      samples.push_back({t, rate + bias.gyro + Noise3(random, used.gyro * noise),
                         R.transpose() * (acceleration + Vector3d(0, 0, kGravity)) + bias.accel +
                             Noise3(random, used.accel * noise)});
    }
  }
};

// Mean squared error over its covariance: 1 where that is right.
struct MeanSquare {
  double sum = 0;
  int count = 0;
  void Add(double squared, int dimensions) {
    sum += squared / dimensions;
    ++count;
  }
  double Mean() const { return sum / count; }
};

struct Scores {
  MeanSquare tilt, heading, gyro;
  double tilt_sigma = 0, heading_sigma = 0;
  void Add(const AttitudeFilter& filter, double time) {
    const Attitude camera = filter.Camera();
    const Vector3d error = LogSo3(Look(time) * camera.R_world_camera.transpose());
    const Eigen::Matrix2d tilt_covariance = camera.covariance.topLeftCorner<2, 2>();
    tilt.Add(error.head<2>().dot(tilt_covariance.llt().solve(error.head<2>())), 2);
    heading.Add(error.z() * error.z() / camera.covariance(2, 2), 1);
    tilt_sigma = camera.TiltSigma();
    heading_sigma = camera.HeadingSigma();
  }
};

// Looks about for 12 s at 10 images per second. `seeing`: rotations to views are measured, each of
// which serves while it is within 0.3 rad.
// Returns how many were refused.
int LookAbout(uint64_t seed, bool seeing, Scores& after_1, Scores& after_12) {
  const HeldPhone phone(12.5, seed);
  AttitudeFilter filter(phone.model, phone.priors, 0, phone.samples, Matrix3d::Identity());
  Random random(seed, 9);
  std::vector<Matrix3d> views;
  int refused = 0;
  for (int k = 0; k <= 120; ++k) {
    const double time = k / 10.0;
    filter.Advance(time, phone.samples);
    const Matrix3d R = Look(time);
    if (seeing) {
      int nearest = -1;
      double least = 0.3;
      for (size_t i = 0; i < views.size(); ++i) {
        const double angle = LogSo3(views[i].transpose() * R).norm();
        if (angle < least) nearest = static_cast<int>(i), least = angle;
      }
      if (nearest >= 0) {
        const Matrix3d seen = views[nearest].transpose() * R * ExpSo3(Noise3(random, kViewSigma));
        refused += !filter.See(nearest, seen, kViewSigma * kViewSigma * Matrix3d::Identity());
      } else {
        filter.AddView(static_cast<int>(views.size()), Matrix3d::Identity());
        views.push_back(R);
      }
    }
    if (k == 10) after_1.Add(filter, time);
    if (k == 120) after_12.Add(filter, time);
  }
  return refused;
}

TEST(AttitudeFilter, ErrorsAreAsLargeAsItSays) {
  for (const bool seeing : {true, false}) {
    Scores after_1, after_12;
    int refused = 0;
    for (int run = 0; run < 40; ++run) refused += LookAbout(500 + run, seeing, after_1, after_12);
    EXPECT_LT(refused, 48);  // 1 % of 4800: 0.1 % by the gate, the others while the tilt is unknown
    for (const Scores* each : {&after_1, &after_12}) {
      // Of 40 squares (of pairs): standard error 0.22 (0.16).
      EXPECT_NEAR(each->tilt.Mean(), 1, 0.6) << seeing;
      EXPECT_NEAR(each->heading.Mean(), 1, 0.7) << seeing;
    }
    if (seeing) {
      EXPECT_LT(after_12.heading_sigma, 0.0175);
    }
    EXPECT_LT(after_12.tilt_sigma, seeing ? 0.0175 : 0.052);
  }
}

// Of readings that end at 2 s, and of readings that lack 2 to 5 s.
TEST(AttitudeFilter, KnowsThatReadingsAreMissing) {
  const HeldPhone phone(6, 3);
  std::vector<ImuSample> ended, broken;
  for (const ImuSample& sample : phone.samples) {
    if (sample.time < 2) ended.push_back(sample);
    if (sample.time < 2 || sample.time > 5) broken.push_back(sample);
  }
  for (const auto* samples : {&ended, &broken}) {
    AttitudeFilter filter(phone.model, phone.priors, 0, *samples, Matrix3d::Identity());
    for (int k = 1; k <= 60; ++k) filter.Advance(k / 30.0, *samples);
    const double before = filter.Camera().HeadingSigma();
    for (int k = 61; k <= 150; ++k) filter.Advance(k / 30.0, *samples);
    const Attitude camera = filter.Camera();
    const double turned = LogSo3(Look(5) * camera.R_world_camera.transpose()).norm();
    EXPECT_GT(camera.HeadingSigma(), 10 * before);
    EXPECT_GT(3 * camera.HeadingSigma(), turned);
  }
}

}  // namespace
}  // namespace alidade
