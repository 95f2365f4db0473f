#include "alidade/calibration/camera_estimate.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/id_map.h"
#include "alidade/base/settings_table.h"
#include "alidade/calibration/camera_correction.h"

namespace alidade {
namespace {

// In sigmas of the readout time; below it the readout counts as zero.
constexpr double kLeastTold = 3;

LensWindow WindowOf(const MapSnapshot& map, std::span<const KeyFrameId> keyframes,
                    const Camera& camera, const MeasurementNoise& noise,
                    const CameraEstimateSettings& settings) {
  LensWindow window;
  IdMap<KeyFrameId, int> index;
  std::vector<LandmarkId> landmarks;
  for (KeyFrameId id : keyframes) {
    index[id] = static_cast<int>(window.T_camera_world.size());
    const KeyFrame& keyframe = *map.Find(id);
    window.T_camera_world.push_back(keyframe.T_camera_world);
    window.motions.push_back(MotionOf(keyframe));
    for (LandmarkId landmark : keyframe.landmarks) {
      if (landmark.valid()) landmarks.push_back(landmark);
    }
  }
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());
  for (LandmarkId id : landmarks) {
    const Landmark* landmark = map.Find(id);
    if (!landmark || landmark->static_probability < Frame::kMappable) continue;
    const auto seen = std::count_if(landmark->observations.begin(), landmark->observations.end(),
                                    [&](const Observation& o) { return index.Find(o.keyframe); });
    if (seen < settings.min_seen) continue;
    for (const Observation& o : landmark->observations) {
      const int* camera_index = index.Find(o.keyframe);
      if (!camera_index) continue;
      const Keypoint& keypoint = map.Find(o.keyframe)->frame->keypoints[o.keypoint];
      Eigen::Vector2d pixel(keypoint.raw_x, keypoint.raw_y);
      if (settings.hold_lens) pixel = camera.Undistort(pixel);
      pixel.y() = camera.cy + (pixel.y() - camera.cy) * camera.fx / camera.fy;
      window.observations.push_back({*camera_index,
                                     static_cast<int>(window.points.size()),
                                     pixel,
                                     Measure(keypoint, noise).inv_sigma2,
                                     {(keypoint.raw_x + 0.5) / camera.width - 0.5,
                                      (keypoint.raw_y + 0.5) / camera.height - 0.5}});
    }
    window.points.push_back(landmark->p_world);
  }
  return window;
}

}  // namespace

std::span<const Setting> CameraEstimateSettings::Table() {
  using T = CameraEstimateSettings;
  using A = LensAdjustmentSettings;
  static constexpr Setting kRows[] = {
      SameSetting<&T::adjust, &A::focal_sigma>("camera.focal_sigma", kPositive),
      SameSetting<&T::readout_sigma>("camera.readout_sigma", kNotNegative),
      ExpertSetting<&T::window>("calibrate.window", FromTo(3, 500), "keyframes",
                                "Consecutive keyframes adjusted together."),
      ExpertSetting<&T::max_windows>("calibrate.max_windows", kPositive, "windows",
                                     "Most windows, spread over the map."),
      ExpertSetting<&T::min_keyframes>("calibrate.min_keyframes", AtLeast(3), "keyframes",
                                       "A window with fewer keyframes is not used."),
      ExpertSetting<&T::min_seen>("calibrate.min_seen", AtLeast(2), "keyframes",
                                  "Keyframes of a window that must see a landmark."),
      ExpertSetting<&T::max_focal_sigma>(
          "calibrate.max_focal_sigma", kPositive, "",
          "The focal length counts as known below this relative standard deviation."),
      ExpertSetting<&T::k1_corner_sigma>(
          "calibrate.k1_corner_sigma", kNotNegative, "",
          "Prior standard deviation of the shift by k1 at the image corners, relative to their "
          "distance from the center."),
      ExpertSetting<&T::k2_corner_sigma>("calibrate.k2_corner_sigma", kNotNegative, "",
                                         "The same for k2."),
      ExpertSetting<&T::centre_sigma>(
          "calibrate.center_sigma", kNotNegative, "",
          "Prior standard deviation of the principal point, as a share of the longer image side."),
      ExpertSetting<&T::adjust, &A::inflation>(
          "calibrate.inflation", AtLeast(1), "",
          "Factor on standard deviations, since errors of keypoints are correlated."),
      ExpertSetting<&T::adjust, &A::bound>(
          "calibrate.bound", AtLeast(1), "",
          "Bound of the robust loss, in standard deviations of the observed noise."),
  };
  return kRows;
}

void CameraEstimateSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("setting expert.calibrate.") + what);
  };
  adjust.Check();
  CheckRanges(*this);
  require(window >= min_keyframes, "window must be at least expert.calibrate.min_keyframes");
  require(min_seen <= min_keyframes, "min_seen must be at most expert.calibrate.min_keyframes");
}

std::vector<LensWindow> LensWindowsOf(const MapSnapshot& map, MapId id, const Camera& camera,
                                      const MeasurementNoise& noise,
                                      const CameraEstimateSettings& settings) {
  settings.Check();
  const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(id);
  const size_t all = keyframes.size();
  if (all < static_cast<size_t>(settings.min_keyframes)) return {};
  // Number of windows of equal size that cover all keyframes.
  const size_t there =
      (all + static_cast<size_t>(settings.window) - 1) / static_cast<size_t>(settings.window);
  const size_t used = std::min(there, static_cast<size_t>(settings.max_windows));
  std::vector<LensWindow> windows;
  for (size_t i = 0; i < used; ++i) {
    const size_t at = i * there / used;
    const size_t begin = at * all / there, end = (at + 1) * all / there;
    if (end - begin < static_cast<size_t>(settings.min_keyframes)) continue;
    windows.push_back(
        WindowOf(map, std::span(keyframes).subspan(begin, end - begin), camera, noise, settings));
  }
  return windows;
}

CameraEstimate EstimateCamera(std::vector<LensWindow> windows, const Camera& camera,
                              const MeasurementNoise& noise,
                              const CameraEstimateSettings& settings) {
  settings.Check();
  CameraEstimate estimate;
  estimate.camera = camera;
  for (const LensWindow& window : windows)
    estimate.keyframes += static_cast<int>(window.T_camera_world.size());
  if (estimate.keyframes == 0) return estimate;
  RadialLens start{camera.fx, camera.distortion[0], camera.distortion[1], {camera.cx, camera.cy}};
  start.readout = {camera.readout[0], camera.readout[1]};
  if (settings.hold_lens) start.k1 = start.k2 = 0;
  LensAdjustmentSettings adjust = settings.adjust;
  const double corner2 =
      (std::pow(camera.width / camera.fx, 2) + std::pow(camera.height / camera.fy, 2)) / 4;
  adjust.k1_sigma = settings.k1_corner_sigma / corner2;
  adjust.k2_sigma = settings.k2_corner_sigma / (corner2 * corner2);
  adjust.centre_sigma = settings.centre_sigma * std::max(camera.width, camera.height);
  adjust.centre = Eigen::Vector2d(0.5 * (camera.width - 1), 0.5 * (camera.height - 1));
  if (settings.hold_lens) {
    adjust.hold_focal = true;
    adjust.k1_sigma = adjust.k2_sigma = adjust.centre_sigma = 0;
  }
  const bool ask_readout = !camera.readout_known && settings.readout_sigma > 0;
  if (ask_readout) adjust.readout_sigma[camera.ReadAlong()] = settings.readout_sigma;
  LensAdjustment found = AdjustLens(windows, start, adjust);
  const double readout_sigma =
      std::sqrt(std::max(0.0, found.covariance.diagonal().tail<2>()[camera.ReadAlong()]));
  if (ask_readout && !(found.lens.readout.cwiseAbs().maxCoeff() > kLeastTold * readout_sigma)) {
    start = found.lens;
    start.readout.setZero();
    adjust.readout_sigma.setZero();
    found = AdjustLens(windows, start, adjust);
  }
  estimate.observations = found.observations;
  estimate.noise = found.noise * noise.sigma_px;
  const LensAdjustment::Parameters sigma = found.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  estimate.camera.readout = {found.lens.readout.x(), found.lens.readout.y()};
  estimate.readout_sigma = sigma.tail<2>();
  if (settings.hold_lens) return estimate;
  estimate.camera.fx = found.lens.focal;
  estimate.camera.fy = found.lens.focal * camera.fy / camera.fx;
  estimate.camera.distortion = {found.lens.k1, found.lens.k2, 0, 0, 0};
  // Rows were scaled about the old center.
  estimate.camera.cx = found.lens.centre.x();
  estimate.camera.cy = camera.cy + (found.lens.centre.y() - camera.cy) * camera.fy / camera.fx;
  estimate.centre_sigma = sigma.segment<2>(3);
  estimate.focal_sigma = sigma.x();
  estimate.k1_sigma = sigma.y();
  estimate.k2_sigma = sigma.z();
  estimate.known = found.observations > 0 && std::isfinite(estimate.focal_sigma) &&
                   estimate.focal_sigma <= settings.max_focal_sigma;
  return estimate;
}

double Apart(const Camera& a, const Camera& b) {
  const auto at_corner = [](const Camera& c) {
    const double r2 = (std::pow(c.width / c.fx, 2) + std::pow(c.height / c.fy, 2)) / 4;
    return r2 * (c.distortion[0] + r2 * c.distortion[1]);
  };
  return std::max(std::abs(std::log(a.fx / b.fx)), std::abs(at_corner(a) - at_corner(b)));
}

Camera Between(const Camera& a, const Camera& b, double share) {
  const auto mixed = [share](double x, double y) { return x + share * (y - x); };
  Camera camera = b;
  camera.fx = a.fx * std::pow(b.fx / a.fx, share);
  camera.fy = a.fy * std::pow(b.fy / a.fy, share);
  camera.cx = mixed(a.cx, b.cx);
  camera.cy = mixed(a.cy, b.cy);
  for (size_t i = 0; i < a.distortion.size(); ++i)
    camera.distortion[i] = mixed(a.distortion[i], b.distortion[i]);
  for (size_t i = 0; i < a.readout.size(); ++i)
    camera.readout[i] = mixed(a.readout[i], b.readout[i]);
  return camera;
}

}  // namespace alidade
