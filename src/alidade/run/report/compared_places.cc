#include "alidade/run/report/compared_places.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"

namespace alidade {
namespace {

constexpr double kSameTruth = 1e-3;  // of the extent
constexpr double kSamePath = 0.05;
constexpr double kCommonTimes = 0.5;  // of the shorter trajectory's poses

// Root mean square distance from the mean position.
double ExtentOf(const Trajectory& trajectory) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : trajectory) mean += pose.T_world_camera.t;
  mean /= static_cast<double>(trajectory.size());
  double sum = 0;
  for (const StampedPose& pose : trajectory) sum += (pose.T_world_camera.t - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(trajectory.size()));
}

std::optional<AteResult> Aligned(const Trajectory& first, const Trajectory& other,
                                 Alignment align) {
  AteSettings settings;
  settings.align = align;
  try {
    return EvaluateAte(first, other, settings);
  } catch (const Error&) {  // no common times
    return std::nullopt;
  }
}

bool SameRecording(const ResultFolder& a, const ResultFolder& b) {
  return a.place.empty() || b.place.empty() ? !a.source.empty() && a.source == b.source
                                            : a.place == b.place;
}

class Placer {
 public:
  Placer(const std::vector<ResultFolder>& results,
         const std::vector<std::optional<TruthErrors>>& errors)
      : results_(results), errors_(errors) {}

  Sim3 OfFirst(size_t first) const {
    return errors_[first] ? errors_[first]->ate.T_truth_estimate : Sim3{};
  }

  // T_place_world of `run` in the place of `first`; nullopt: it is of another place.
  std::optional<Sim3> With(size_t first, size_t run) const {
    const ResultFolder &a = results_[first], &b = results_[run];
    const bool same = SameRecording(a, b);
    if (errors_[first] && errors_[run]) {
      if (!same && !SameTruth(a.truth, b.truth)) return std::nullopt;
      return errors_[run]->ate.T_truth_estimate;
    }
    const bool scaled = a.mono() || b.mono();
    const auto aligned =
        Aligned(a.trajectory, b.trajectory, scaled ? Alignment::kSim3 : Alignment::kSe3);
    if (!aligned) return std::nullopt;
    const size_t shorter = std::min(a.trajectory.size(), b.trajectory.size());
    const bool agree =
        static_cast<double>(aligned->pairs.size()) >= kCommonTimes * static_cast<double>(shorter) &&
        aligned->error.rmse <= kSamePath * ExtentOf(a.trajectory);
    if (!same && !agree) return std::nullopt;
    return OfFirst(first) * aligned->T_truth_estimate;
  }

 private:
  static bool SameTruth(const Trajectory& a, const Trajectory& b) {
    const auto compared = Aligned(a, b, Alignment::kNone);
    return compared && compared->error.rmse <= kSameTruth * ExtentOf(a);
  }

  const std::vector<ResultFolder>& results_;
  const std::vector<std::optional<TruthErrors>>& errors_;
};

}  // namespace

std::vector<PlacedRuns> PlacesOf(const std::vector<ResultFolder>& results,
                                 const std::vector<std::optional<TruthErrors>>& errors) {
  const Placer placer(results, errors);
  std::vector<PlacedRuns> places;
  for (size_t i = 0; i < results.size(); ++i) {
    if (results[i].trajectory.empty()) continue;
    std::optional<Sim3> T;
    for (PlacedRuns& place : places) {
      T = placer.With(place.runs.front(), i);
      if (!T) continue;
      place.runs.push_back(i);
      place.T_place_world.push_back(*T);
      break;
    }
    if (!T) places.push_back({{i}, {placer.OfFirst(i)}});
  }
  return places;
}

}  // namespace alidade
