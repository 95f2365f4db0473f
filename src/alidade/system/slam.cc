// The driving calls of Slam. What any thread may ask is in slam_queries.cc; a frame's way is in
// frame_pipeline.cc.
#include "alidade/system/slam.h"

#include <cmath>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/part_times.h"
#include "alidade/base/print.h"
#include "alidade/system/movers.h"
#include "alidade/system/prepare.h"
#include "alidade/system/slam_impl.h"

namespace alidade {
namespace {

// Checked, with one seed for every random choice. With dynamics, new landmarks get a lower prior.
SlamSettings InUse(SlamSettings settings) {
  if (LeavesOutFromStart(settings.dynamics.mode) && settings.dynamics.weigh)
    settings.mapper.young_static = kYoungStatic;
  settings.dynamics.seed = settings.tracker.seed = settings.start.two_view.seed =
      settings.loop.seed = settings.seed;
  settings.Check();
  return settings;
}

void WarnOfJump(double seconds) {
  char text[120];
  PrintTo(text, sizeof(text),
          "the time jumps %s by %.1f s, which is treated as a cut (further jumps are not reported)",
          seconds < 0 ? "back" : "ahead", std::abs(seconds));
  LogWarning(text);
}

}  // namespace

Slam::Impl::Impl(const Camera& given, const SlamSettings& settings,
                 const std::shared_ptr<Detector>& detector)
    : given_(given),
      settings_(InUse(settings)),
      pipeline_(CameraInUse(given, settings_), settings_, detector),
      clock_(settings_.time) {}

TrackResult Slam::Impl::Track(const FrameInput& input) {
  const std::lock_guard<std::mutex> driving(driving_);
  const Stopwatch whole;
  FrameInput prepared;
  const char* cut = "";
  try {
    const PartTimer timer(FramePart::kPrepare);
    prepared = Prepare(input, given_, pipeline_.camera().Get(), settings_);
    cut = CheckTime(input.time);
  } catch (const Error&) {  // refused: the frame does not count
    throw;
  } catch (...) {
    BeginFrame(input.time);
    pipeline_.EndFrame();
    throw;
  }
  prepared.time = clock_.steady();
  BeginFrame(input.time);
  try {
    TrackResult result = pipeline_.Process(prepared, input.time);
    result.cut = cut;
    frame_ms_.Add(whole.Milliseconds());
    if (pipeline_.workers().any_stopped() || pipeline_.movers().any_stopped())
      result.warning = Health().Stopped();
    return result;
  } catch (...) {
    pipeline_.Abandon();
    throw;
  }
}

void Slam::Impl::BeginFrame(double time) {
  pipeline_.BeginFrame(time);
  frames_ = pipeline_.trajectory().size();
}

// Why a frame of this time does not continue the last one; "" if it does. Throws Error (input) if
// it is older than the last one.
const char* Slam::Impl::CheckTime(double time) {
  const FrameLog& log = pipeline_.trajectory();
  const double jump = log.empty() ? 0 : time - log.time();
  const char* reason = "";
  switch (clock_.Take(time)) {
    case ClockStep::kGoesOn:
      return std::exchange(restarted_, false) ? "a new recording" : "";
    case ClockStep::kLate:
      ThrowInput("the time of the frame does not increase");
    case ClockStep::kGap:
      Cut();
      reason = "after a gap in time";
      break;
    case ClockStep::kBack:
      Cut();
      pipeline_.BeginRecording();
      reason = "the clock was set back";
      break;
  }
  if (!std::exchange(jump_warned_, true)) WarnOfJump(jump);
  return reason;
}

void Slam::Impl::Cut() {
  ++cuts_;
  pipeline_.Cut(clock_.steady());
}

void Slam::Impl::Load(const SavedMap& saved) {
  const std::lock_guard<std::mutex> driving(driving_);
  pipeline_.Load(saved);
}

void Slam::Impl::LeaveOut(const cv::Mat& mask) {
  const std::lock_guard<std::mutex> driving(driving_);
  if (mask.empty() || mask.type() != CV_8UC1) ThrowUsage("a mask must be an 8-bit gray image");
  if (!pipeline_.trajectory().empty()) ThrowUsage("a mask must be given before the first frame");
  constexpr double kMost = 0.9;  // of the image: too little is left for poses
  if (cv::countNonZero(mask) > kMost * static_cast<double>(mask.total()))
    ThrowUsage("the mask leaves out more than 90 % of the image");
  pipeline_.LeaveOut(mask);
}

void Slam::Impl::SetImu(const ImuModel& imu) {
  const std::lock_guard<std::mutex> driving(driving_);
  if (!pipeline_.trajectory().empty()) ThrowUsage("SetImu() comes before the first frame");
  imu.Check();
  pipeline_.SetImu(imu);
}

void Slam::Impl::KeepFramesIn(std::shared_ptr<ByteStore> store) {
  const std::lock_guard<std::mutex> driving(driving_);
  pipeline_.KeepFramesIn(std::move(store));
}

void Slam::Impl::Reset() {
  const std::lock_guard<std::mutex> driving(driving_);
  if (pipeline_.trajectory().empty() || restarted_) return;
  Cut();
  clock_.Restart();
  pipeline_.BeginRecording();
  restarted_ = true;
}

void Slam::Impl::Forget() {
  Reset();
  const std::lock_guard<std::mutex> driving(driving_);
  pipeline_.Forget();
}

void Slam::Impl::SetMapping(bool on) {
  const std::lock_guard<std::mutex> driving(driving_);
  pipeline_.SetMapping(on);
}

void Slam::Impl::Finish(double limit) {
  const std::lock_guard<std::mutex> driving(driving_);
  pipeline_.Finish(limit);
}

Slam::Slam(const Camera& camera, const SlamSettings& settings, std::shared_ptr<Detector> detector)
    : impl_(std::make_unique<Impl>(camera, settings, detector)) {}
Slam::~Slam() = default;
void Slam::Load(const SavedMap& saved) { impl_->Load(saved); }
void Slam::LeaveOut(const cv::Mat& mask) { impl_->LeaveOut(mask); }
void Slam::SetImu(const ImuModel& imu) { impl_->SetImu(imu); }
void Slam::KeepFramesIn(std::shared_ptr<ByteStore> store) { impl_->KeepFramesIn(std::move(store)); }
TrackResult Slam::Track(const FrameInput& input) { return impl_->Track(input); }
void Slam::Reset() { impl_->Reset(); }
void Slam::Forget() { impl_->Forget(); }
void Slam::SetMapping(bool on) { impl_->SetMapping(on); }
std::vector<FramePose> Slam::Finish(double limit) {
  impl_->Finish(limit);
  return Trajectory();
}
void Slam::CutFinishShort() { impl_->pipeline().workers().CutShort(); }

}  // namespace alidade
