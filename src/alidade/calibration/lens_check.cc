#include "alidade/calibration/lens_check.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/id_map.h"
#include "alidade/base/median.h"
#include "alidade/base/settings_table.h"
#include "alidade/calibration/lens_bend.h"

namespace alidade {
namespace {

BundleProblem ProblemOf(const MapSnapshot& map, std::span<const KeyFrameId> keyframes,
                        const Camera& camera, const MeasurementNoise& noise, int min_seen) {
  BundleProblem problem;
  problem.camera = camera;
  IdMap<KeyFrameId, int> index;
  std::vector<LandmarkId> landmarks;
  for (KeyFrameId id : keyframes) {
    index[id] = static_cast<int>(problem.T_camera_world.size());
    const KeyFrame& keyframe = *map.Find(id);
    problem.T_camera_world.push_back(keyframe.T_camera_world);
    for (LandmarkId landmark : keyframe.landmarks) {
      if (landmark.valid()) landmarks.push_back(landmark);
    }
  }
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());
  for (LandmarkId id : landmarks) {
    const Landmark* landmark = map.Find(id);
    if (!landmark) continue;
    const auto seen = std::count_if(landmark->observations.begin(), landmark->observations.end(),
                                    [&](const Observation& o) { return index.Find(o.keyframe); });
    if (seen < min_seen) continue;
    for (const Observation& o : landmark->observations) {
      const int* camera_index = index.Find(o.keyframe);
      if (!camera_index) continue;
      const Measurement m = Measure(map.Find(o.keyframe)->frame->keypoints[o.keypoint], noise);
      problem.observations.push_back({*camera_index, static_cast<int>(problem.points.size()),
                                      m.pixel, m.inv_sigma2, m.inv_sigma2_right,
                                      landmark->static_probability});
    }
    problem.points.push_back(landmark->p_world);
  }
  return problem;
}

}  // namespace

std::span<const Setting> LensCheckSettings::Table() {
  using T = LensCheckSettings;
  static constexpr Setting kRows[] = {
      ExpertSetting<&T::window>(
          "lens.window", FromTo(3, 100), "keyframes",
          "Consecutive keyframes examined together for undeclared distortion."),
      ExpertSetting<&T::least_window>("lens.least_window", FromTo(3, 100), "keyframes",
                                      "The same where there are too few for min_windows windows."),
      ExpertSetting<&T::min_windows>("lens.min_windows", AtLeast(2), "windows",
                                     "With fewer windows nothing is reported."),
      ExpertSetting<&T::min_seen>("lens.min_seen", AtLeast(2), "keyframes",
                                  "Keyframes of a window that must see a landmark."),
      ExpertSetting<&T::min_bend>("lens.min_bend", kPositive, "",
                                  "Shift at the image corners, relative to their distance from the "
                                  "center, that is reported."),
      ExpertSetting<&T::min_sigmas>("lens.min_sigmas", kPositive, "",
                                    "Standard deviations by which it must differ from 0."),
  };
  return kRows;
}

void LensCheckSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("setting expert.lens.") + what);
  };
  CheckRanges(*this);
  require(window >= least_window, "window must be at least expert.lens.least_window");
  require(max_windows >= min_windows, "max_windows must be at least expert.lens.min_windows");
  require(min_seen <= least_window, "min_seen must be at most expert.lens.least_window");
}

LensCheck CheckLens(const MapSnapshot& map, MapId id, const Camera& camera,
                    const MeasurementNoise& noise, const LensCheckSettings& settings) {
  settings.Check();
  const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(id);
  const size_t window = std::min(static_cast<size_t>(settings.window),
                                 keyframes.size() / static_cast<size_t>(settings.min_windows));
  if (window < static_cast<size_t>(settings.least_window)) return {};
  const size_t there = keyframes.size() / window;
  const size_t used = std::min(there, static_cast<size_t>(settings.max_windows));
  std::vector<double> k1, sigma;
  for (size_t i = 0; i < used; ++i) {
    const std::span<const KeyFrameId> part(keyframes.data() + i * there / used * window, window);
    const auto bend = EstimateLensBend(ProblemOf(map, part, camera, noise, settings.min_seen));
    if (!bend) continue;
    k1.push_back(bend->k1);
    sigma.push_back(bend->sigma);
  }
  LensCheck check;
  check.windows = static_cast<int>(k1.size());
  if (k1.empty()) return check;
  check.k1 = UpperMedian(k1);
  std::vector<double> apart;
  for (double k : k1) apart.push_back(std::abs(k - check.k1));
  // For Gaussian noise, the median absolute deviation is 0.6745 standard deviations, and the
  // standard deviation of a median of n is 1.2533 / sqrt(n). Few windows may agree by chance, so
  // their own uncertainty is added.
  const double of_one = std::hypot(UpperMedian(apart) / 0.6745, UpperMedian(sigma));
  check.sigma = 1.2533 * of_one / std::sqrt(static_cast<double>(k1.size()));
  const double corner = std::hypot(camera.width / camera.fx, camera.height / camera.fy) / 2;
  check.bend = check.k1 * corner * corner;
  check.strong = check.windows >= settings.min_windows &&
                 std::abs(check.bend) >= settings.min_bend &&
                 std::abs(check.k1) >= settings.min_sigmas * check.sigma;
  return check;
}

}  // namespace alidade
