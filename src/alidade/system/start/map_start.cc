#include "alidade/system/start/map_start.h"

#include <utility>

#include "alidade/features/subset.h"
#include "alidade/system/movers.h"

namespace alidade {
namespace {

constexpr int kInformative = 100;  // keypoints of an image that shows something, of 1000

TrackResult Refused(TrackFailure failure) {
  TrackResult result;
  result.failure = failure;
  return result;
}

// `T_world_camera`: of the frame in the new map, of which it is a keyframe with `matches`
// landmarks.
TrackResult Started(int matches, const Se3& T_world_camera) {
  TrackResult result;
  result.state = TrackState::kTracking;
  result.keyframe = true;
  result.matches = matches;
  result.T_world_camera = T_world_camera;
  result.quality.expected = result.quality.inliers = matches;
  result.quality.found_share = 1;
  result.quality.probability = Probability(kStartLogOdds);
  return result;
}

}  // namespace

bool MapStart::MayStart(const PresentFrame& now, double steady, int first_number) {
  Session& session = parts_.session;
  if (session.state() == SessionState::kSeeking) return true;
  const SlamSettings& settings = parts_.settings;
  const double informative = kInformative * settings.tracker.match_scale;
  if (static_cast<double>(now.frame->keypoints.size()) >= informative)
    session.CountInformativeFrame();
  const bool long_lost = steady - session.lost_since() >= settings.new_map_seconds &&
                         session.informative_frames() >= settings.new_map_frames;
  const bool may_start = parts_.workers.MayMap();
  if (long_lost && may_start) {
    LeaveMap(first_number);
    return true;
  }
  // If another map starts later, it may show this place, too.
  if (settings.sensor == Sensor::kMono && may_start) parts_.early.Wait(*now.frame, now.index);
  return false;
}

// A map of few keyframes is dropped: it would be mistaken for other places. A loaded one is kept.
void MapStart::LeaveMap(int first_number) {
  parts_.session.Apply(SessionEvent::kLostForLong);
  const MapSnapshot map = parts_.workers.map().Snapshot();
  const MapId left = map.MapOf(parts_.tracker.reference());
  if (!left.valid()) return;
  const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(left);
  const bool loaded = map.Find(keyframes.front())->frame->number < first_number;
  if (!loaded && static_cast<int>(keyframes.size()) < parts_.settings.min_map_keyframes)
    parts_.workers.Drop(left);
}

TrackResult MapStart::Start(PresentFrame& now, const Camera& camera) {
  if (parts_.movers.on()) {
    now.placed.frame = std::make_shared<Frame>(*now.frame);
    const cv::Mat glance = now.frame->glance;
    *now.frame = KeypointSubset(*now.frame, MappableKeypoints(*now.frame), camera);
    now.frame->glance = glance;
  }
  if (!parts_.workers.MayMap()) return Refused(TrackFailure::kMappingStopped);
  return parts_.settings.sensor == Sensor::kMono ? StartWithMotion(now, camera)
                                                 : StartWithDepth(now, camera);
}

TrackResult MapStart::StartWithDepth(PresentFrame& now, const Camera& camera) {
  const Mapper& mapper = parts_.workers.mapper();
  int with_depth = 0, landmarks = 0;
  for (const Keypoint& keypoint : now.frame->keypoints) {
    with_depth += keypoint.has_depth();
    landmarks += mapper.MakesLandmark(keypoint);
  }
  const double enough = parts_.settings.start.min_depth_landmarks *
                        parts_.settings.start.match_scale * now.features_left;
  if (landmarks < enough)
    return Refused(with_depth < enough ? TrackFailure::kFewDepths : TrackFailure::kFewNearDepths);
  PlacedFrame placed;
  placed.frame = now.frame;
  placed.inliers = landmarks;
  parts_.session.Apply(SessionEvent::kDepthStart);
  parts_.placer.InsertKeyFrame(now, placed, Anchor{}, camera);
  parts_.kept.MapStarted(camera, parts_.workers.map().Snapshot().MapOf(now.keyframe));
  return Started(landmarks, placed.T_camera_world.Inverse());
}

TrackResult MapStart::StartWithMotion(PresentFrame& now, const Camera& camera) {
  const auto begun = parts_.young.Begin(now.frame);
  if (!begun) {
    parts_.early.Wait(*now.frame, now.index);
    return Refused(parts_.young.failure());
  }
  parts_.session.Apply(SessionEvent::kTwoViewStart);
  if (!begun->holds) {
    parts_.session.Apply(SessionEvent::kMapRefused);
    return Refused(TrackFailure::kNotConfirmed);
  }
  parts_.tracker.KeyFrameInserted(now.frame->number);
  parts_.early.Begin(begun->map.MapOf(begun->id), now.frame->number);
  parts_.kept.MapStarted(camera, begun->map.MapOf(begun->id));
  parts_.placer.Place(now, begun->placed, begun->id, begun->map);
  now.keyframe = begun->id;
  return Started(begun->placed.inliers, begun->placed.T_camera_world.Inverse());
}

}  // namespace alidade
