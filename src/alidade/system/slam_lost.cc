// A frame without a pose: where the camera goes on, is found again, or begins another map.
// slam_impl.h says what else is where.
#include <algorithm>

#include "alidade/features/subset.h"
#include "alidade/map/view.h"
#include "alidade/system/movers.h"
#include "alidade/system/slam_impl.h"

namespace alidade {
namespace {

constexpr size_t kRelocaliseCandidates = 5;  // keyframes tried for each frame while lost
constexpr int kReachFrames = 3600;           // before a frame, that are looked back at

}  // namespace

// Known places first, the one the motion leads to before all others; a new map only where none is
// known, or none was recognised for long.
TrackResult Slam::Impl::FindBack(const std::shared_ptr<Frame>& frame) {
  const MapSnapshot map = workers_.map().Snapshot();
  movers_.Judge(*frame, nullptr);
  if (map.keyframe_count() > 0) {
    const Stopwatch watch;
    const bool goes_on = tracker_.PredictedPose(frame->time, map).has_value();
    if (goes_on) {
      TrackEstimate estimate = tracker_.GoOn(frame, map);
      if (estimate.tracked) {
        track_ms_.Add(watch.Milliseconds());
        return FoundBack(std::move(estimate), map);
      }
    }
    const auto may_be = [&](const TrackEstimate& found) { return CanBeThere(found, map); };
    TrackEstimate estimate = tracker_.Relocalise(frame, map, PlacesLike(*frame, map), may_be);
    track_ms_.Add(watch.Milliseconds());
    if (estimate.tracked) {
      tracker_.Forget();  // the motion that was, led elsewhere
      return FoundBack(std::move(estimate), map);
    }
  }
  if (state_ == TrackState::kLost) {
    const auto sighted = 100 * settings_.tracker.match_scale;  // corners
    lost_sighted_ += static_cast<double>(frame->keypoints.size()) >= sighted;
    const bool long_lost = clock_.steady() - lost_since_ >= settings_.new_map_seconds &&
                           lost_sighted_ >= settings_.new_map_frames;
    const bool may_begin = !settings_.localise && !workers_.mapping_stopped();
    if (!long_lost || !may_begin) {
      // Should another map begin, it may show this place, too.
      if (settings_.sensor == Sensor::kMono && may_begin) early_.Wait(*frame, Index());
      return WithoutPose("the place was not recognised", frame->time, map);
    }
    LeaveMap();
  }
  return Start(frame);
}

// Against taking a place for another that looks like it: whether the camera can have come there
// since it was last seen in the same map (DoubtOf()).
bool Slam::Impl::CanBeThere(const TrackEstimate& found, const MapSnapshot& map) const {
  const ReachSettings& settings = settings_.loop.reach;
  const double share =
      found.placed.inliers / std::max<double>(1, static_cast<double>(found.sightings.size()));
  if (share >= settings.plain_share) return true;
  // The log speaks of the map as it is now: corrected meanwhile, it is no measure for this frame.
  if (workers_.map().Snapshot().corrections() != map.corrections()) return false;
  const MapId in = map.MapOf(found.reference);
  std::vector<TimedPlace> way;
  MapId last;
  const std::vector<MapId> dropped = workers_.dropped();
  for (const FramePose& frame :
       log_.Trajectory(workers_.map(), std::max(0, log_.size() - kReachFrames))) {
    if (!frame.tracked || frame.recording != log_.recording() ||
        std::find(dropped.begin(), dropped.end(), frame.map) != dropped.end())
      continue;
    last = frame.map;
    if (last == in) way.push_back({frame.time, frame.T_world_camera.t});
  }
  if (last.valid() && last != in) return share >= settings.elsewhere_share;
  const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(in);
  const double gone = settings_.localise ? 0 : WayBetween(map, keyframes.back(), found.reference);
  const TimedPlace here{found.placed.frame->time, found.placed.T_camera_world.Inverse().t};
  const double depth = MedianDepth(map, *map.Find(found.reference)).value_or(0);
  return share >= settings.plain_share * DoubtOf(way, here, depth, gone, settings);
}

// Keyframes that may show what a frame shows: the last one first, then by descriptors.
std::vector<KeyFrameId> Slam::Impl::PlacesLike(const Frame& frame, const MapSnapshot& map) {
  std::vector<KeyFrameId> candidates;
  if (state_ == TrackState::kLost && map.Find(tracker_.reference()))
    candidates.push_back(tracker_.reference());
  const std::vector<MapId> dropped = workers_.dropped();
  const auto may_be = [&](KeyFrameId id) {
    const KeyFrame* keyframe = map.Find(id);
    return keyframe && (candidates.empty() || id != candidates[0]) &&
           std::find(dropped.begin(), dropped.end(), keyframe->map) == dropped.end();
  };
  const Frame still = KeypointSubset(frame, MappableKeypoints(frame), camera_);
  for (const PlaceMatch& match : workers_.places().Query(still, may_be, kRelocaliseCandidates)) {
    candidates.push_back(match.id);
  }
  return candidates;
}

// A place just found again is confirmed by the frames after it before the map grows on it.
TrackResult Slam::Impl::FoundBack(TrackEstimate estimate, const MapSnapshot& map) {
  ++relocalisations_;
  if (orphan_.index + 1 == Index() && orphan_.map == map.MapOf(estimate.reference))
    log_.PlaceLate(orphan_.index, orphan_.anchor);
  young_.Reset();
  early_.ForgetWaiting();
  tracker_.KeyFrameInserted(estimate.placed.frame->number);
  estimate.wants_keyframe = false;
  return Accept(std::move(estimate), map);
}

TrackResult Slam::Impl::WithoutPose(const char* reason, double time, const MapSnapshot& map) {
  TrackResult result;
  result.state = state_;
  result.reason = reason;
  if (const auto T_camera_world = tracker_.PredictedPose(time, map)) {
    result.predicted = true;
    result.T_world_camera = T_camera_world->Inverse();
    ++predicted_;
  }
  return result;
}

void Slam::Impl::Lose() {
  tracker_.Lose();
  state_ = TrackState::kLost;
  lost_since_ = clock_.steady();
  lost_sighted_ = 0;
}

// A known place is looked for from now on, or another map begins.
void Slam::Impl::ForgetWhere() {
  state_ = TrackState::kInitialising;
  kept_.clear();
  young_.Reset();
  tracker_.Forget();
}

// A map of a few keyframes is worth less than the confusion it makes; one that was loaded is kept.
void Slam::Impl::LeaveMap() {
  ForgetWhere();
  const MapSnapshot map = workers_.map().Snapshot();
  const MapId left = map.MapOf(tracker_.reference());
  if (!left.valid()) return;
  const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(left);
  const bool loaded = map.Find(keyframes.front())->frame->number < first_number_;
  if (!loaded && static_cast<int>(keyframes.size()) < settings_.min_map_keyframes)
    workers_.Drop(left);
}

// What one camera mapped while its scale was not known goes, and the poses told by it
// (MapperSettings::min_known_scale): another map must be proved by parallax, as each is.
bool Slam::Impl::LeavesUnknownScale() {
  const MapId unknown = workers_.TakeUnknownScale();
  if (!unknown.valid()) return false;
  const MapSnapshot map = workers_.map().Snapshot();  // with the split, which came first
  const bool there = map.MapOf(tracker_.reference()) == unknown;
  if (there) {
    early_.ForgetWaiting();
    ForgetWhere();
  }
  KeepFramesBetween(unknown);
  workers_.Drop(unknown);
  return there;
}

// A keyframe hangs on itself, frames beside it on the keyframe that shares most landmarks with
// them: where those stay placed when the map `gone` goes, so does the keyframe's own frame, told by
// the keyframe they hang on. The newest one's stays where the next frame is found beside it.
void Slam::Impl::KeepFramesBetween(MapId gone) {
  const MapSnapshot map = workers_.map().Snapshot();
  const std::vector<FramePose> frames =
      log_.Trajectory(workers_.map(), std::max(0, log_.size() - kReachFrames));
  for (size_t i = 1; i < frames.size(); ++i) {
    const FramePose &before = frames[i - 1], &frame = frames[i];
    if (frame.map != gone || !before.tracked || before.map == gone) continue;
    const Anchor anchor = AnchorTo(map.state(), before.reference, frame.T_world_camera.Inverse());
    if (i + 1 == frames.size()) {
      orphan_ = {frame.index, anchor, before.map};
    } else if (frames[i + 1].map == before.map) {
      log_.PlaceLate(frame.index, anchor);
    }
  }
}

}  // namespace alidade
