// Loss functions of bundle adjustment for Ceres.
#pragma once

#include <ceres/loss_function.h>

#include <memory>

namespace alidade {

// As a function of s = r²: ρ = s / (1 + s / c²).
class GemanMcClureLoss final : public ceres::LossFunction {
 public:
  explicit GemanMcClureLoss(double c) : c2_(c * c) {}
  void Evaluate(double s, double rho[3]) const override {
    const double q = 1 / (1 + s / c2_);
    rho[0] = s * q;
    rho[1] = q * q;
    rho[2] = -2 * q * q * q / c2_;
  }

 private:
  double c2_;
};

inline std::unique_ptr<ceres::LossFunction> CeresLoss(double bound, bool redescending) {
  if (redescending) return std::make_unique<GemanMcClureLoss>(bound);
  return std::make_unique<ceres::HuberLoss>(bound);
}

}  // namespace alidade
