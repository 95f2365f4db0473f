#include "alidade/calibration/lens_watch.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"
#include "alidade/map/view.h"

namespace alidade {

std::span<const Setting> LensWatchSettings::Table() {
  using T = LensWatchSettings;
  static constexpr Setting kRows[] = {
      ExpertSetting<&T::first_keyframes>(
          "camera.first_keyframes", AtLeast(6), "keyframes",
          "Keyframes of a map when camera and readout time are first estimated."),
      ExpertSetting<&T::growth>(
          "camera.growth", MoreThan(1), "",
          "They are estimated again when it has this times as many keyframes."),
      ExpertSetting<&T::focal_sigma>(
          "camera.focal_sigma", kPositive, "",
          "Prior standard deviation of the focal length's logarithm; 0.35: 66 degrees may be 49 to "
          "85."),
      ExpertSetting<&T::readout_sigma>(
          "camera.readout_sigma", kNotNegative, "s",
          "Prior standard deviation of the rolling-shutter readout time about none."),
      PublicSetting<&T::enabled>(
          "refine.enabled", kOnOff, "",
          "One camera: estimate its focal length and distortion while the map "
          "grows."),
      ExpertSetting<&T::max_windows>("refine.max_windows", kPositive, "windows",
                                     "Windows of 12 keyframes used, spread over the map."),
      ExpertSetting<&T::bend_windows>("refine.bend_windows", kPositive, "windows",
                                      "With fewer windows, distortion is not estimated."),
      ExpertSetting<&T::max_sigma>("refine.max_sigma", kPositive, "",
                                   "Largest relative standard deviation of a focal length that is "
                                   "used."),
      ExpertSetting<&T::far_off>(
          "refine.far_off", MoreThan(1), "",
          "It is also used when it differs from the current one by more than "
          "this many standard deviations."),
      ExpertSetting<&T::min_change>(
          "refine.min_change", kPositive, "",
          "A smaller relative change of a pixel's distance from the center "
          "is not applied."),
      ExpertSetting<&T::again>("refine.again", AtLeast(1), "keyframes",
                               "New keyframes after which a change by more than twice that is "
                               "estimated again."),
      ExpertSetting<&T::settled>("refine.settled", kNotNegative, "",
                                 "The estimate has converged when log focal, k1 and k2 change by "
                                 "less."),
      ExpertSetting<&T::settled_cost>("refine.settled_cost", kNotNegative, "",
                                      "And the cost falls by a smaller share."),
      ExpertSetting<&T::step>("refine.step", kPositiveShare, "",
                              "The map is moved to another camera in steps of this share."),
      ExpertSetting<&T::rework>("refine.rework", kPositive, "",
                                "After a larger change all keyframes are matched again."),
      ExpertSetting<&T::begin_anew>(
          "refine.begin_anew", kPositive, "",
          "After a larger change the map is built again from its frames."),
      ExpertSetting<&T::keep_frames>("refine.keep_frames", kNotNegative, "frames",
                                     "Frames kept for that; 0: a map is never built again."),
  };
  return kRows;
}

void LensWatchSettings::Check() const { CheckRanges(*this); }

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
