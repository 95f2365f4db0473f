#include "alidade/system/frame_pipeline.h"

#include <algorithm>
#include <new>
#include <utility>

#include "alidade/base/part_times.h"
#include "alidade/system/movers.h"
#include "alidade/system/prepare.h"
#include "alidade/system/start/unknown_scale.h"

namespace alidade {
namespace {

// With depth, this many frames are kept, so that the map can be made anew when a part fixed to the
// camera is found: 3 s at 30 frames per second.
constexpr int kFixedPartsFrames = 90;
constexpr int kReanchorFrames = 300;  // period of Reanchor(): 10 s at 30 frames per second

TrackState PublicState(SessionState state) {
  switch (state) {
    case SessionState::kSeeking:
      return TrackState::kInitializing;
    case SessionState::kConfirming:
    case SessionState::kTracking:
      return TrackState::kTracking;
    case SessionState::kLost:
      break;
  }
  return TrackState::kLost;
}

PoseQuality QualityOf(const TrackEstimate& estimate, const MapSnapshot& map) {
  PoseQuality quality;
  quality.probability = Probability(estimate.placed.log_odds);
  quality.covariance = estimate.placed.covariance;
  const KeyFrame* reference = map.Find(estimate.reference);
  if (kCovariances && reference && !quality.covariance.isZero()) {
    // The map around the frame moves with its reference keyframe.
    quality.covariance +=
        Carried(estimate.placed.T_camera_world * reference->T_camera_world.Inverse(),
                reference->covariance);
  }
  quality.expected = static_cast<int>(estimate.sightings.size());
  quality.inliers = estimate.placed.inliers;
  if (quality.expected > 0)
    quality.found_share = static_cast<double>(quality.inliers) / quality.expected;
  return quality;
}

}  // namespace

FramePipeline::FramePipeline(const Camera& camera, const SlamSettings& settings,
                             const std::shared_ptr<Detector>& detector)
    : settings_(settings),
      camera_(camera),
      dense_(settings.semidense.enabled && !settings.localize),
      inertial_(settings.sensor, !settings.localize),
      orientation_(settings.start.match_scale),
      workers_(camera, settings),
      tracker_(camera, settings.tracker),
      movers_(camera, settings, detector),
      left_out_(camera, settings.fixed_parts),
      young_(camera, settings, workers_),
      early_(settings.early),
      kept_(settings.sensor == Sensor::kMono ? settings.refine.keep_frames : kFixedPartsFrames),
      log_(settings.trajectory),
      session_({young_, early_, kept_, tracker_, movers_}),
      placer_(workers_, tracker_, movers_, log_),
      relocalizer_(settings, workers_, tracker_, log_),
      start_({settings, workers_, session_, young_, early_, kept_, tracker_, movers_, placer_}),
      replay_(
          {workers_, session_, young_, early_, kept_, tracker_, settings.sensor == Sensor::kMono},
          [this](PresentFrame& now) { return Localize(now); }),
      camera_update_({settings, camera_, camera_shown_, workers_, session_, young_, early_, kept_,
                      tracker_, movers_, left_out_, replay_}) {
  camera_shown_.Set(camera);
}

TrackResult FramePipeline::Process(const FrameInput& prepared, double time) {
  session_.BeginFrame();
  steady_ = prepared.time;
  PresentFrame now;
  now.index = log_.size() - 1;
  UseNews(now);
  UseInertial(prepared.imu);
  movers_.Begin(prepared, NumberOf(now.index), session_.has_pose() && TrustsFocalLength(),
                young_.WantsGlance(NumberOf(now.index)));
  tracker_.SetReadout(workers_.readout());
  if (!AlignFrame(prepared, time, now)) ExtractFeatures(prepared, time, now);
  TrackResult result = Localize(now);
  Observe(time, now);
  result.orientation = Orient(time, now, result);
  if (now.map_left && result.state != TrackState::kTracking)
    result.failure = TrackFailure::kUnknownScale;
  KeepForLater(now, result);
  if (now.aligned) movers_.SeedCorners(left_out_.With({}));
  movers_.End(*now.placed.frame, result);
  more_left_out_ = left_out_.See(prepared.image, now.frame) || more_left_out_;
  Publish(now);
  if (settings_.sensor == Sensor::kMono && result.state != TrackState::kInitializing)
    LocalizeEarlierFrames(1, now.frame->number);
  if (log_.size() % kReanchorFrames == 0) Reanchor();
  return result;
}

// The pose of the frame: by motion after a tracked frame, by descriptors otherwise.
TrackResult FramePipeline::Localize(PresentFrame& now) {
  const MapSnapshot map = now.aligned ? now.aligned->map : workers_.map().Snapshot();
  TrackFailure failure = TrackFailure::kNotRecognized;
  if (session_.has_pose()) {
    TrackEstimate estimate =
        now.aligned ? std::move(now.aligned->estimate) : FollowMotion(now, map);
    failure = JudgeTracked(estimate, now, map);
    if (failure == TrackFailure::kNone) return Place(std::move(estimate), now, map);
  } else {
    TrackEstimate estimate = FindPlace(now, map);
    if (estimate.tracked) return Place(std::move(estimate), now, map);
    if (start_.MayStart(now, steady_, first_number_)) return start_.Start(now, camera_);
  }
  return WithoutPose(failure, now.frame->time, map);
}

// What the workers found since the last frame: another camera, maps without a known scale.
void FramePipeline::UseNews(PresentFrame& now) {
  const PartTimer timer(FramePart::kNews);
  TakeNews();
  // An unconfirmed map is too small to be changed to another camera.
  if (news_.camera && session_.state() != SessionState::kConfirming) UseCamera();
  if (std::exchange(more_left_out_, false)) LeaveOutFixedParts(NumberOf(now.index));
  DropUnknownScale(now);
}

void FramePipeline::TakeNews() {
  WorkerNews news = workers_.TakeNews();
  if (news.camera) news_.camera = std::move(news.camera);
  for (MapId map : news.unknown_scale) news_.unknown_scale.push_back(map);
}

void FramePipeline::UseCamera() {
  camera_update_.Apply(*std::exchange(news_.camera, std::nullopt));
  ++counts_.camera_changes;
  TakeNews();  // of keyframes that were mapped again
}

// Poses of the newest map may have followed the part: a young map of one camera is dropped, and one
// with depth is made anew without it. What was believed to move was the rest of the image.
void FramePipeline::LeaveOutFixedParts(int number) {
  const bool one_camera = settings_.sensor == Sensor::kMono;
  const bool in_young = session_.has_pose() && young_.WantsGlance(number) &&
                        workers_.map().Snapshot().MapOf(tracker_.reference()) == young_.map();
  if (one_camera ? !in_young : !replay_.Possible()) return;
  movers_.Restart();
  workers_.mapper().SetYoungStatic(settings_.mapper.young_static);
  if (one_camera) {
    session_.Apply(SessionEvent::kMapRefused);
  } else if (!movers_.on()) {  // they need images, which are not kept
    replay_.Run([] {}, [this](Frame& frame) { left_out_.RemoveFrom(frame, camera_); });
  }
}

// Drops maps that one camera made while their scale was unknown, and the poses in them
// (MapperSettings::min_known_scale). The next map must prove its parallax, as every map. With an
// inertial sensor they are kept: it will tell their scale.
void FramePipeline::DropUnknownScale(PresentFrame& now) {
  for (MapId unknown : std::exchange(news_.unknown_scale, {})) {
    if (inertial_.TellsScale(unknown)) {
      ForgetUnit(unknown);
      continue;
    }
    if (workers_.map().Snapshot().MapOf(tracker_.reference()) == unknown) {
      session_.Apply(SessionEvent::kMapLeft);
      now.map_left = true;
    }
    if (auto newest = ReattachFrames(unknown, workers_.map(), log_)) now.reattachment = newest;
    workers_.Drop(unknown);
  }
}

// Pose from an even motion and the local map (ORB-SLAM §V-B to D).
TrackEstimate FramePipeline::FollowMotion(PresentFrame& now, const MapSnapshot& map) {
  const Stopwatch watch;
  tracker_.SetTurn(now.frame->time, inertial_.TurnBetween(tracker_.last_time(), now.frame->time));
  tracker_.UndoShutter(*now.frame, map);
  PlacedFrame guess = tracker_.Predict(now.frame, map);
  const double predicting = watch.Milliseconds();
  const PoseGuess where = GuessOf(guess, tracker_.reference(), map);
  movers_.Judge(*now.frame, &where);
  const Stopwatch estimating;
  TrackEstimate estimate = tracker_.Estimate(std::move(guess), map);
  if (estimate.tracked) {
    tracker_.UndoShutter(*now.frame, estimate, map);
    WatchReadout(estimate, map);
  }
  track_ms_.Add(predicting + estimating.Milliseconds());
  return estimate;
}

TrackEstimate FramePipeline::FindPlace(PresentFrame& now, const MapSnapshot& map) {
  tracker_.SetTurn(now.frame->time, inertial_.TurnBetween(tracker_.last_time(), now.frame->time));
  Reckon(now.frame->time, map);
  movers_.Judge(*now.frame, nullptr);
  if (map.keyframe_count() == 0) return {};
  const Stopwatch watch;
  Relocalizer::Found found =
      relocalizer_.Find(now.frame, map, session_.state() == SessionState::kLost);
  track_ms_.Add(watch.Milliseconds());
  if (!found.estimate.tracked) return {};
  ++counts_.relocalizations;
  if (now.reattachment && now.reattachment->index + 1 == now.index &&
      now.reattachment->map == map.MapOf(found.estimate.reference))
    log_.PlaceLate(now.reattachment->index, now.reattachment->anchor);
  session_.Apply(found.by_motion ? SessionEvent::kPoseResumed : SessionEvent::kRelocalized);
  tracker_.KeyFrameInserted(now.frame->number);
  found.estimate.wants_keyframe = false;  // the frames after it confirm the place first
  return std::move(found.estimate);
}

// Whether the pose of a frame that follows a tracked one is believed. kNone: it is.
TrackFailure FramePipeline::JudgeTracked(const TrackEstimate& estimate, const PresentFrame& now,
                                         const MapSnapshot& map) {
  const PartTimer timer(FramePart::kNews);
  const auto refuse = [&](TrackFailure failure) {
    session_.Apply(SessionEvent::kMapRefused);
    return failure;
  };
  if (session_.state() == SessionState::kConfirming) {
    if (!young_.Confirm(estimate)) return refuse(TrackFailure::kNotConfirmed);
    if (young_.confirmed()) session_.Apply(SessionEvent::kMapConfirmed);
  }
  const bool young = young_.IsYoung(*now.frame, tracker_.reference(), map);
  if (FollowsMovingObject(young) && young) return refuse(TrackFailure::kMovingStart);
  if (!estimate.tracked) {
    session_.Apply(SessionEvent::kPoseLost, steady_);
    return TrackFailure::kFewLandmarks;
  }
  if (settings_.sensor == Sensor::kMono && young && young_.StandsStill(estimate.placed))
    return refuse(TrackFailure::kStillCamera);
  return TrackFailure::kNone;
}

// Whether the last poses follow a moving object. With dynamics.mode auto moving objects may be left
// out from this frame on.
bool FramePipeline::FollowsMovingObject(bool young) {
  const bool left_out = movers_.on();
  const bool follows = movers_.FollowsMover(young);
  if (follows && !young) movers_.Forget();  // it was learned with wrong poses
  if (movers_.on() && !left_out && settings_.dynamics.weigh)
    workers_.mapper().SetYoungStatic(kYoungStatic);
  return follows;
}

TrackResult FramePipeline::Place(TrackEstimate estimate, PresentFrame& now,
                                 const MapSnapshot& map) {
  const PartTimer timer(FramePart::kPlace);
  TrackResult result;
  result.state = TrackState::kTracking;
  // Keyframes the mapper has not processed yet, at most. With depth, tracking relies on the newest
  // keyframes, so more may queue.
  const int max_backlog = settings_.sensor == Sensor::kMono ? 1 : 2;
  result.keyframe = estimate.wants_keyframe && session_.state() != SessionState::kConfirming &&
                    workers_.MayMap() && HoldsWithoutMovers(estimate.placed);
  result.keyframe = result.keyframe && workers_.backlog() <= max_backlog;
  if (workers_.MayMap()) {
    const LandmarkNews news = movers_.NewsOf(estimate, map);
    workers_.mapper().Doubt(news.evidence);
    workers_.mapper().Count(news.sightings);
  }
  now.placed = estimate.placed;
  result.T_last_camera = tracker_.T_last_camera(estimate.placed, map);
  result.quality = QualityOf(estimate, map);
  if (result.keyframe) {
    const Anchor anchor = AnchorTo(map.state(), estimate.reference, estimate.placed.T_camera_world);
    placer_.InsertKeyFrame(now, estimate.placed, anchor, camera_);
  } else {
    placer_.Place(now, estimate.placed, estimate.reference, map);
  }
  result.matches = estimate.placed.inliers;
  result.T_world_camera = estimate.placed.T_camera_world.Inverse();
  return result;
}

TrackResult FramePipeline::WithoutPose(TrackFailure failure, double time, const MapSnapshot& map) {
  TrackResult result;
  result.state = PublicState(session_.state());
  result.failure = failure;
  if (const auto reckoned = inertial_.DeadReckoned(time, map)) {
    result.predicted = reckoned->pose.T_world_camera;
    result.quality.covariance = reckoned->pose.covariance;
    ++counts_.predicted;
  } else if (const auto T_camera_world = tracker_.PredictedPose(time, map)) {
    result.predicted = T_camera_world->Inverse();
    ++counts_.predicted;
  }
  return result;
}

// What later steps may need of the frame; its images are released otherwise.
void FramePipeline::KeepForLater(PresentFrame& now, const TrackResult& result) {
  const PartTimer timer(FramePart::kPublish);
  const bool seeking = session_.state() == SessionState::kSeeking;
  if (CollectsForRebuild() || KeepsForFixedParts()) kept_.Add(*now.frame, now.index, seeking);
  if (!seeking) now.frame->glance.release();
  // While seeking, the frame may become the first keyframe of a map, which needs its images.
  now.frame->picture =
      dense_ && seeking && now.frame->picture ? Copied(*now.frame->picture) : nullptr;
  if (settings_.sensor == Sensor::kMono && result.state == TrackState::kTracking)
    early_.Tracked(*now.frame, now.index);
}

void FramePipeline::Publish(const PresentFrame& now) {
  const PartTimer timer(FramePart::kPublish);
  last_frame_.Set(std::make_shared<const LastFrame>(LastFrame{now.placed.frame,
                                                              now.placed.matches,
                                                              movers_.BeliefOfCells(),
                                                              {camera_.width, camera_.height},
                                                              now.keyframe,
                                                              movers_.detections(),
                                                              movers_.detections_age()}));
  log_.End();
}

// One camera: frames from before the map could localize them. If memory runs out, they are tried
// again later.
void FramePipeline::LocalizeEarlierFrames(int count, int number) {
  if (session_.state() == SessionState::kConfirming) return;
  const PartTimer timer(FramePart::kEarlier);
  try {
    early_.Place(count, number, tracker_, workers_.map().Snapshot(), log_);
  } catch (const std::bad_alloc&) {
  }
}

// Stores everything relative to living keyframes, so that the map can forget culled ones.
void FramePipeline::Reanchor() {
  const PartTimer timer(FramePart::kPlace);
  const MapSnapshot map = workers_.map().Snapshot();
  log_.Reanchor(map);
  tracker_.Reanchor(map);
  inertial_.Reanchor(map);
  early_.Reanchor(map);
  workers_.map().ReleaseCulledKeyFrames(map.version());
}

void FramePipeline::Abandon() noexcept {
  try {
    session_.Apply(SessionEvent::kFrameFailed);
  } catch (...) {  // no memory to drop an unconfirmed map: it stays, without frames
  }
  EndFrame();
}

void FramePipeline::EndFrame() noexcept {
  try {
    log_.End();
  } catch (...) {  // no memory: tried again with the next frame, and by Finish()
  }
}

}  // namespace alidade
