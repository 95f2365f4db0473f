#include "alidade/system/revisit/relocalizer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "alidade/features/subset.h"
#include "alidade/map/reach.h"
#include "alidade/map/view.h"
#include "alidade/system/movers.h"

namespace alidade {
namespace {

constexpr size_t kCandidates = 5;     // keyframes tried for each frame
constexpr int kMotionHistory = 3600;  // frames of the past trajectory used by the motion gate

bool Contains(const std::vector<MapId>& maps, MapId map) {
  return std::find(maps.begin(), maps.end(), map) != maps.end();
}

}  // namespace

Relocalizer::Found Relocalizer::Find(const std::shared_ptr<const Frame>& frame,
                                     const MapSnapshot& map, bool lost) const {
  if (std::isfinite(tracker_.last_time()) && tracker_.PredictedPose(frame->time, map)) {
    TrackEstimate estimate = tracker_.GoOn(frame, map);
    if (estimate.tracked) return {std::move(estimate), true};
  }
  const auto may_be = [&](const TrackEstimate& found) { return CanBeThere(found, map); };
  return {tracker_.Relocalise(frame, map, PlacesLike(*frame, map, lost), may_be), false};
}

// The motion gate: whether the camera can have moved to the found place since it was last seen in
// the same map (DoubtOf()). Guards against places that look alike.
bool Relocalizer::CanBeThere(const TrackEstimate& found, const MapSnapshot& map) const {
  const ReachSettings& settings = settings_.loop.reach;
  const double share =
      found.placed.inliers / std::max<double>(1, static_cast<double>(found.sightings.size()));
  if (share >= settings.plain_share) return true;
  const MapId in = map.MapOf(found.reference);
  const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(in);
  const double gone = settings_.localize ? 0 : WayBetween(map, keyframes.back(), found.reference);
  if (reckoned_ && found.placed.frame->time == reckoned_->pose.time && in == reckoned_->map)
    return AgreesWithReckoned(found.placed, settings.drift * gone);
  // The trajectory is relative to the current map: useless if that was corrected since `map`.
  if (workers_.map().Snapshot().corrections() != map.corrections()) return false;
  std::vector<TimedPlace> trajectory;
  MapId last;
  const std::vector<MapId> dropped = workers_.dropped();
  for (const FramePose& frame :
       log_.Trajectory(workers_.map(), std::max(0, log_.size() - kMotionHistory))) {
    if (!frame.tracked || frame.recording != log_.recording() || Contains(dropped, frame.map))
      continue;
    last = frame.map;
    if (last == in) trajectory.push_back({frame.time, frame.T_world_camera.t});
  }
  if (last.valid() && last != in) return share >= settings.elsewhere_share;
  const TimedPlace here{found.placed.frame->time, found.placed.T_camera_world.Inverse().t};
  const double depth = MedianDepth(map, *map.Find(found.reference)).value_or(0);
  return share >= settings.plain_share * DoubtOf(trajectory, here, depth, gone, settings);
}

// Whether the position is within its own error, that of dead reckoning and the drift of the map:
// chi², 99.9 %.
bool Relocalizer::AgreesWithReckoned(const PlacedFrame& placed, double drift) const {
  constexpr double kChiSquared3 = 16.3;
  const TimedPose& pose = reckoned_->pose;
  const Se3 T_reckoned_found = pose.T_world_camera.Inverse() * placed.T_camera_world.Inverse();
  const Eigen::Matrix3d& R = T_reckoned_found.R;
  Eigen::Matrix3d covariance = pose.covariance.topLeftCorner<3, 3>() +
                               R * placed.covariance.topLeftCorner<3, 3>() * R.transpose();
  covariance.diagonal().array() += drift * drift;
  const Eigen::Vector3d& gap = T_reckoned_found.t;
  return gap.dot(covariance.llt().solve(gap)) < kChiSquared3;
}

// Keyframes that may show what the frame shows: the last tracked one, then the most similar ones.
std::vector<KeyFrameId> Relocalizer::PlacesLike(const Frame& frame, const MapSnapshot& map,
                                                bool lost) const {
  std::vector<KeyFrameId> candidates;
  if (lost && map.Find(tracker_.reference())) candidates.push_back(tracker_.reference());
  const std::vector<MapId> dropped = workers_.dropped();
  const auto may_be = [&](KeyFrameId id) {
    const KeyFrame* keyframe = map.Find(id);
    return keyframe && (candidates.empty() || id != candidates[0]) &&
           !Contains(dropped, keyframe->map);
  };
  const Frame still = KeypointSubset(frame, MappableKeypoints(frame), tracker_.camera());
  for (const PlaceMatch& match : workers_.places().Query(still, may_be, kCandidates))
    candidates.push_back(match.id);
  return candidates;
}

}  // namespace alidade
