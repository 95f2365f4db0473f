// What a pose moves when parts of the image are left out.
#include "alidade/localize/part_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "alidade/map/map_store.h"
#include "alidade/optimize/pose_only.h"
#include "problems/pose_problem.h"

namespace alidade::part_errors_test {
namespace {

// Landmarks 1.5 to 5 m away; or a wall 4 m before the camera, which tells a step to the side and a
// turn apart badly, and ten landmarks 1.5 m away in one corner of the image, which would tell them
// well.
struct Picture {
  MapStore store;
  Camera camera = MakeProblemCamera();
  MeasurementNoise noise;
  PlacedFrame placed;

  // `wrong`: pixels by which the landmarks in the corner are found beside where they are.
  Picture(bool wall, double wrong, uint64_t seed) {
    camera.baseline = 0;
    Random random(seed);
    auto frame = std::make_shared<Frame>();
    const auto add = [&](MapCommit& commit, KeyFrameId keyframe, double u, double v, double z,
                         double off) {
      Landmark landmark;
      landmark.p_world = camera.Unproject({u, v}, z);
      landmark.reference = landmark.born = keyframe;
      landmark.observations = {{keyframe, static_cast<int>(frame->keypoints.size())}};
      Keypoint keypoint;
      keypoint.x = static_cast<float>(u + off + noise.sigma_px * random.Gaussian());
      keypoint.y = static_cast<float>(v + noise.sigma_px * random.Gaussian());
      frame->keypoints.push_back(keypoint);
      frame->descriptors.emplace_back();
      placed.matches.push_back(commit.Add(std::move(landmark)));
    };
    store.Commit([&](MapCommit& commit) {
      KeyFrame keyframe;
      auto shown = std::make_shared<Frame>();
      shown->keypoints.resize(140);
      shown->descriptors.resize(140);
      keyframe.frame = shown;
      const KeyFrameId id = commit.Add(std::move(keyframe));
      for (int i = 0; i < 130; ++i) {
        const double u = 640 * random.Uniform(), v = 480 * random.Uniform();
        const double z = wall ? 4 : 1.5 + 3.5 * random.Uniform();
        add(commit, id, u, v, z, 0);
      }
      for (int i = 0; i < 10; ++i) {
        const double u = 60 + 60 * random.Uniform(), v = 380 + 60 * random.Uniform();
        add(commit, id, u, v, wall ? 1.5 : 3, wrong);
      }
    });
    placed.frame = frame;
    std::vector<PoseMatch> matches;
    const MapSnapshot map = store.Snapshot();
    for (size_t i = 0; i < placed.matches.size(); ++i) {
      const Measurement m = Measure(frame->keypoints[i], noise);
      matches.push_back({map.Find(placed.matches[i])->p_world, m.pixel, m.inv_sigma2, 1, 1});
    }
    const PoseOnlyResult result = OptimizePose(camera, {}, matches);
    placed.T_camera_world = result.T_camera_world;
    placed.covariance = result.covariance;
    for (size_t i = 0; i < placed.matches.size(); ++i) {
      if (!result.inlier[i]) placed.matches[i] = {};
    }
  }
  Matrix6d Errors() { return PartErrors(placed, camera, store.Snapshot(), noise); }
  // Of the pose, in standard deviations: root mean square of the six numbers.
  double Error(const Matrix6d& covariance) const {
    const Vector6d xi = placed.T_camera_world.Log();  // the truth is the identity
    return std::sqrt(xi.dot(covariance.ldlt().solve(xi)) / 6);
  }
};

// Root mean square over seeds.
template <typename F>
double OverSeeds(F&& f) {
  constexpr int kSeeds = 60;
  double sum = 0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) sum += std::pow(f(seed), 2);
  return std::sqrt(sum / kSeeds);
}

TEST(PartErrors, AreThoseOfTheNoiseWhereAllMatchesAreRight) {
  Vector6d by_parts = Vector6d::Zero(), by_noise = Vector6d::Zero();
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Picture picture(false, 0, seed);
    by_parts += picture.Errors().diagonal();
    by_noise += picture.placed.covariance.diagonal();
  }
  const Vector6d ratio = by_parts.cwiseQuotient(by_noise);
  EXPECT_GT(ratio.minCoeff(), 0.6) << ratio.transpose();
  EXPECT_LT(ratio.maxCoeff(), 2) << ratio.transpose();
}

TEST(PartErrors, TellThatAFewNearMatchesHoldThePose) {
  const auto by_noise = [](uint64_t seed) {
    const Picture picture(true, 2, seed);
    return picture.Error(picture.placed.covariance);
  };
  const auto by_parts = [](uint64_t seed) {
    Picture picture(true, 2, seed);
    return picture.Error(picture.placed.covariance + picture.Errors());
  };
  EXPECT_GT(OverSeeds(by_noise), 3);
  EXPECT_LT(OverSeeds(by_parts), 2.5);
}

TEST(PartErrors, AreZeroWithoutMatches) {
  Picture picture(false, 0, 1);
  picture.placed.matches.assign(picture.placed.matches.size(), {});
  EXPECT_EQ(picture.Errors(), Matrix6d(Matrix6d::Zero()));
}

}  // namespace
}  // namespace alidade::part_errors_test
