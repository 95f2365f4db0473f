// One frame through the system: from image to pose and keyframe. slam_impl.h says what is where.
#include "alidade/system/slam.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/features/glance.h"
#include "alidade/features/subset.h"
#include "alidade/map/anchor.h"
#include "alidade/system/movers.h"
#include "alidade/system/prepare.h"
#include "alidade/system/slam_impl.h"

namespace alidade {
namespace {

constexpr int kLastQuestions = 3;  // of the camera at the end: each change makes the next smaller
constexpr float kYoungStatic = 0.5f;  // MapperSettings::young_static, while movers are left out
constexpr int kReanchorFrames = 300;  // how often frames are tied to living keyframes: each 10 s

// Checked, with one seed for every random choice; with dynamics landmarks must earn their weight.
SlamSettings InUse(SlamSettings settings) {
  if (LeavesOutFromStart(settings.dynamics.mode) && settings.dynamics.weigh)
    settings.mapper.young_static = kYoungStatic;
  settings.dynamics.seed = settings.tracker.seed = settings.start.two_view.seed =
      settings.loop.seed = settings.seed;
  settings.Check();
  return settings;
}

PoseQuality QualityOf(const TrackEstimate& estimate) {
  PoseQuality quality;
  quality.covariance = estimate.placed.covariance;
  quality.expected = static_cast<int>(estimate.sightings.size());
  quality.inliers = estimate.placed.inliers;
  if (quality.expected > 0)
    quality.found_share = static_cast<double>(quality.inliers) / quality.expected;
  return quality;
}

}  // namespace

Slam::Impl::Impl(const Camera& given, const SlamSettings& settings,
                 const std::shared_ptr<Detector>& detector)
    : given_(given),
      settings_(InUse(settings)),
      camera_(CameraInUse(given, settings)),
      dense_(settings.semidense.enabled && !settings.localise),
      workers_(camera_, settings_),
      tracker_(camera_, settings_.tracker),
      movers_(camera_, settings_, detector),
      young_(camera_, settings_, workers_),
      early_(settings_.early),
      log_(settings_.trajectory),
      clock_(settings_.time) {}

TrackResult Slam::Impl::Track(const FrameInput& input) {
  const std::lock_guard<std::mutex> driving(driving_);
  const Stopwatch whole;
  const auto count = [&] {
    log_.Begin(input.time);
    frames_ = log_.size();
  };
  FrameInput prepared;
  const char* cut = "";
  try {
    prepared = Prepare(input, given_, camera_, settings_);
    cut = Tick(input.time);
  } catch (const Error&) {  // refused
    throw;
  } catch (...) {
    count();
    EndFrame();
    throw;
  }
  prepared.time = clock_.steady();
  const TrackState before = state_;
  count();
  try {
    TrackResult result = TrackCounted(prepared, input.time);
    result.cut = cut;
    frame_ms_.Add(whole.Milliseconds());
    if (workers_.any_stopped() || movers_.any_stopped()) result.warning = Health().Stopped();
    return result;
  } catch (...) {
    Recover(before);
    throw;
  }
}

// `time`: as it was given; that of `prepared` never jumps.
TrackResult Slam::Impl::TrackCounted(const FrameInput& prepared, double time) {
  orphan_ = {};
  RefineCamera();
  const bool left = LeavesUnknownScale();
  const int number = first_number_ + log_.size() - 1;
  const bool placed = state_ == TrackState::kTracking;
  movers_.Begin(prepared, number, placed && KnowsLens(), young_.WantsGlance(number));
  tracker_.SetReadout(workers_.readout());
  const Stopwatch extracting;
  const auto frame = tracker_.Extract(prepared.image, prepared.right, prepared.depth, time, number,
                                      movers_.Expected());
  extract_ms_.Add(extracting.Milliseconds());
  if (dense_) frame->picture = PictureOf(prepared);
  if (settings_.sensor == Sensor::kMono && (!placed || young_.WantsGlance(number) || KeepsFrames()))
    frame->glance = Glance(prepared.image);
  last_ = {};
  last_keyframe_ = {};
  last_.frame = frame;
  TrackResult result = state_ == TrackState::kTracking ? Continue(frame) : FindBack(frame);
  if (left && result.state != TrackState::kTracking)
    result.reason = "a turn left no scale: move sideways while turning";
  // Only while a map is to be started may a frame yet become a keyframe.
  const bool may_start = dense_ && state_ == TrackState::kInitialising;
  KeepFrame(*frame);
  if (state_ != TrackState::kInitialising) frame->glance.release();
  frame->picture = may_start ? Copied(*frame->picture) : nullptr;
  movers_.End(*last_.frame, result);
  Show();
  log_.End();
  if (settings_.sensor == Sensor::kMono && result.state != TrackState::kInitialising) {
    if (result.state == TrackState::kTracking) early_.Tracked(*frame, log_.size() - 1);
    PlaceEarly(1, number);
  }
  if (log_.size() % kReanchorFrames == 0) Reanchor();
  return result;
}

// `map`: the one the pose is in.
void Slam::Impl::Place(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map) {
  const Anchor anchor = AnchorTo(map.state(), reference, placed.T_camera_world);
  movers_.Place(WorldOf(reference, map));
  tracker_.Remember(placed, reference, map);
  workers_.map().ReleaseLandmarkIds(map.version());  // what was remembered before is forgotten
  if (again_ >= 0) {
    log_.PlaceLate(again_, anchor);
  } else {
    log_.Place(anchor, placed.T_camera_world.Inverse());
  }
}

void Slam::Impl::AddKeyFrame(PlacedFrame& placed, const Anchor& anchor) {
  const std::shared_ptr<const Picture> picture = placed.frame->picture;
  LeaveOutMovers(placed, camera_);
  const KeyFrameId id = workers_.mapper().Insert(placed.frame, anchor, placed.matches);
  last_keyframe_ = id;
  const MapSnapshot map = workers_.map().Snapshot();
  const KeyFrame& keyframe = *map.Find(id);
  placed.T_camera_world = keyframe.T_camera_world;
  placed.matches = keyframe.landmarks;
  tracker_.KeyFrameInserted(placed.frame->number);
  Place(placed, id, map);
  workers_.Keep(id, picture.get());
  workers_.Add(id);
}

TrackResult Slam::Impl::Continue(const std::shared_ptr<Frame>& frame) {
  const Stopwatch watch;
  const MapSnapshot map = workers_.map().Snapshot();
  tracker_.UndoShutter(*frame, map);
  PlacedFrame guess = tracker_.Predict(frame, map);
  const double predicting = watch.Milliseconds();
  const PoseGuess where = GuessOf(guess, tracker_.reference(), map);
  movers_.Judge(*frame, &where);
  const Stopwatch estimating;
  TrackEstimate estimate = tracker_.Estimate(std::move(guess), map);
  if (estimate.tracked) {
    tracker_.UndoShutter(*frame, estimate, map);
    if (settings_.readout.enabled && !camera_.readout_known)
      workers_.readout_watch().Placed(frame->motion, tracker_.ReadoutMatches(estimate.placed, map));
  }
  track_ms_.Add(predicting + estimating.Milliseconds());
  if (young_.on_trial() && !young_.Confirm(estimate))
    return GiveUpStart("the first points did not hold");
  const bool young = young_.IsYoung(*frame, tracker_.reference(), map);
  if (FollowsMover(young) && young) return GiveUpStart("the first points moved");
  if (estimate.tracked && settings_.sensor == Sensor::kMono && young &&
      young_.StandsStill(estimate.placed))
    return GiveUpStart("something moves, the camera seems to stand still");
  if (estimate.tracked) return Accept(std::move(estimate), map);
  Lose();
  return WithoutPose("too few landmarks found", frame->time, map);
}

// Whether flow can be held against poses: with a focal length that is far off all seems to move.
// One that is looked for is believed once the map is not begun anew over it any more.
bool Slam::Impl::KnowsLens() const {
  if (settings_.refine.enabled) {
    if (KeepsFrames()) return false;
    const std::optional<CameraEstimate> found = workers_.lens_watch().found();
    return found && found->known;
  }
  return settings_.start.two_view.lens_uncertainty <= settings_.dynamics.watch_lens;
}

// With dynamics.mode auto what moves may be left out from here on.
bool Slam::Impl::FollowsMover(bool young) {
  const bool left_out = movers_.on();
  const bool follows = movers_.FollowsMover(young);
  if (follows && !young) movers_.Forget();  // what was believed by such poses
  if (movers_.on() && !left_out && settings_.dynamics.weigh)
    workers_.mapper().SetYoungStatic(kYoungStatic);
  return follows;
}

TrackResult Slam::Impl::Accept(TrackEstimate estimate, const MapSnapshot& map) {
  state_ = TrackState::kTracking;
  TrackResult result;
  result.state = state_;
  // A busy mapper is not given more than it can chew; with depth the tracker lives on new
  // keyframes, so it may queue some.
  const bool may_insert = workers_.backlog() < (settings_.sensor == Sensor::kMono ? 2 : 3);
  result.keyframe = estimate.wants_keyframe && !young_.on_trial() && may_insert &&
                    !settings_.localise && !workers_.mapping_stopped() &&
                    HoldsWithoutMovers(estimate.placed);
  if (!settings_.localise) {
    const LandmarkNews news = movers_.NewsOf(estimate, map);
    workers_.mapper().Doubt(news.evidence);
    workers_.mapper().Count(news.sightings);
  }
  last_ = estimate.placed;
  result.quality = QualityOf(estimate);
  if (result.keyframe) {
    AddKeyFrame(estimate.placed,
                AnchorTo(map.state(), estimate.reference, estimate.placed.T_camera_world));
  } else {
    Place(estimate.placed, estimate.reference, map);
  }
  result.matches = estimate.placed.inliers;
  result.T_world_camera = log_.T_world_camera_live();
  return result;
}

// Of one camera: what came before the map knew better. Where memory runs out it is left for later.
void Slam::Impl::PlaceEarly(int count, int number) {
  if (young_.on_trial()) return;
  try {
    early_.Place(count, number, tracker_, workers_.map().Snapshot(), log_);
  } catch (const std::bad_alloc&) {
  }
}

// Between two frames: from then on none of what the tracker's thread remembers needs a keyframe
// that was culled before.
void Slam::Impl::Reanchor() {
  const MapSnapshot map = workers_.map().Snapshot();
  log_.Reanchor(map);
  tracker_.Reanchor(map);
  early_.Reanchor(map);
  workers_.map().ReleaseCulledKeyFrames(map.version());
}

void Slam::Impl::Finish(double limit) {
  const std::lock_guard<std::mutex> driving(driving_);
  EndFrame();
  workers_.Drain(limit);
  if (LeavesUnknownScale()) workers_.Drain(limit);
  if (state_ == TrackState::kTracking && young_.WantsGlance(Index()) && young_.StoodStill()) {
    GiveUpStart("something moves, the camera seems to stand still");
    workers_.Drain(limit);
  }
  // All that was seen has a say now. Not where time is short.
  for (int i = 0; i < kLastQuestions && settings_.refine.enabled && !std::isfinite(limit); ++i) {
    workers_.AskForCamera();
    if (!RefineCamera()) break;
  }
  PlaceEarly(settings_.early.most, std::numeric_limits<int>::max());
}

Slam::Slam(const Camera& camera, const SlamSettings& settings, std::shared_ptr<Detector> detector)
    : impl_(std::make_unique<Impl>(camera, settings, detector)) {}
Slam::~Slam() = default;
void Slam::Load(const SavedMap& saved) { impl_->Load(saved); }
TrackResult Slam::Track(const FrameInput& input) { return impl_->Track(input); }
void Slam::Reset() { impl_->Reset(); }
void Slam::Finish(double limit) { impl_->Finish(limit); }
void Slam::CutFinishShort() { impl_->workers_.CutShort(); }

}  // namespace alidade
