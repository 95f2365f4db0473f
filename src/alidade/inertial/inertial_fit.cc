#include "alidade/inertial/inertial_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/inertial/chain_system.h"
#include "alidade/inertial/largest_sigma.h"
#include "alidade/inertial/pose_measurement.h"
#include "alidade/inertial/rotation_match.h"

namespace alidade {
namespace {

constexpr int kState = ChainSystem::kState, kCommon = ChainSystem::kCommon;
constexpr int kMostIterations = 15;
constexpr double kLeastGrowth = 0.02;  // factor of the scale in one step

// U with Uᵀ U = covariance⁻¹, so that |U r|² = rᵀ covariance⁻¹ r.
template <int N>
Eigen::Matrix<double, N, N> Whitening(const Eigen::Matrix<double, N, N>& covariance) {
  const Eigen::Matrix<double, N, N> information =
      covariance.llt().solve(Eigen::Matrix<double, N, N>::Identity());
  return information.llt().matrixU();
}

class Fit {
 public:
  Fit(std::span<const TimedPose> poses, std::span<const ImuSample> samples, const ImuModel& model,
      const InertialPriors& priors)
      : poses_(poses),
        samples_(samples),
        given_(model),
        noise_(InUse(model.noise)),
        priors_(priors) {
    common_.model = model;
  }

  InertialFit Run(const InertialFit* start) {
    if (!Begin(start)) return {};
    ChainSystem system = Build();
    return Minimize(system) ? ResultOf(system) : InertialFit{};
  }

 private:
  // Levenberg–Marquardt; `system` is that of the present state. False if no step is possible.
  bool Minimize(ChainSystem& system) {
    double damping = 1e-8;
    for (int i = 0; i < kMostIterations; ++i) {
      const double last = system.cost();
      const Fit before = *this;
      const ChainSystem::Solution step = ChainSystem(system).Solve(damping);
      const bool possible = step.ok && Apply(step);
      ChainSystem next = possible ? Build() : ChainSystem(0);
      if (!possible || !(next.cost() <= last * (1 + 1e-9))) {
        *this = before;
        damping *= 30;
        if (damping > 1e3) return i > 0;
        continue;
      }
      system = std::move(next);
      damping = std::max(1e-9, damping / 30);
      if (last - system.cost() < 1e-5 * (1 + system.cost())) break;
    }
    return std::isfinite(system.cost());
  }

  bool Begin(const InertialFit* start) {
    if (poses_.size() < 3 || samples_.size() < 10) return false;
    ImuBias bias;
    if (start && start->solved) {
      common_.model = start->model;
      common_.scale = start->scale;
      common_.down = start->gravity.normalized();
      bias = start->states.back().bias;
    } else {
      const RotationMatch match = MatchRotations(poses_, samples_, common_.model);
      if (!match.ok) return false;
      common_.model.T_camera_imu.R = match.R_camera_imu;
      common_.model.time_offset = match.time_offset;
      bias.gyro = match.gyro_bias;
      bias.accel = priors_.bias.accel;
      // At rest the specific force points up; over some seconds the mean acceleration is small.
      Eigen::Vector3d force = Eigen::Vector3d::Zero();
      for (const TimedPose& pose : poses_) {
        force += pose.T_world_camera.R * common_.model.T_camera_imu.R *
                 ReadingAt(samples_, pose.time + common_.model.time_offset).specific_force;
      }
      if (force.norm() == 0) return false;
      common_.down = -force.normalized();
    }
    for (const TimedPose& pose : poses_) {
      InertialState state;
      Se3 T_world_camera = pose.T_world_camera;
      T_world_camera.t *= common_.scale;
      state.T_world_imu = T_world_camera * common_.model.T_camera_imu;
      state.bias = bias;
      states_.push_back(state);
    }
    for (size_t k = 0; k < states_.size(); ++k) {
      const size_t a = k > 0 ? k - 1 : k, b = std::min(k + 1, states_.size() - 1);
      states_[k].velocity =
          (states_[b].T_world_imu.t - states_[a].T_world_imu.t) / (poses_[b].time - poses_[a].time);
    }
    return true;
  }

  ChainSystem Build() const {
    ChainSystem system(static_cast<int>(states_.size()));
    for (size_t k = 0; k < states_.size(); ++k) {
      AddPose(k, system);
      if (k + 1 < states_.size()) AddMotion(k, system);
    }
    AddPriors(system);
    return system;
  }

  // The camera's pose: T_world_imu T_camera_imu⁻¹, moved by an error of the clock's offset.
  void AddPose(size_t k, ChainSystem& system) const {
    const TimedPose& pose = poses_[k];
    const InertialState& state = states_[k];
    const Eigen::Vector3d rate =
        ReadingAt(samples_, pose.time + common_.model.time_offset).angular_rate;
    const PoseMeasurement m = MeasurementOf(state, common_, pose.T_world_camera, rate);
    const Matrix6d W = Whitening<6>(pose.covariance);
    system.Add<6>(static_cast<int>(k), W * m.error, W * m.by_state, nullptr, W * m.by_common);
  }

  static Vector9d MovedByScale(const Matrix9d& by_state, const InertialState& state) {
    return by_state.middleCols<3>(3) * state.velocity +
           by_state.rightCols<3>() * state.T_world_imu.t;
  }

  void AddMotion(size_t k, ChainSystem& system) const {
    const InertialState &i = states_[k], &j = states_[k + 1];
    const double offset = common_.model.time_offset;
    const Preintegration motion = Preintegrate(samples_, poses_[k].time + offset,
                                               poses_[k + 1].time + offset, i.bias, noise_);
    const MotionResidual residual = ResidualOf(i, j, motion, kGravity * common_.down);
    const Matrix9d W = Whitening<9>(motion.covariance);
    Eigen::Matrix<double, 9, kState> by_state, by_next = Eigen::Matrix<double, 9, kState>::Zero();
    by_state << residual.by_i, residual.by_bias;
    by_next.leftCols<9>() = residual.by_j;
    Eigen::Matrix<double, 9, kCommon> by_common = Eigen::Matrix<double, 9, kCommon>::Zero();
    by_common.col(kScale) = MovedByScale(residual.by_i, i) + MovedByScale(residual.by_j, j);
    by_common.middleCols<2>(kTilt) =
        residual.by_gravity * (-kGravity * Skew(common_.down)) * TangentsOf(common_.down);
    const Eigen::Matrix<double, 9, kState> weighted_next = W * by_next;
    system.Add<9>(static_cast<int>(k), W * residual.error, W * by_state, &weighted_next,
                  W * by_common);

    const double root = std::sqrt(motion.seconds);
    Vector6d walk, inverse_sigma;
    walk << j.bias.gyro - i.bias.gyro, j.bias.accel - i.bias.accel;
    inverse_sigma << Eigen::Vector3d::Constant(1 / (noise_.gyro_walk * root)),
        Eigen::Vector3d::Constant(1 / (noise_.accel_walk * root));
    Eigen::Matrix<double, 6, kState> by_i = Eigen::Matrix<double, 6, kState>::Zero();
    by_i.rightCols<6>() = (-inverse_sigma).asDiagonal();
    const Eigen::Matrix<double, 6, kState> by_j = -by_i;
    system.Add<6>(static_cast<int>(k), inverse_sigma.cwiseProduct(walk), by_i, &by_j,
                  Eigen::Matrix<double, 6, kCommon>::Zero());
  }

  void AddPriors(ChainSystem& system) const {
    const InertialState& first = states_.front();
    Vector6d bias, inverse_sigma;
    bias << first.bias.gyro - priors_.bias.gyro, first.bias.accel - priors_.bias.accel;
    inverse_sigma << Eigen::Vector3d::Constant(1 / priors_.gyro_bias),
        Eigen::Vector3d::Constant(1 / priors_.accel_bias);
    Eigen::Matrix<double, 6, kState> by_state = Eigen::Matrix<double, 6, kState>::Zero();
    by_state.rightCols<6>() = inverse_sigma.asDiagonal();
    system.Add<6>(0, inverse_sigma.cwiseProduct(bias), by_state, nullptr,
                  Eigen::Matrix<double, 6, kCommon>::Zero());
    const auto weight = [](double sigma) { return 1 / (sigma * sigma); };
    // Without a prior: one that keeps the matrix regular.
    system.AddCommon(kScale, priors_.scale > 0 ? std::log(common_.scale) : 0,
                     priors_.scale > 0 ? weight(priors_.scale) : 1e-12);
    for (int k = 0; k < 2; ++k) system.AddCommon(kTilt + k, 0, 1e-9);
    const Eigen::Vector3d turn =
        LogSo3(given_.T_camera_imu.R.transpose() * common_.model.T_camera_imu.R);
    const Eigen::Vector3d arm = common_.model.T_camera_imu.t - given_.T_camera_imu.t;
    for (int k = 0; k < 3; ++k) {
      system.AddCommon(kTurn + k, given_.rotation_known ? turn[k] : 0,
                       given_.rotation_known ? weight(priors_.rotation_known) : 1e-6);
      system.AddCommon(
          kArm + k, arm[k],
          weight(given_.translation_known ? priors_.translation_known : priors_.translation));
    }
    system.AddCommon(
        kOffset, common_.model.time_offset - given_.time_offset,
        weight(given_.time_offset_known ? priors_.time_offset_known : priors_.time_offset));
  }

  // False: the step leads outside what can be.
  bool Apply(const ChainSystem::Solution& step) {
    const double growth = 1 + step.common(kScale);
    if (!step.common.allFinite() || !(growth > kLeastGrowth)) return false;
    for (size_t k = 0; k < states_.size(); ++k) {
      const ImuSample reading = ReadingAt(samples_, poses_[k].time + common_.model.time_offset);
      Increase(states_[k], step.states[k], step.common, common_, reading);
    }
    common_.Increase(step.common);
    return true;
  }

  // `system`: of the present state; it is destroyed.
  InertialFit ResultOf(ChainSystem& system) const {
    // States are determined by as many residuals as they have parameters.
    const int spare = system.residuals() - kState * static_cast<int>(states_.size()) - kCommon;
    InertialFit fit;
    fit.noise_factor = std::sqrt(system.cost() / std::max(1, spare));
    ChainSystem reversed = system.Reversed();
    const ChainSystem::Solution solution = system.Solve(0);
    const ChainSystem::Solution backwards = reversed.Solve(0);
    if (!solution.ok || !backwards.ok) return {};
    const double more = std::max(1.0, fit.noise_factor * fit.noise_factor);
    const MotionBelief::Matrix joint = more * solution.last_covariance;
    const ChainSystem::CommonMatrix covariance = joint.bottomRightCorner<kCommon, kCommon>();
    const auto largest = [&](int at, int size) {
      Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
      block.topLeftCorner(size, size) = covariance.block(at, at, size, size);
      return LargestSigma(block);
    };
    fit.solved = true;
    fit.scale = common_.scale;
    fit.scale_sigma = largest(kScale, 1);
    fit.gravity = kGravity * common_.down;
    fit.gravity_sigma = largest(kTilt, 2);
    fit.states = states_;
    fit.model = common_.model;
    fit.rotation_sigma = largest(kTurn, 3);
    fit.translation_sigma = largest(kArm, 3);
    fit.time_offset_sigma = largest(kOffset, 1);
    fit.gyro_bias_sigma = std::sqrt(joint.diagonal().segment<3>(9).maxCoeff());
    fit.accel_bias_sigma = std::sqrt(joint.diagonal().segment<3>(12).maxCoeff());
    fit.first = {poses_.front().time, states_.front(), common_, more * backwards.last_covariance};
    fit.last = {poses_.back().time, states_.back(), common_, joint};
    return fit;
  }

  std::span<const TimedPose> poses_;
  std::span<const ImuSample> samples_;
  ImuModel given_;
  CommonParameters common_;
  ImuNoise noise_;
  InertialPriors priors_;
  std::vector<InertialState> states_;
};

}  // namespace

void InertialPriors::Check() const {
  if (!(scale >= 0)) ThrowUsage("imu: the prior of the scale must not be negative");
  for (const double sigma : {gyro_bias, accel_bias, rotation_known, translation_known, translation,
                             time_offset_known, time_offset}) {
    if (!(sigma > 0)) ThrowUsage("imu: standard deviations of priors must be above 0");
  }
}

Matrix6d CommonErrors(double distance) {
  constexpr double kPosition = 1.5e-3, kRotation = 7e-4;
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kPosition * distance), Eigen::Vector3d::Constant(kRotation);
  return sigma.cwiseAbs2().asDiagonal();
}

InertialFit FitInertial(std::span<const TimedPose> poses, std::span<const ImuSample> samples,
                        const ImuModel& model, const InertialPriors& priors,
                        const InertialFit* start) {
  priors.Check();
  return Fit(poses, samples, model, priors).Run(start);
}

}  // namespace alidade
