#include "alidade/run/calibration/find_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/io/read_ahead.h"
#include "alidade/map/view.h"
#include "alidade/run/sources/frame_input.h"
#include "alidade/system/slam.h"

namespace alidade {
namespace {

// One pass over the recording with one camera.
class Pass {
 public:
  Pass(std::unique_ptr<FrameSource> source, const Camera& camera, const SlamSettings& settings,
       const CalibrateSettings& calibrate)
      : frames_(std::move(source)),
        slam_(camera, settings),
        given_(camera),
        noise_(settings.mapper.noise),
        calibrate_(calibrate),
        ask_at_(calibrate.first_keyframes) {}

  // Processes the next frame; false at the end.
  bool Step() {
    const std::optional<SourceFrame> frame = frames_.Next();
    if (!frame) return false;
    if (std::isfinite(frame->time)) {  // unusable frames may have none
      if (!first_time_) first_time_ = frame->time;
      if (frame->time - *first_time_ > calibrate_.max_seconds) return false;
    }
    ++count_;
    if (frame->part != std::exchange(part_, frame->part)) slam_.Reset();
    if (!frame->problem.empty()) return true;
    try {
      slam_.Track(InputOf(*frame));
    } catch (const Error&) {  // an unusable frame: the run itself reports it
    }
    return true;
  }
  int count() const { return count_; }
  int keyframes() const {
    const MapSnapshot map = slam_.Snapshot();
    const MapId largest = LargestMap(map);
    return largest.valid() ? static_cast<int>(map.KeyFramesOf(largest).size()) : 0;
  }
  // A new estimate, if the map has grown enough since the last one.
  std::optional<CameraEstimate> Ask() {
    const int now = keyframes();
    if (now < ask_at_) return {};
    ask_at_ = static_cast<int>(std::ceil(now * calibrate_.growth));
    return Estimate();
  }
  CameraEstimate Estimate() {
    const MapSnapshot map = slam_.Snapshot();
    const MapId largest = LargestMap(map);
    windows_.clear();
    if (largest.valid()) windows_ = LensWindowsOf(map, largest, slam_.camera(), noise_, calibrate_);
    CameraEstimate estimate = EstimateCamera(windows_, slam_.camera(), noise_, calibrate_);
    estimate.camera = CameraOfSize(estimate.camera, given_);
    return estimate;
  }
  void Finish() { slam_.Finish(); }
  const std::vector<LensWindow>& windows() const { return windows_; }
  Camera used() const { return slam_.camera(); }

 private:
  ReadAhead frames_;
  Slam slam_;
  Camera given_;
  MeasurementNoise noise_;
  const CalibrateSettings& calibrate_;
  std::vector<LensWindow> windows_;
  std::optional<double> first_time_;
  int count_ = 0, ask_at_;
  int part_ = 0;  // of the newest frame
};

}  // namespace

Camera CameraOfSize(const Camera& camera, const Camera& of) {
  Camera result = of;
  result.fx = result.fy = camera.fx * of.width / camera.width;
  result.distortion = camera.distortion;
  result.readout = camera.readout;
  result.focal_sigma = camera.focal_sigma;
  // Pixel centres are at whole numbers, image borders at ±0.5.
  result.cx = (camera.cx + 0.5) * of.width / camera.width - 0.5;
  result.cy = (camera.cy + 0.5) * of.height / camera.height - 0.5;
  return result;
}

namespace {

using Opener = std::function<std::unique_ptr<FrameSource>()>;
using Watcher = std::function<bool(const CalibrateProgress&)>;

// Largest difference between the focal lengths of two passes that agree, in their standard
// deviations.
constexpr double kAgreement = 3;
// Number of passes that must agree: a map supports the camera it was made with, and the matches of
// two maps of one recording differ by chance
// (docs/development/decisions/0005-offline-self-calibration.md).
constexpr size_t kAgreeingPasses = 2;

// A pass whose estimate equals its initial camera within its standard deviation.
struct Agreeing {
  CameraEstimate estimate;
  std::vector<LensWindow> windows;  // of images of `used`
  Camera used;
};

// Adjusts the camera to the maps of all passes together. Since they show the same images, the
// standard deviation is that of one pass, the last.
CameraEstimate Together(const std::vector<Agreeing>& passes, const MeasurementNoise& noise,
                        const CalibrateSettings& calibrate) {
  CameraEstimate estimate = passes.back().estimate;
  if (passes.size() < 2) return estimate;
  std::vector<LensWindow> windows;
  for (const Agreeing& pass : passes)
    windows.insert(windows.end(), pass.windows.begin(), pass.windows.end());
  const Camera& used = passes.back().used;
  const CameraEstimate joint = EstimateCamera(std::move(windows), used, noise, calibrate);
  const Camera size = estimate.camera;
  estimate.camera = CameraOfSize(joint.camera, size);
  estimate.observations = joint.observations;
  estimate.noise = joint.noise;
  return estimate;
}

enum class PassEnd { kRecordingEnded, kBetterCamera, kEnough, kStopped };

// Plays a pass until the camera is known, a clearly better initial camera is found, or the
// recording ends. `estimate`: the last one. `may_restart`: another pass may follow.
PassEnd Play(Pass& pass, const Camera& start, const CalibrateSettings& calibrate, bool may_restart,
             const Watcher& go_on, CalibrateProgress& progress, CameraEstimate& estimate) {
  std::optional<CameraEstimate> before;
  while (pass.Step()) {
    progress.frames = pass.count();
    PassEnd end = PassEnd::kRecordingEnded;
    if (const auto now = pass.Ask()) {
      progress.keyframes = pass.keyframes();
      progress.estimate = estimate = *now;
      const double off = Apart(now->camera, start);
      // Requires two consecutive estimates that agree: the first one of a small map may be wrong.
      if (before && now->focal_sigma <= calibrate.max_restart_sigma && off > calibrate.max_off &&
          off > 2 * now->focal_sigma &&
          std::abs(std::log(now->camera.fx / before->camera.fx)) <=
              2 * std::hypot(now->focal_sigma, before->focal_sigma) &&
          may_restart)
        end = PassEnd::kBetterCamera;
      if (now->focal_sigma <= calibrate.enough_sigma && off <= calibrate.max_off && before &&
          Apart(now->camera, before->camera) <= 2 * calibrate.enough_sigma)
        end = PassEnd::kEnough;
      before = now;
    }
    if (!go_on(progress)) return PassEnd::kStopped;
    if (end != PassEnd::kRecordingEnded) return end;
  }
  return PassEnd::kRecordingEnded;
}

// Plays passes, each starting with the camera estimated so far, until kAgreeingPasses agree or an
// estimate is neither usable nor indicates another camera. The first pass, with `camera`, plays
// `first` if that is open. `found` counts on; `stopped`: go_on ended the search, and nothing is
// known.
void Search(std::unique_ptr<FrameSource> first, const Opener& open, Camera camera,
            const SlamSettings& settings, const CalibrateSettings& calibrate, const Watcher& go_on,
            CameraFound& found, bool& stopped) {
  const int most = found.passes + calibrate.max_passes;
  std::vector<Agreeing> agreeing;
  while (found.passes < most && agreeing.size() < kAgreeingPasses) {
    ++found.passes;
    Pass pass(first ? std::move(first) : open(), camera, settings, calibrate);
    CalibrateProgress progress{found.passes, 0, 0, {}};
    CameraEstimate last;
    const PassEnd end = Play(pass, camera, calibrate, found.passes < most, go_on, progress, last);
    found.frames += pass.count();
    if (end == PassEnd::kStopped) {
      stopped = true;
      found.estimate = last;
      found.estimate.known = false;
      found.why_not = "the calibration was stopped";
      return;
    }
    if (end == PassEnd::kRecordingEnded) {
      pass.Finish();
      last = pass.Estimate();
    }
    found.estimate = last;
    found.windows = pass.windows();
    found.windows_camera = pass.used();
    if (end != PassEnd::kBetterCamera) {
      const double off = Apart(last.camera, camera), sigma = last.focal_sigma;
      const bool usable = sigma <= calibrate.max_restart_sigma;
      const bool points_away =
          sigma <= calibrate.max_retry_sigma && off > calibrate.max_off && off > 2 * sigma;
      if (last.keyframes < calibrate.first_keyframes || !(usable || points_away)) break;
      if (usable && off <= kAgreement * sigma)
        agreeing.push_back({last, pass.windows(), pass.used()});
    }
    camera = last.camera;
  }
  if (!agreeing.empty()) found.estimate = Together(agreeing, settings.mapper.noise, calibrate);
  const CameraEstimate& last = found.estimate;
  found.usable = last.keyframes >= calibrate.first_keyframes &&
                 last.focal_sigma <= calibrate.max_restart_sigma;
  const bool agreed = agreeing.size() >= kAgreeingPasses;
  found.estimate.known = last.known && found.usable && agreed;
  if (found.estimate.known) {
    found.why_not.clear();
    return;
  }
  found.why_not = last.keyframes == 0 ? "nothing was mapped"
                  : last.keyframes < calibrate.first_keyframes
                      ? "only " + std::to_string(last.keyframes) + " keyframes were mapped"
                  : found.usable && !agreed
                      ? "the estimates of the passes differ"
                      : "the camera moves and rotates too little to determine its focal length";
}

}  // namespace

CameraFound FindCamera(const Opener& open, const SlamSettings& settings,
                       const CalibrateSettings& calibrate, const Watcher& go_on) {
  calibrate.Check();
  SlamSettings plain = settings;
  plain.sensor = Sensor::kMono;
  plain.threaded = false;
  plain.semidense.enabled = false;
  plain.readout.enabled = false;  // estimated together with the lens
  std::unique_ptr<FrameSource> first = open();
  Camera camera = first->Info().camera;
  CameraFound found;
  bool stopped = false;
  Search(std::move(first), open, camera, plain, calibrate, go_on, found, stopped);
  if (stopped || found.usable || found.estimate.keyframes < calibrate.first_keyframes ||
      calibrate.retry_bend == 0)
    return found;
  // A map made without the radial distortion of the lens may itself be too distorted for an
  // estimate.
  camera.distortion[0] =
      calibrate.retry_bend * 4 /
      (std::pow(camera.width / camera.fx, 2) + std::pow(camera.height / camera.fy, 2));
  CameraFound bent;
  bent.passes = found.passes;
  bent.frames = found.frames;
  Search(nullptr, open, camera, plain, calibrate, go_on, bent, stopped);
  if (bent.estimate.known) return bent;
  found.passes = bent.passes;
  found.frames = bent.frames;
  return found;
}

double FovDegrees(const Camera& camera) {
  return 360 / std::numbers::pi * std::atan(camera.width / (2 * camera.fx));
}

std::string FovInWords(const CameraEstimate& estimate) {
  const double fov = FovDegrees(estimate.camera);
  // d fov / d log f = -sin fov.
  const double sigma =
      180 / std::numbers::pi * estimate.focal_sigma * std::sin(fov * std::numbers::pi / 180);
  char text[60];
  PrintTo(text, sizeof(text), "%.1f ± %.1f degrees", fov, sigma);
  return text;
}

std::string CameraInWords(const CameraEstimate& estimate) {
  const Camera& camera = estimate.camera;
  char text[160];
  PrintTo(text, sizeof(text),
          " (f %.1f ± %.1f px, k1 %.3f ± %.3f, k2 %.3f ± %.3f, "
          "center %.1f, %.1f ± %.1f",
          camera.fx, estimate.focal_sigma * camera.fx, camera.distortion[0], estimate.k1_sigma,
          camera.distortion[1], estimate.k2_sigma, camera.cx, camera.cy,
          estimate.centre_sigma.maxCoeff());
  std::string words = FovInWords(estimate) + text;
  // Along rows, or along columns for upright images; negative: from the opposite side.
  const double readout = camera.readout[0] + camera.readout[1];
  if (readout != 0) {
    PrintTo(text, sizeof(text), ", readout time %.1f ± %.1f ms", 1e3 * std::abs(readout),
            1e3 * estimate.readout_sigma.maxCoeff());
    words += text;
  }
  return words + ")";
}

}  // namespace alidade
