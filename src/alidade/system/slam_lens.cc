// The camera that was given turns out to be another. slam_impl.h says what else is where.
#include <memory>
#include <new>
#include <utility>

#include "alidade/features/undistort.h"
#include "alidade/map/camera_estimate.h"
#include "alidade/system/slam_impl.h"

namespace alidade {
namespace {

constexpr int kMostAnew = 3;  // times a run is begun anew: each answer is nearer the truth

}  // namespace

// The map has told of another camera than it is made with: all is changed to that between two
// frames. Whether it was.
bool Slam::Impl::RefineCamera() {
  if (!settings_.refine.enabled || young_.on_trial()) return false;
  const std::optional<Camera> found = workers_.lens_watch().Take();
  if (!found) return false;
  if (KeepsFrames() && !kept_.empty() && state_ == TrackState::kTracking &&
      begun_anew_ < kMostAnew && Apart(begun_with_, *found) > settings_.refine.begin_anew) {
    BeginAnew(*found);
  } else {
    ChangeCamera(*found);
  }
  ++camera_changes_;
  return true;
}

void Slam::Impl::ChangeCamera(const Camera& camera) {
  workers_.ChangeCamera(camera_, camera);
  {
    const std::lock_guard<std::mutex> lock(camera_mutex_);
    camera_ = camera;
  }
  tracker_.SetCamera(camera_);
  movers_.SetCamera(camera_);
  young_.SetCamera(camera_, workers_.lens_watch().found()->focal_sigma);
  early_.SetCamera(camera_);
}

// The map is dropped, and made again from the features of the frames it was made of: as a second
// pass over them would make it. Their pictures are gone: keyframes among them have no dense depth.
// Where memory runs out the map is of the frames until then, and goes on.
void Slam::Impl::BeginAnew(const Camera& camera) {
  ++begun_anew_;
  GiveUpStart("");
  early_.ForgetWaiting();
  workers_.AwaitDrop();  // or it would be changed and adjusted as well
  ChangeCamera(camera);
  workers_.AskAnew();
  tracker_.SetReadout(workers_.readout());
  try {
    for (const KeptFrame& kept : kept_) TrackAgain(kept);
  } catch (const std::bad_alloc&) {
    young_.Reset();
  }
}

void Slam::Impl::TrackAgain(const KeptFrame& kept) {
  const auto frame = std::make_shared<Frame>(*kept.frame);
  UndistortKeypoints(camera_, *frame);
  frame->motion.setZero();
  again_ = kept.index;
  const struct Reset {
    int& index;
    ~Reset() { index = -1; }
  } reset{again_};
  const TrackResult result = state_ == TrackState::kTracking ? Continue(frame) : FindBack(frame);
  if (state_ != TrackState::kInitialising) frame->glance.release();
  if (result.state == TrackState::kTracking) early_.Tracked(*frame, again_);
  workers_.AwaitMapping();
}

// Dynamics judge by pictures, which are not kept.
bool Slam::Impl::KeepsFrames() const {
  return settings_.refine.enabled && settings_.sensor == Sensor::kMono && keeps_ &&
         settings_.refine.keep_frames > 0 && !movers_.on() && first_number_ == 0;
}

// Those before the start are kept as well, as many as there is room for: the start may come earlier
// with the right camera.
void Slam::Impl::KeepFrame(const Frame& frame) {
  if (!KeepsFrames()) return;
  const bool waits = state_ == TrackState::kInitialising;
  if (static_cast<int>(kept_.size()) >= settings_.refine.keep_frames) {
    if (waits) {
      kept_.pop_front();
    } else {
      keeps_ = false;
      kept_.clear();
      return;
    }
  }
  auto kept = std::make_shared<Frame>(frame);
  kept->picture = nullptr;
  kept_.push_back({std::move(kept), log_.size() - 1});
}

}  // namespace alidade
