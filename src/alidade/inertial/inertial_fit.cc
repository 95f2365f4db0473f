#include "alidade/inertial/inertial_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/inertial/chain_system.h"
#include "alidade/inertial/rotation_match.h"

namespace alidade {
namespace {

// Order of a state's increment: (rotation; velocity; position; gyro bias; accel bias).
constexpr int kState = ChainSystem::kState, kCommon = ChainSystem::kCommon;
// Order of the common parameters' increment. That of the scale is relative, and positions and
// velocities of all states grow with it: positions are known well in map units, so that the
// increments are nearly independent and the residuals linear in the scale.
constexpr int kScale = 0, kTilt = 1, kTurn = 3, kArm = 6, kOffset = 9;
constexpr int kMostIterations = 15;
constexpr double kLeastGrowth = 0.02;  // factor of the scale in one step

// Two unit vectors perpendicular to `direction`, as columns.
Eigen::Matrix<double, 3, 2> TangentsOf(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d a = direction.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> B;
  B << a, direction.cross(a);
  return B;
}

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
        model_(model),
        given_(model),
        noise_(InUse(model.noise)),
        priors_(priors) {}

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
      model_ = start->model;
      scale_ = start->scale;
      down_ = start->gravity.normalized();
      bias = start->states.back().bias;
    } else {
      const RotationMatch match = MatchRotations(poses_, samples_, model_);
      if (!match.ok) return false;
      model_.T_camera_imu.R = match.R_camera_imu;
      model_.time_offset = match.time_offset;
      bias.gyro = match.gyro_bias;
      // At rest the specific force points up; over some seconds the mean acceleration is small.
      Eigen::Vector3d force = Eigen::Vector3d::Zero();
      for (const TimedPose& pose : poses_) {
        force += pose.T_world_camera.R * model_.T_camera_imu.R *
                 ReadingAt(samples_, pose.time + model_.time_offset).specific_force;
      }
      if (force.norm() == 0) return false;
      down_ = -force.normalized();
    }
    for (const TimedPose& pose : poses_) {
      InertialState state;
      Se3 T_world_camera = pose.T_world_camera;
      T_world_camera.t *= scale_;
      state.T_world_imu = T_world_camera * model_.T_camera_imu;
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
    const Se3 T_world_camera = state.T_world_imu * model_.T_camera_imu.Inverse();
    const Eigen::Matrix3d Rm_t = pose.T_world_camera.R.transpose();
    const Eigen::Matrix3d& R = T_world_camera.R;
    const Eigen::Matrix3d& R_ci = model_.T_camera_imu.R;
    const Eigen::Vector3d rate =
        ReadingAt(samples_, pose.time + model_.time_offset).angular_rate - state.bias.gyro;
    Vector6d r;  // (translation; rotation)
    // In map units, in which the poses are measured.
    r.head<3>() = Rm_t * (T_world_camera.t / scale_ - pose.T_world_camera.t);
    r.tail<3>() = LogSo3(Rm_t * R);
    const Eigen::Matrix3d by_turn = InverseRightJacobian(r.tail<3>()) * R_ci;
    const Eigen::Matrix3d way_by_turn = Rm_t * R * Skew(model_.T_camera_imu.t) * R_ci / scale_;
    Eigen::Matrix<double, 6, kState> by_state = Eigen::Matrix<double, 6, kState>::Zero();
    by_state.block<3, 3>(0, 0) = way_by_turn;
    by_state.block<3, 3>(0, 6) = Rm_t / scale_;
    by_state.block<3, 3>(3, 0) = by_turn;
    Eigen::Matrix<double, 6, kCommon> by_common = Eigen::Matrix<double, 6, kCommon>::Zero();
    by_common.block<3, 1>(0, kScale) = Rm_t * (state.T_world_imu.t - T_world_camera.t) / scale_;
    by_common.block<3, 3>(0, kTurn) = -way_by_turn;
    by_common.block<3, 3>(3, kTurn) = -by_turn;
    by_common.block<3, 3>(0, kArm) = -Rm_t * R / scale_;
    by_common.block<3, 1>(0, kOffset) = Rm_t * state.velocity / scale_ + way_by_turn * rate;
    by_common.block<3, 1>(3, kOffset) = by_turn * rate;
    const Matrix6d W = Whitening<6>(pose.covariance);
    system.Add<6>(static_cast<int>(k), W * r, W * by_state, nullptr, W * by_common);
  }

  static Vector9d MovedByScale(const Matrix9d& by_state, const InertialState& state) {
    return by_state.middleCols<3>(3) * state.velocity +
           by_state.rightCols<3>() * state.T_world_imu.t;
  }

  void AddMotion(size_t k, ChainSystem& system) const {
    const InertialState &i = states_[k], &j = states_[k + 1];
    const double offset = model_.time_offset;
    const Preintegration motion = Preintegrate(samples_, poses_[k].time + offset,
                                               poses_[k + 1].time + offset, i.bias, noise_);
    const MotionResidual residual = ResidualOf(i, j, motion, kGravity * down_);
    const Matrix9d W = Whitening<9>(motion.covariance);
    Eigen::Matrix<double, 9, kState> by_state, by_next = Eigen::Matrix<double, 9, kState>::Zero();
    by_state << residual.by_i, residual.by_bias;
    by_next.leftCols<9>() = residual.by_j;
    Eigen::Matrix<double, 9, kCommon> by_common = Eigen::Matrix<double, 9, kCommon>::Zero();
    by_common.col(kScale) = MovedByScale(residual.by_i, i) + MovedByScale(residual.by_j, j);
    by_common.middleCols<2>(kTilt) =
        residual.by_gravity * (-kGravity * Skew(down_)) * TangentsOf(down_);
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
    bias << first.bias.gyro, first.bias.accel;
    inverse_sigma << Eigen::Vector3d::Constant(1 / priors_.gyro_bias),
        Eigen::Vector3d::Constant(1 / priors_.accel_bias);
    Eigen::Matrix<double, 6, kState> by_state = Eigen::Matrix<double, 6, kState>::Zero();
    by_state.rightCols<6>() = inverse_sigma.asDiagonal();
    system.Add<6>(0, inverse_sigma.cwiseProduct(bias), by_state, nullptr,
                  Eigen::Matrix<double, 6, kCommon>::Zero());
    const auto weight = [](double sigma) { return 1 / (sigma * sigma); };
    // Without a prior: one that keeps the matrix regular.
    system.AddCommon(kScale, priors_.scale > 0 ? std::log(scale_) : 0,
                     priors_.scale > 0 ? weight(priors_.scale) : 1e-12);
    for (int k = 0; k < 2; ++k) system.AddCommon(kTilt + k, 0, 1e-9);
    const Eigen::Vector3d turn = LogSo3(given_.T_camera_imu.R.transpose() * model_.T_camera_imu.R);
    const Eigen::Vector3d arm = model_.T_camera_imu.t - given_.T_camera_imu.t;
    for (int k = 0; k < 3; ++k) {
      system.AddCommon(kTurn + k, given_.rotation_known ? turn[k] : 0,
                       given_.rotation_known ? weight(priors_.rotation_known) : 1e-6);
      system.AddCommon(
          kArm + k, arm[k],
          weight(given_.translation_known ? priors_.translation_known : priors_.translation));
    }
    system.AddCommon(
        kOffset, model_.time_offset - given_.time_offset,
        weight(given_.time_offset_known ? priors_.time_offset_known : priors_.time_offset));
  }

  // False: the step leads outside what can be.
  bool Apply(const ChainSystem::Solution& step) {
    const double growth = 1 + step.common(kScale);
    if (!step.common.allFinite() || !(growth > kLeastGrowth)) return false;
    scale_ *= growth;
    // The tilt is a rotation vector perpendicular to the direction.
    const Eigen::Vector3d tilt = TangentsOf(down_) * step.common.segment<2>(kTilt);
    model_.T_camera_imu.R = model_.T_camera_imu.R * ExpSo3(step.common.segment<3>(kTurn));
    model_.T_camera_imu.t += step.common.segment<3>(kArm);
    const double later = step.common(kOffset);
    for (size_t k = 0; k < states_.size(); ++k) {
      InertialState& state = states_[k];
      const auto& d = step.states[k];
      state.T_world_imu.R = state.T_world_imu.R * ExpSo3(d.head<3>());
      state.velocity = growth * state.velocity + d.segment<3>(3);
      state.T_world_imu.t = growth * state.T_world_imu.t + d.segment<3>(6);
      state.bias.gyro += d.segment<3>(9);
      state.bias.accel += d.segment<3>(12);
      // The state is now that of a later time.
      const ImuSample reading = ReadingAt(samples_, poses_[k].time + model_.time_offset);
      const Eigen::Matrix3d R = state.T_world_imu.R;
      state.T_world_imu.R = R * ExpSo3(later * (reading.angular_rate - state.bias.gyro));
      state.T_world_imu.t += later * state.velocity;
      state.velocity +=
          later * (kGravity * down_ + R * (reading.specific_force - state.bias.accel));
    }
    model_.time_offset += later;
    down_ = ExpSo3(tilt) * down_;
    return true;
  }

  // `system`: of the present state; it is destroyed.
  InertialFit ResultOf(ChainSystem& system) const {
    // States are determined by as many residuals as they have parameters.
    const int spare = system.residuals() - kState * static_cast<int>(states_.size()) - kCommon;
    InertialFit fit;
    fit.noise_factor = std::sqrt(system.cost() / std::max(1, spare));
    const ChainSystem::Solution solution = system.Solve(0);
    if (!solution.ok) return {};
    const ChainSystem::CommonMatrix covariance =
        solution.common_covariance * std::max(1.0, fit.noise_factor * fit.noise_factor);
    const auto largest = [&](int at, int size) {
      const Eigen::MatrixXd block = covariance.block(at, at, size, size);
      const double value =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(block).eigenvalues().maxCoeff();
      return std::sqrt(std::max(0.0, value));
    };
    fit.solved = true;
    fit.scale = scale_;
    fit.scale_sigma = largest(kScale, 1);
    fit.gravity = kGravity * down_;
    fit.gravity_sigma = largest(kTilt, 2);
    fit.states = states_;
    fit.model = model_;
    fit.rotation_sigma = largest(kTurn, 3);
    fit.translation_sigma = largest(kArm, 3);
    fit.time_offset_sigma = largest(kOffset, 1);
    return fit;
  }

  std::span<const TimedPose> poses_;
  std::span<const ImuSample> samples_;
  ImuModel model_, given_;
  ImuNoise noise_;
  InertialPriors priors_;
  std::vector<InertialState> states_;
  double scale_ = 1;
  Eigen::Vector3d down_ = Eigen::Vector3d::UnitZ();
};

}  // namespace

void InertialPriors::Check() const {
  if (!(scale >= 0)) ThrowUsage("imu: the prior of the scale must not be negative");
  for (const double sigma : {gyro_bias, accel_bias, rotation_known, translation_known, translation,
                             time_offset_known, time_offset}) {
    if (!(sigma > 0)) ThrowUsage("imu: standard deviations of priors must be above 0");
  }
}

InertialFit FitInertial(std::span<const TimedPose> poses, std::span<const ImuSample> samples,
                        const ImuModel& model, const InertialPriors& priors,
                        const InertialFit* start) {
  priors.Check();
  return Fit(poses, samples, model, priors).Run(start);
}

}  // namespace alidade
