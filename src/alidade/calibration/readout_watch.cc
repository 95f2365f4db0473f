#include "alidade/calibration/readout_watch.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/base/part_times.h"
#include "alidade/base/settings_table.h"
#include "alidade/calibration/camera_estimate.h"

namespace alidade {

std::span<const Setting> ReadoutSettings::Table() {
  using T = ReadoutSettings;
  static constexpr Setting kRows[] = {
      SameSetting<&T::first_keyframes>("camera.first_keyframes", AtLeast(6)),
      ExpertSetting<&T::prior_sigma>("readout.prior_sigma", kPositive, "s",
                                     "Prior standard deviation of the readout time about none."),
      PublicSetting<&T::enabled>("readout.enabled", kOnOff, "",
                                 "Estimate and correct the rolling-shutter readout time."),
      ExpertSetting<&T::growth>(
          "readout.growth", MoreThan(1), "",
          "It is estimated again when the map has this times as many keyframes."),
      ExpertSetting<&T::max_windows>("readout.max_windows", kPositive, "windows",
                                     "Windows of 12 keyframes used, spread over the map."),
      ExpertSetting<&T::max_iterations>("readout.max_iterations", kPositive, "",
                                        "Iterations of each window."),
      ExpertSetting<&T::max_sigma>("readout.max_sigma", kPositive, "s",
                                   "An estimate with a larger standard deviation is not used."),
      ExpertSetting<&T::least>("readout.least", kNotNegative, "s",
                               "A shorter readout time counts as none."),
      ExpertSetting<&T::longest>("readout.longest", FromTo(0, 0.2), "s",
                                 "A longer readout time is not used."),
      ExpertSetting<&T::min_change>("readout.min_change", kNotNegative, "s",
                                    "A smaller change of the readout time is not applied."),
      ExpertSetting<&T::min_hint>("readout.min_hint", kPositive, "s",
                                  "Change of the readout time that frames must indicate."),
      ExpertSetting<&T::hint_sigma>("readout.hint_sigma", kPositive, "s",
                                    "Largest standard deviation of that change."),
      ExpertSetting<&T::hint_explained>("readout.hint_explained", kZeroToOne, "",
                                        "Share of the squared residuals that the change removes."),
      ExpertSetting<&T::hint_frames>("readout.hint_frames", kPositive, "frames",
                                     "Frames that indicate it."),
      ExpertSetting<&T::hint_growth>("readout.hint_growth", kPositive, "",
                                     "Factor on the change: the map hides half of it."),
      ExpertSetting<&T::hints_upright>("readout.hints_upright", kPositive, "",
                                       "Consecutive indications that upright images need."),
  };
  return kRows;
}

void ReadoutSettings::Check() const {
  CheckRanges(*this);
  if (longest <= least)
    ThrowUsage("setting expert.readout.longest must exceed expert.readout.least");
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
  const PartTimer timer(FramePart::kShutter);
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
