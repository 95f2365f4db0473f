#include "alidade/optimize/bundle_schur.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "problems/bundle_problem.h"

namespace alidade::bundle_schur_test {
namespace {

Eigen::Matrix3d Full(const Symmetric3& s) {
  return (Eigen::Matrix3d() << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]).finished();
}

// Full J'WJ and J'Wr: cameras by slot, then points.
void Assemble(const BundleLayout& layout, const Linearisation& system, Eigen::MatrixXd& H,
              Eigen::VectorXd& g) {
  const int cameras = static_cast<int>(layout.free_cameras.size());
  const int size = 6 * cameras + 3 * static_cast<int>(layout.points.size());
  H.setZero(size, size);
  g.setZero(size);
  for (int i = 0; i < cameras; ++i) {
    H.block<6, 6>(6 * i, 6 * i) = system.cameras[i].Hessian();
    g.segment<6>(6 * i) = system.cameras[i].Gradient();
  }
  for (size_t j = 0; j < layout.points.size(); ++j) {
    const BundlePoint& point = layout.points[j];
    const int at = 6 * cameras + 3 * static_cast<int>(j);
    H.block<3, 3>(at, at) = Full(system.points[j].H);
    g.segment<3>(at) = Eigen::Map<const Eigen::Vector3d>(system.points[j].g.data());
    for (int n = 0; n < point.free_end - point.begin; ++n) {
      const Coupling& c = system.couplings[point.coupling + n];
      Eigen::Matrix<double, 6, 3> mixed;
      mixed << Full(c.N), Skew(Eigen::Vector3d(c.Y.data())) * Full(c.N);
      H.block<6, 3>(6 * c.slot, at) += mixed;
      H.block<3, 6>(at, 6 * c.slot) += mixed.transpose();
    }
  }
}

TEST(SchurSolver, StepSolvesTheWholeDampedSystem) {
  for (const ReducedFactor kind : {ReducedFactor::kDense, ReducedFactor::kSparse}) {
    BundleProblem problem =
        MakeBundleProblem({.free_cameras = 6, .points = 80, .outliers = 0.1, .seed = 51});
    problem.observations.push_back(problem.observations[4]);  // observed twice
    const BundleLayout layout = LayOut(problem, {});
    BundleState state;
    for (const Se3& T : problem.T_camera_world) state.cameras.push_back({T.R, T.Inverse().t});
    for (const BundlePoint& p : layout.points) state.points.push_back(problem.points[p.index]);
    Linearisation system;
    Linearise(layout, nullptr, state, system);
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
    Assemble(layout, system, H, g);

    SchurSolver solver(layout, kind);
    BundleStep step;
    for (const double lambda : {1e-2, 1e-4}) {  // the second pass reuses the memory of the first
      solver.Solve(system, lambda, step);
      ASSERT_TRUE(step.valid);
      Eigen::MatrixXd damped = H;
      damped.diagonal() *= 1 + lambda;
      const Eigen::VectorXd expected = damped.ldlt().solve(-g);
      Eigen::VectorXd ours(expected.size());
      const int cameras = static_cast<int>(step.cameras.size());
      for (int i = 0; i < cameras; ++i) ours.segment<6>(6 * i) = step.cameras[i];
      for (size_t j = 0; j < step.points.size(); ++j) {
        ours.segment<3>(6 * cameras + 3 * j) = step.points[j];
      }
      EXPECT_LT((ours - expected).norm(), 1e-8 * expected.norm());
      const double predicted = -g.dot(expected) - 0.5 * expected.dot(H * expected);
      EXPECT_NEAR(step.predicted, predicted, 1e-8 * predicted);
    }
  }
}

TEST(SchurSolver, ChoosesSparseOnALongPathAndDenseInOneRoom) {
  BundleProblemOptions options{.free_cameras = 80, .points = 800, .max_track = 40, .seed = 52};
  EXPECT_FALSE(
      SchurSolver(LayOut(MakeBundleProblem(options), {}), ReducedFactor::kFastest).sparse());
  options.path_length = 80;
  options.max_track = 5;
  EXPECT_TRUE(
      SchurSolver(LayOut(MakeBundleProblem(options), {}), ReducedFactor::kFastest).sparse());
}

}  // namespace
}  // namespace alidade::bundle_schur_test
