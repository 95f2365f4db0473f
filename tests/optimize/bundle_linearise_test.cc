#include "alidade/optimize/bundle_linearise.h"

#include <gtest/gtest.h>

#include "ceres_loss.h"
#include "ceres_reprojection.h"
#include "problems/bundle_problem.h"

namespace alidade::bundle_linearise_test {
namespace {

// (ρ, θ) of the camera, then the point, as in bundle_linearise.h.
using Jet = ceres::Jet<double, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

// J'WJ and J'Wr, with W the loss's weight, by automatic derivatives of p = R Exp(θ) (X - c + ρ).
void ByJets(const BundleCamera& camera, const Eigen::Vector3d& X, const Camera& intrinsics,
            const BundleObservation& o, const ceres::LossFunction& loss, Matrix9d& H, Vector9d& g) {
  const bool stereo = std::isfinite(o.pixel.z());
  Jet turn[3], moved[3], turned[3], pose[6], p[3], residual[3];
  for (int i = 0; i < 3; ++i) {
    turn[i] = Jet(0, 3 + i);
    moved[i] = Jet(X[i], 6 + i) - camera.centre[i] + Jet(0, i);
  }
  ceres::AngleAxisRotatePoint(turn, moved, turned);
  for (int i = 0; i < 3; ++i) {
    p[i] = camera.R(i, 0) * turned[0] + camera.R(i, 1) * turned[1] + camera.R(i, 2) * turned[2];
    pose[i] = pose[3 + i] = Jet(0);
  }
  if (stereo) {
    CeresReprojection<true>{intrinsics, o.pixel, o.inv_sigma2, o.inv_sigma2_right}(pose, p,
                                                                                   residual);
  } else {
    CeresReprojection<false>{intrinsics, o.pixel, o.inv_sigma2, o.inv_sigma2_right}(pose, p,
                                                                                    residual);
  }
  double chi2 = 0;
  const int rows = stereo ? 3 : 2;
  for (int i = 0; i < rows; ++i) chi2 += residual[i].a * residual[i].a;
  double rho[3];
  loss.Evaluate(chi2, rho);
  rho[1] *= o.trust;
  H.setZero();
  g.setZero();
  for (int i = 0; i < rows; ++i) {
    H += rho[1] * residual[i].v * residual[i].v.transpose();
    g += rho[1] * residual[i].a * residual[i].v;
  }
}

Eigen::Matrix3d Full(const Symmetric3& s) {
  return (Eigen::Matrix3d() << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]).finished();
}

class LineariseBundle : public testing::TestWithParam<bool> {};  // redescending?
INSTANTIATE_TEST_SUITE_P(Losses, LineariseBundle, testing::Bool());

TEST_P(LineariseBundle, AgreesWithAutomaticDerivatives) {
  for (const double outliers : {0.0, 0.5}) {
    BundleProblem problem = MakeBundleProblem({.points = 30, .outliers = outliers, .seed = 41});
    BundleSettings settings;
    settings.redescending = GetParam();
    for (BundleObservation& o : problem.observations) {
      o.trust = 0.2 * (1 + o.camera % 5);
      // One camera, one point, one sighting: the sums consist of its terms only.
      BundleProblem one;
      one.camera = problem.camera;
      one.T_camera_world = {problem.T_camera_world[o.camera]};
      one.fixed = {0};
      one.points = {problem.points[o.point]};
      one.observations = {o};
      one.observations[0].camera = one.observations[0].point = 0;
      const BundleLayout layout = LayOut(one, settings);
      const Se3& T = one.T_camera_world[0];
      BundleState state{{{T.R, T.Inverse().t}}, one.points};
      Linearisation system;
      Linearise(layout, nullptr, state, system);

      Matrix9d H;
      Vector9d g;
      const bool stereo = std::isfinite(o.pixel.z());
      const double bound = stereo ? settings.huber_stereo : settings.huber_mono;
      ByJets(state.cameras[0], one.points[0], one.camera, o,
             *CeresLoss(bound, settings.redescending), H, g);

      const CameraBlock& c = system.cameras[0];
      Matrix9d ours;
      Vector9d our_g;
      const Eigen::Matrix3d N = Full(system.couplings[0].N);
      const Eigen::Vector3d Y(system.couplings[0].Y.data());
      Eigen::Matrix<double, 6, 3> mixed;
      mixed << N, Skew(Y) * N;
      ours << c.Hessian(), mixed, mixed.transpose(), Full(system.points[0].H);
      our_g << c.Gradient(), Eigen::Map<const Eigen::Vector3d>(system.points[0].g.data());
      EXPECT_LT((ours - H).norm(), 1e-10 * H.norm());
      EXPECT_LT((our_g - g).norm(), 1e-10 * std::max(1.0, g.norm()));
    }
  }
}

}  // namespace
}  // namespace alidade::bundle_linearise_test
