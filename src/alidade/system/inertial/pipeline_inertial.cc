// What FramePipeline does with the readings of an inertial sensor.
#include <optional>
#include <utility>

#include "alidade/system/frame_pipeline.h"

namespace alidade {

void FramePipeline::SetImu(const ImuModel& imu) {
  inertial_.SetImu(imu);
  inertial_shown_.Set(inertial_.report());
}

// One camera: the lengths of the map become meters, as soon as it is confirmed.
void FramePipeline::UseInertial() {
  if (!inertial_.given() || session_.state() == SessionState::kConfirming) return;
  const auto growth = inertial_.UseAnswer(workers_.map().Snapshot());
  if (growth) workers_.Scale(growth->map, growth->factor);
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

// A pose for the fit of what the inertial sensor tells, which runs beside the other work.
void FramePipeline::Observe(double time, const PresentFrame& now) {
  if (!inertial_.given()) return;
  const MapSnapshot map = workers_.map().Snapshot();
  if (session_.state() == SessionState::kTracking && tracker_.IsLast(*now.frame)) {
    inertial_.Placed(time, AnchorTo(map.state(), tracker_.reference(), now.placed.T_camera_world),
                     map.MapOf(tracker_.reference()), now.placed.covariance);
  }
  if (auto question = inertial_.Ask(map)) {
    workers_.AddErrand(
        [this, question = std::move(*question)] { inertial_.Answer(AnswerOf(question)); });
  }
}

}  // namespace alidade
