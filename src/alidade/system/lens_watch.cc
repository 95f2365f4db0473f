#include "alidade/system/lens_watch.h"

#include <cmath>
#include <string>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/map/view.h"

namespace alidade {

void LensWatchSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("refine.") + what);
  };
  require(first_keyframes >= 6, "first_keyframes must be at least 6");
  require(growth > 1, "growth must be above 1");
  require(max_windows >= 1, "max_windows must be positive");
  require(focal_sigma > 0, "focal_sigma must be positive");
  require(readout_sigma >= 0, "readout_sigma cannot be negative");
  require(max_sigma > 0, "max_sigma must be positive");
  require(far_off > 1, "far_off must be above 1");
  require(again >= 1, "again must be at least 1");
  require(min_change > 0, "min_change must be positive");
  require(step > 0 && step <= 1, "step must lie in 0..1");
}

namespace {

int SizeOf(const MapSnapshot& map) {
  const MapId largest = LargestMap(map);
  return largest.valid() ? static_cast<int>(map.KeyFramesOf(largest).size()) : 0;
}

}  // namespace

LensWatch::LensWatch(const Camera& camera, const MeasurementNoise& noise,
                     const LensWatchSettings& settings)
    : camera_(camera), noise_(noise), settings_(settings), ask_at_(settings.first_keyframes) {}

void LensWatch::Mapped(const MapSnapshot& map) {
  const auto now = settings_.enabled ? SizeOf(map) : 0;
  if (now >= ask_at_) Ask(map);
}

void LensWatch::Ask(const MapSnapshot& map) {
  const int now = SizeOf(map);
  if (now < settings_.first_keyframes) return;
  ask_at_ = static_cast<int>(std::ceil(now * settings_.growth));
  const MapId where = LargestMap(map);
  CameraEstimateSettings ask;
  ask.max_windows = settings_.max_windows;
  ask.readout_sigma = settings_.readout_sigma;
  ask.adjust.focal_sigma = settings_.focal_sigma;
  const CameraEstimate estimate =
      EstimateCamera(LensWindowsOf(map, where, camera_, noise_, ask), camera_, noise_, ask);
  const double off = Apart(estimate.camera, camera_);
  if (estimate.observations == 0) return;
  if (!(estimate.focal_sigma <= settings_.max_sigma) &&
      !(off >= settings_.far_off * estimate.focal_sigma))
    return;
  const bool agree = before_ && std::abs(std::log(estimate.camera.fx / before_->camera.fx)) <=
                                    2 * std::hypot(estimate.focal_sigma, before_->focal_sigma);
  before_ = estimate;
  if (!agree) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  found_ = estimate;
  if (off >= settings_.min_change && off > estimate.focal_sigma) {
    wanted_ = estimate.camera;
    ask_at_ = now + settings_.again;
  }
}

std::optional<Camera> LensWatch::Take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(wanted_, std::nullopt);
}

std::optional<CameraEstimate> LensWatch::found() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return found_;
}

}  // namespace alidade
