// How long pose-only optimisation and bundle adjustment take, on generated problems: what `alidade
// bench ba` prints.
#pragma once

#include <cstddef>
#include <vector>

#include "alidade/base/timing.h"
#include "support/bundle_problem.h"
#include "support/pose_problem.h"

namespace alidade {

// Milliseconds of one OptimizePose, from a start as a motion model gives it (5 mm, 0.2 degrees
// off).
inline Summary TimePoseOnly(int matches, int repeats) {
  const PoseProblem problem =
      MakePoseProblem({.matches = matches, .stereo = 0.7, .outliers = 0.15, .seed = 3});
  Random random(5);
  const Se3 start = Se3::Exp(RandomIncrement(random, 0.005, 0.003)) * problem.truth;
  std::vector<double> samples;
  for (int i = 0; i < repeats; ++i) {
    const Stopwatch watch;
    const PoseOnlyResult result = OptimizePose(problem.camera, start, problem.matches);
    samples.push_back(watch.Milliseconds());
    if (result.inliers == 0) return {};  // never; keeps the call
  }
  return Summarise(samples);
}

// A local window of a tracker with many features: 20 keyframes adjusted, 20 held, 2500 points.
inline BundleProblem MakeLocalWindow(int max_track = 14) {
  return MakeBundleProblem({.fixed_cameras = 20,
                            .free_cameras = 20,
                            .points = 2500,
                            .min_track = 3,
                            .max_track = max_track,
                            .stereo = 1,
                            .outliers = 0.02,
                            .seed = 9});
}

// Milliseconds for each Levenberg–Marquardt step, all of AdjustBundle divided by its 10 steps.
inline Summary TimeBundleStep(const BundleProblem& problem, int repeats) {
  std::vector<double> samples;
  for (int i = 0; i < repeats; ++i) {
    BundleProblem copy = problem;
    const Stopwatch watch;
    const BundleReport report =
        AdjustBundle(copy, {.max_iterations = 10, .min_relative_decrease = 0});
    samples.push_back(watch.Milliseconds() / std::max(1, report.iterations));
  }
  return Summarise(samples);
}

}  // namespace alidade
