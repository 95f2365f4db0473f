// What comes before the first and after the last frame of FramePipeline.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/map/map_file.h"
#include "alidade/system/frame_pipeline.h"
#include "alidade/system/prepare.h"

namespace alidade {
namespace {

constexpr int kLastCameraQueries = 3;  // in Finish(): each change makes the next one smaller

}  // namespace

void FramePipeline::BeginRecording() {
  log_.BeginRecording();
  workers_.BeginRecording();
}

void FramePipeline::Forget() {
  session_.Apply(SessionEvent::kMapLeft);
  workers_.AwaitPlace();
  for (MapId map : workers_.map().Snapshot().Maps()) workers_.Drop(map);
  workers_.AwaitDrop();
}

// Poses are found by landmarks, which are points in the world: any camera will do. The keyframes of
// a growing map share one camera.
void FramePipeline::CheckMapFits(const SavedMap& saved) const {
  const std::string sensor = NameOf(settings_.sensor);
  if (settings_.localize) {
    if (saved.sensor == NameOf(Sensor::kMono) && saved.sensor != sensor)
      ThrowInput("the map was made with one camera, and its unit need not be the meter: " + sensor +
                 " does not fit to it; use one camera here, too (--sensor mono)");
    return;
  }
  constexpr char kAny[] =
      ". A map grows by its own camera only; `alidade localize` and `alidade serve` find the poses "
      "of any other in it";
  try {
    CheckSameCamera(saved.camera, camera_);
  } catch (const Error& error) {
    ThrowInput(error.what() + std::string(kAny));
  }
  if (saved.sensor != sensor)
    ThrowInput("the map was made with a " + saved.sensor + " camera, but this is " + sensor + kAny);
}

void FramePipeline::Load(const SavedMap& saved) {
  if (!log_.empty()) ThrowUsage("a map must be loaded before the first frame");
  CheckMapFits(saved);
  workers_.Restore(saved);
  const std::vector<KeyFrameId> keyframes = saved.map.KeyFrames();
  int number = first_number_;
  for (KeyFrameId id : keyframes) number = std::max(number, saved.map.Find(id)->frame->number + 1);
  first_number_ = number;
  if (!keyframes.empty()) session_.Apply(SessionEvent::kMapLoaded);
}

void FramePipeline::Finish(double limit) {
  const bool limited = std::isfinite(limit);
  workers_.FinishWithin(limit, [&] { FinishWork(limited); });
}

void FramePipeline::FinishWork(bool limited) {
  EndFrame();
  workers_.Drain();
  PresentFrame last;
  TakeNews();
  if (std::exchange(more_left_out_, false) && !limited)
    LeaveOutFixedParts(NumberOf(log_.size() - 1));
  DropUnknownScale(last);
  if (last.map_left) workers_.Drain();
  if (session_.has_pose() && young_.WantsGlance(NumberOf(log_.size() - 1)) && young_.StoodStill()) {
    session_.Apply(SessionEvent::kMapRefused);
    workers_.Drain();
  }
  // The camera that all frames together support. Not where time is limited.
  const bool use_camera = settings_.refine.enabled && !limited;
  for (int i = 0; i < kLastCameraQueries && use_camera && !workers_.cut(); ++i) {
    workers_.AskForCamera();
    TakeNews();
    if (!news_.camera || session_.state() == SessionState::kConfirming) break;
    UseCamera();
  }
  DropUnknownScale(last);
  LocalizeEarlierFrames(settings_.early.max_frames, std::numeric_limits<int>::max());
}

}  // namespace alidade
