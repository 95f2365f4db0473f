// A map of the system is begun, loaded, given up or left.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/features/subset.h"
#include "alidade/map/map_file.h"
#include "alidade/system/movers.h"
#include "alidade/system/slam_impl.h"

namespace alidade {

TrackResult Slam::Impl::Start(const std::shared_ptr<Frame>& frame) {
  TrackResult result;
  if (workers_.mapping_stopped()) {
    result.reason = "mapping has stopped";
    return result;
  }
  if (movers_.on()) {
    last_.frame = std::make_shared<Frame>(*frame);
    const cv::Mat glance = frame->glance;
    *frame = KeypointSubset(*frame, MappableKeypoints(*frame), camera_);
    frame->glance = glance;
  }
  const bool started = settings_.sensor == Sensor::kMono ? StartWithMotion(frame, result)
                                                         : StartWithDepth(frame, result);
  if (!started) return result;
  state_ = TrackState::kTracking;
  result.state = state_;
  result.keyframe = true;
  result.T_world_camera = log_.T_world_camera_live();
  result.quality.expected = result.quality.inliers = result.matches;
  result.quality.found_share = 1;
  return result;
}

bool Slam::Impl::StartWithDepth(const std::shared_ptr<Frame>& frame, TrackResult& result) {
  const Mapper& mapper = workers_.mapper();
  int with_depth = 0;
  for (const Keypoint& keypoint : frame->keypoints) {
    with_depth += keypoint.has_depth();
    result.matches += mapper.MakesLandmark(keypoint);
  }
  const double enough = settings_.start.min_depth_landmarks * settings_.start.match_scale;
  if (result.matches < enough) {
    result.reason = with_depth < enough ? "too few corners with depth in the sensor's range"
                                        : "too few corners near enough for the sensor to place";
    result.matches = 0;
    return false;
  }
  PlacedFrame placed;
  placed.frame = frame;
  placed.inliers = result.matches;
  tracker_.Forget();
  AddKeyFrame(placed, Anchor{});
  return true;
}

bool Slam::Impl::StartWithMotion(const std::shared_ptr<Frame>& frame, TrackResult& result) {
  const auto begun = young_.Begin(frame);
  if (!begun) {
    early_.Wait(*frame, Index());
    result.reason = young_.reason();
    return false;
  }
  if (!begun->holds) {
    result = GiveUpStart("the first points did not hold");
    return false;
  }
  tracker_.KeyFrameInserted(frame->number);
  early_.Begin(begun->map.MapOf(begun->id), frame->number);
  begun_with_ = camera_;
  Place(begun->placed, begun->id, begun->map);
  last_keyframe_ = begun->id;
  result.matches = begun->placed.inliers;
  return true;
}

TrackResult Slam::Impl::GiveUpStart(const char* reason) {
  young_.GiveUp();
  early_.GiveUp();
  tracker_.Forget();
  movers_.Forget();
  state_ = TrackState::kInitialising;
  TrackResult result;
  result.reason = reason;
  return result;
}

void Slam::Impl::Load(const SavedMap& saved) {
  const std::lock_guard<std::mutex> driving(driving_);
  if (!log_.empty()) ThrowUsage("a map is loaded before the first frame, not after");
  CheckSameCamera(saved.camera, camera_);
  if (saved.sensor != NameOf(settings_.sensor)) {
    ThrowInput("the map was made with a " + saved.sensor + " camera, this is " +
               NameOf(settings_.sensor));
  }
  workers_.Restore(saved);
  const std::vector<KeyFrameId> keyframes = saved.map.KeyFrames();
  for (KeyFrameId id : keyframes) {
    first_number_ = std::max(first_number_.load(), saved.map.Find(id)->frame->number + 1);
  }
  if (keyframes.empty()) return;
  state_ = TrackState::kLost;
  lost_since_ = -1e300;  // nothing was lost: only frames that show something must fail first
}

}  // namespace alidade
