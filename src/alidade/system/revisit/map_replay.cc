#include "alidade/system/revisit/map_replay.h"

#include <memory>
#include <new>

namespace alidade {
namespace {

constexpr int kMost = 3;  // per run: each time what is known of the camera is nearer to the truth

}  // namespace

bool MapReplay::Possible() const {
  if (!parts_.kept.CanRebuild() || count_ >= kMost) return false;
  const MapSnapshot map = parts_.workers.map().Snapshot();
  const MapId newest = map.MapOf(parts_.tracker.reference());
  if (!newest.valid() || newest != parts_.kept.map()) return false;
  // An older map may have been merged into it.
  const int first = map.Find(map.KeyFramesOf(newest).front())->frame->number;
  return first >= parts_.kept.frames().front().frame->number;
}

void MapReplay::Run(const std::function<void()>& change, const std::function<void(Frame&)>& adapt) {
  ++count_;
  const MapId newest = parts_.workers.map().Snapshot().MapOf(parts_.tracker.reference());
  parts_.session.Apply(SessionEvent::kRebuildStarted);
  if (!parts_.one_camera) parts_.workers.Drop(newest);  // YoungMap drops those of one camera
  parts_.workers.AwaitDrop();  // so that the dropped map is not adjusted to another camera
  change();
  try {
    const auto frames = parts_.kept.frames();  // a copy: an event during the replay may erase them
    for (const KeptFrames::Kept& kept : frames) Play(kept, adapt);
  } catch (const std::bad_alloc&) {
    parts_.young.ForgetViews();
  }
}

void MapReplay::Play(const KeptFrames::Kept& kept, const std::function<void(Frame&)>& adapt) {
  PresentFrame now;
  now.frame = std::make_shared<Frame>(*kept.frame);
  now.placed.frame = now.frame;
  now.index = kept.index;
  now.replayed = true;
  now.frame->static_probability.clear();  // estimated with the poses in the dropped map
  adapt(*now.frame);
  if (!kept.frame->keypoints.empty())
    now.features_left = static_cast<double>(now.frame->keypoints.size()) /
                        static_cast<double>(kept.frame->keypoints.size());
  const TrackResult result = process_(now);
  if (parts_.session.state() != SessionState::kSeeking) now.frame->glance.release();
  if (parts_.one_camera && result.state == TrackState::kTracking)
    parts_.early.Tracked(*now.frame, now.index);
  parts_.workers.AwaitMapping();
}

}  // namespace alidade
