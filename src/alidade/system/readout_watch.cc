#include "alidade/system/readout_watch.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/map/camera_estimate.h"

namespace alidade {

void ReadoutSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("readout.") + what);
  };
  require(first_keyframes >= 6, "first_keyframes must be at least 6");
  require(growth > 1, "growth must be above 1");
  require(max_iterations >= 1, "max_iterations must be positive");
  require(max_windows >= 1, "max_windows must be positive");
  require(prior_sigma > 0, "prior_sigma must be positive");
  require(min_hint > 0 && hint_sigma > 0, "min_hint and hint_sigma must be positive");
  require(hint_explained >= 0 && hint_explained <= 1, "hint_explained must lie in 0..1");
  require(hint_frames >= 1, "hint_frames must be at least 1");
  require(hint_growth > 0, "hint_growth must be positive");
  require(hints_upright >= 1, "hints_upright must be at least 1");
  require(max_sigma > 0, "max_sigma must be positive");
  require(least >= 0, "least cannot be negative");
  require(longest > least && longest <= 0.2, "longest must lie between least and 0.2");
  require(min_change >= 0, "min_change cannot be negative");
}

ReadoutWatch::ReadoutWatch(const Camera& camera, const MeasurementNoise& noise,
                           const ReadoutSettings& settings)
    : camera_(camera),
      noise_(noise),
      settings_(settings),
      ask_at_(settings.first_keyframes),
      readout_(camera.readout),
      sum_(camera) {}

void ReadoutWatch::Placed(const Vector6d& motion, std::span<const ReadoutMatch> matches) {
  const std::lock_guard<std::mutex> lock(mutex_);
  sum_.Add(motion, matches);
}

// Replaces the readout time. Always true.
bool ReadoutWatch::Take(const std::array<double, 2>& readout, double sigma) {
  camera_.readout = readout;
  const std::lock_guard<std::mutex> lock(mutex_);
  readout_ = readout;
  sigma_ = sigma;
  sum_.Clear();
  return true;
}

// Whether the residuals of the frames since the last change support a change to `readout`: the same
// sign, and more than 2 sigma.
bool ReadoutWatch::FramesAgree(const std::array<double, 2>& readout) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const ReadoutSum::Told told = sum_.told();
  const auto axis = static_cast<size_t>(camera_.ReadAlong());
  return told.frames > 0 && (readout[axis] - camera_.readout[axis]) * told.change > 0 &&
         std::abs(told.change) > 2 * told.sigma;
}

// Changes the readout time if the residuals of enough frames agree on it. The map partly agrees
// with a wrong readout time, so the estimated change is multiplied by hint_growth.
bool ReadoutWatch::TakeHint() {
  ReadoutSum::Told told;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    told = sum_.told();
    if (told.frames < settings_.hint_frames || told.sigma > settings_.hint_sigma) return false;
    sum_.Clear();
  }
  const bool plain =
      std::abs(told.change) >= settings_.min_hint && told.explained >= settings_.hint_explained;
  const bool agrees = plain && last_hint_ * told.change > 0;
  hints_ = plain ? (agrees ? hints_ + 1 : 1) : 0;
  last_hint_ = plain ? told.change : 0;
  if (hints_ < (camera_.ReadAlong() == 0 ? settings_.hints_upright : 1)) return false;
  hints_ = 0;
  const auto axis = static_cast<size_t>(camera_.ReadAlong());
  std::array<double, 2> readout{};
  readout[axis] = std::clamp(camera_.readout[axis] + settings_.hint_growth * told.change,
                             -settings_.longest, settings_.longest);
  if (std::abs(readout[axis]) < settings_.least) readout = {};
  if (readout == camera_.readout) return false;
  return Take(readout, settings_.max_sigma);
}

bool ReadoutWatch::Mapped(KeyFrameId id, const MapSnapshot& map) {
  const KeyFrame* keyframe = map.Find(id);
  if (camera_.readout_known || !settings_.enabled || !keyframe) return false;
  const MapId where = keyframe->map;
  const auto now = static_cast<int>(map.KeyFramesOf(where).size());
  if (now < settings_.first_keyframes) return false;
  if (TakeHint()) return true;
  if (now < ask_at_) return false;
  ask_at_ = static_cast<int>(std::ceil(now * settings_.growth));

  CameraEstimateSettings ask;
  ask.readout_sigma = settings_.prior_sigma;
  ask.hold_lens = true;
  ask.max_windows = settings_.max_windows;
  ask.adjust.max_iterations = settings_.max_iterations;
  const CameraEstimate found =
      EstimateCamera(LensWindowsOf(map, where, camera_, noise_, ask), camera_, noise_, ask);
  std::array<double, 2> readout = found.camera.readout;
  const double sigma = found.readout_sigma.maxCoeff();
  const double longer = std::max(std::abs(readout[0]), std::abs(readout[1]));
  if (sigma > settings_.max_sigma || longer > settings_.longest) return false;
  if (longer < settings_.least) return false;  // keeps a readout time found by TakeHint()
  const double change = std::max(std::abs(readout[0] - camera_.readout[0]),
                                 std::abs(readout[1] - camera_.readout[1]));
  if (change < std::max(settings_.min_change, 1e-9)) return false;
  if (change > settings_.min_hint && !FramesAgree(readout)) return false;
  return Take(readout, sigma);
}

void ReadoutWatch::SetCamera(const Camera& camera) {
  camera_ = camera;
  const std::lock_guard<std::mutex> lock(mutex_);
  readout_ = camera.readout;
  sum_ = ReadoutSum(camera);
}

std::array<double, 2> ReadoutWatch::readout() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return readout_;
}

double ReadoutWatch::sigma() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return sigma_;
}

}  // namespace alidade
