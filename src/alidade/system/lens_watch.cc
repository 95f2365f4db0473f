#include "alidade/system/lens_watch.h"

#include <algorithm>
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
  require(settled >= 0 && settled_cost >= 0, "settled and settled_cost cannot be negative");
  require(min_change > 0, "min_change must be positive");
  require(bend_windows >= 1, "bend_windows must be positive");
  require(rework > 0, "rework must be positive");
  require(begin_anew > 0, "begin_anew must be positive");
  require(keep_frames >= 0, "keep_frames cannot be negative");
  require(step > 0 && step <= 1, "step must lie in 0..1");
}

namespace {

// As CameraEstimateSettings::k1_corner_sigma: holds the distortion at nearly zero. 0 would hold it
// at its current value.
constexpr double kNoBend = 1e-4;

// Keyframes of the largest map.
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

void LensWatch::Ask(const MapSnapshot& map, bool last) {
  const int now = SizeOf(map);
  if (now < settings_.first_keyframes) return;
  ask_at_ = static_cast<int>(std::ceil(now * settings_.growth));
  CameraEstimateSettings ask;
  ask.max_windows = settings_.max_windows;
  ask.readout_sigma = settings_.readout_sigma;
  ask.adjust.focal_sigma = settings_.focal_sigma;
  ask.adjust.min_lens_step = settings_.settled;
  ask.adjust.min_relative_decrease = settings_.settled_cost;
  if (last)  // shorter windows, so that there are enough of them to estimate distortion
    ask.window = std::clamp(now / settings_.bend_windows, ask.min_keyframes, ask.window);
  std::vector<LensWindow> windows = LensWindowsOf(map, LargestMap(map), camera_, noise_, ask);
  const bool bend = static_cast<int>(windows.size()) >= settings_.bend_windows - anew_;
  const double unasked = bend ? 0 : ask.k1_corner_sigma;
  if (!bend) ask.k1_corner_sigma = ask.k2_corner_sigma = kNoBend;
  CameraEstimate estimate = EstimateCamera(std::move(windows), camera_, noise_, ask);
  const double sigma = estimate.focal_sigma;
  if (estimate.observations == 0 || !std::isfinite(sigma)) return;
  if (sigma > settings_.max_sigma && Apart(estimate.camera, camera_) < settings_.far_off * sigma)
    return;
  estimate.known = estimate.known && bend;
  const Answer answer{estimate, unasked};
  const std::optional<Answer> before = std::exchange(before_, answer);
  if (const auto taken = Agreed(before, answer, last)) Believe(*taken, now);
}

// The answer to accept, given two consecutive ones: the later one if they agree within 2 sigma. If
// both differ from the current focal length by more than 2 sigma in the same direction, the one
// nearer to it. Otherwise none.
std::optional<LensWatch::Answer> LensWatch::Agreed(const std::optional<Answer>& before,
                                                   const Answer& now, bool last) const {
  if (last && now.estimate.known) return now;  // no later answer can confirm it
  if (!before) return {};
  const double sigma = now.estimate.focal_sigma, was_sigma = before->estimate.focal_sigma;
  const double off = std::log(now.estimate.camera.fx / camera_.fx);
  const double was_off = std::log(before->estimate.camera.fx / camera_.fx);
  if (std::abs(off - was_off) <= 2 * std::hypot(sigma, was_sigma)) return now;
  const bool same_way =
      off * was_off > 0 && std::abs(off) > 2 * sigma && std::abs(was_off) > 2 * was_sigma;
  if (!same_way) return {};
  return std::abs(was_off) < std::abs(off) ? *before : now;
}

void LensWatch::Believe(const Answer& answer, int keyframes) {
  const CameraEstimate& estimate = answer.estimate;
  const double off = Apart(estimate.camera, camera_);
  const std::lock_guard<std::mutex> lock(mutex_);
  found_ = estimate;
  found_->focal_sigma = std::hypot(estimate.focal_sigma, answer.unasked);
  if (off < settings_.min_change || off <= estimate.focal_sigma) return;
  wanted_ = estimate.camera;
  if (off > 2 * settings_.min_change) ask_at_ = keyframes + settings_.again;
}

void LensWatch::BeginAnew() {
  ask_at_ = settings_.first_keyframes;
  before_.reset();
  anew_ = true;
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
