// What FramePipeline does with the readings of an inertial sensor.
#include <optional>
#include <utility>

#include "alidade/base/part_times.h"
#include "alidade/system/frame_pipeline.h"

namespace alidade {

void FramePipeline::SetImu(const ImuModel& imu) {
  inertial_.SetImu(imu);
  orientation_.SetImu(imu);
  inertial_shown_.Set(inertial_.report());
}

// One camera: the lengths of the map become meters, as soon as it is confirmed, and a map that the
// camera started after it had been lost is joined to the one before.
void FramePipeline::UseInertial(std::span<const ImuSample> readings) {
  const PartTimer timer(FramePart::kInertial);
  inertial_.Take(readings);
  if (!inertial_.given() || session_.state() == SessionState::kConfirming) return;
  const InertialWatch::Changes changes = inertial_.UseAnswer(workers_.map().Snapshot());
  if (changes.growth) workers_.Scale(changes.growth->map, changes.growth->factor);
  if (changes.join) {
    const auto& [younger, older, T_older_younger, anchor] = *changes.join;
    workers_.Join(younger, older, T_older_younger, anchor);
  }
  KeepWorld();
  inertial_shown_.Set(inertial_.report());
}

// What is known of the map's world is kept in the map, and saved with it. A map that is only
// localized in keeps what it knew.
void FramePipeline::KeepWorld() {
  const std::optional<MapWorld> world = inertial_.World();
  if (!world) return;
  const MapSnapshot map = workers_.map().Snapshot();
  const MapWorld* kept = map.WorldOf(world->map);
  if (kept && (*kept == *world || settings_.localize)) return;
  workers_.map().Commit([&](MapCommit& commit) { commit.SetWorld(*world); });
}

// Keyframes get the motion since the one before; those whose readings turn out to be of no use lose
// it.
void FramePipeline::KeepMotions(const MapSnapshot& map) {
  const double hold_until = inertial_.MotionsHoldUntil();
  const bool fewer_hold = hold_until < std::exchange(motions_hold_until_, hold_until);
  const KeyFrameMotions::Motions motions = inertial_.MissingMotions(map);
  if (settings_.localize || (motions.empty() && !(fewer_hold && has_motions_))) return;
  has_motions_ = true;
  workers_.map().Commit([&](MapCommit& commit) {
    for (const auto& [id, motion] : motions) {
      KeyFrame* keyframe = commit.Edit(id);
      if (keyframe && commit.Find(motion->since)) keyframe->motion = motion;
    }
    if (!fewer_hold) return;
    for (KeyFrameId id : map.KeyFrames()) {
      const KeyFrame* keyframe = commit.Find(id);
      if (keyframe && keyframe->motion && keyframe->frame->time > hold_until)
        commit.Edit(id)->motion.reset();
    }
  });
}

// A map was split off another one because vision does not tell its scale.
void FramePipeline::ForgetUnit(MapId map) {
  workers_.map().Commit([&](MapCommit& commit) { commit.ForgetWorld(map); });
  inertial_.ForgetUnit(map);
}

// A pose for the fit of what the inertial sensor tells, which runs beside the other work.
void FramePipeline::Observe(double time, const PresentFrame& now) {
  if (!inertial_.given()) return;
  const PartTimer timer(FramePart::kInertial);
  const MapSnapshot map = workers_.map().Snapshot();
  if (session_.state() == SessionState::kTracking && tracker_.IsLast(*now.frame)) {
    inertial_.Placed(time, AnchorTo(map.state(), tracker_.reference(), now.placed.T_camera_world),
                     now.placed.covariance, map);
  }
  KeepMotions(map);
  if (auto question = inertial_.Ask(map)) {
    workers_.AddErrand(
        [this, question = std::move(*question)] { inertial_.Answer(AnswerOf(question)); });
  }
}

// How the camera is oriented with respect to gravity and to the first frame.
std::optional<CameraOrientation> FramePipeline::Orient(double time, const PresentFrame& now,
                                                       const TrackResult& result) {
  if (!inertial_.given() || !inertial_.report().left_out.empty()) return std::nullopt;
  std::optional<OrientationWatch::MapPose> pose;
  const MapSnapshot map = workers_.map().Snapshot();
  const MapId in = map.MapOf(tracker_.reference());
  if (result.state == TrackState::kTracking && in.valid()) {
    const MapWorld* world = map.WorldOf(in);
    pose = {in, result.T_world_camera.R, result.quality.covariance.bottomRightCorner<3, 3>(),
            world && world->KnowsDown() ? std::optional(*world) : std::nullopt};
  }
  return orientation_.See(*now.frame, camera_, time, inertial_.samples(), pose);
}

// Tells where a frame that does not follow a tracked one is by dead reckoning.
void FramePipeline::Reckon(double time, const MapSnapshot& map) {
  const auto reckoned = inertial_.DeadReckoned(time, map);
  tracker_.SetReckoned(
      time, reckoned ? std::optional(reckoned->pose.T_world_camera.Inverse()) : std::nullopt);
  relocalizer_.SetReckoned(reckoned);
}

}  // namespace alidade
