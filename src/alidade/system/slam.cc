#include "alidade/system/slam.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/features/subset.h"
#include "alidade/map/anchor.h"
#include "alidade/map/map_file.h"
#include "alidade/system/frame_log.h"
#include "alidade/system/mover_watch.h"
#include "alidade/system/movers.h"
#include "alidade/system/prepare.h"
#include "alidade/system/workers.h"
#include "alidade/system/young_map.h"
#include "alidade/tracking/tracker.h"

namespace alidade {
namespace {

constexpr size_t kRelocaliseCandidates = 5;  // keyframes tried for each frame while lost
constexpr int kReanchorFrames = 300;  // how often frames are tied to living keyframes: each 10 s

// Checked, with one seed for every random choice; with dynamics landmarks must earn their weight.
SlamSettings InUse(SlamSettings settings) {
  if (settings.dynamics.mode != DynamicsMode::kOff && settings.dynamics.weigh)
    settings.mapper.young_static = 0.5f;
  settings.dynamics.seed = settings.tracker.seed = settings.start.two_view.seed =
      settings.loop.seed = settings.seed;
  settings.Check();
  return settings;
}

// The first time; how often it happened is counted.
void WarnOfJump(double seconds) {
  char text[100];
  std::snprintf(text, sizeof(text),
                "the time jumps %s by %.1f s: taken as a cut (further ones are not told)",
                seconds < 0 ? "back" : "ahead", std::abs(seconds));
  LogWarning(text);
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

class Slam::Impl {
 public:
  Impl(const Camera& given, const SlamSettings& settings,
       const std::shared_ptr<Detector>& detector);
  TrackResult Track(const FrameInput& input);
  void Load(const SavedMap& saved);
  void Reset();
  void Finish(double limit);
  SlamHealth Health() const;

  // The last frame that was done, for those who ask: never changed once it is shown.
  struct Shown {
    std::shared_ptr<const Frame> frame;
    std::vector<LandmarkId> matches;
    cv::Mat belief_of_cells;  // of standing still; empty without dynamics
  };
  std::shared_ptr<const Shown> shown() const {
    const std::lock_guard<std::mutex> lock(shown_mutex_);
    return shown_;
  }

  Camera given_;
  SlamSettings settings_;
  Camera camera_;
  bool dense_;  // semi-dense mapping is asked for
  Workers workers_;
  Tracker tracker_;
  MoverWatch movers_;
  PlacedFrame last_;  // the present frame, as it was tracked
  YoungMap young_;    // of one camera
  TrackState state_ = TrackState::kInitialising;
  FrameLog log_;
  CameraClock clock_;
  SampleLog frame_ms_, extract_ms_, track_ms_;
  std::atomic<int> relocalisations_{0}, cuts_{0};
  std::atomic<int> frames_{0};        // counted so far
  std::atomic<int> first_number_{0};  // of the next recording's frames, after a loaded map's

 private:
  TrackResult TrackCounted(const FrameInput& prepared, double time);
  void Show();
  void Recover(TrackState before) noexcept;
  void EndFrame() noexcept;
  TrackResult Start(const std::shared_ptr<Frame>& frame);
  bool StartWithDepth(const std::shared_ptr<Frame>& frame, TrackResult& result);
  bool StartWithMotion(const std::shared_ptr<Frame>& frame, TrackResult& result);
  TrackResult Continue(const std::shared_ptr<Frame>& frame);
  TrackResult FindBack(const std::shared_ptr<Frame>& frame);
  TrackResult Accept(TrackEstimate estimate, const MapSnapshot& map);
  void Place(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map);
  void AddKeyFrame(PlacedFrame& placed, const Anchor& anchor);
  TrackResult GiveUpStart(const char* reason);
  const char* Tick(double time);
  void Cut();
  void Lose();
  void Reanchor();
  void LeaveMap();

  double lost_since_ = 0;  // when the first frame without a pose came, by the steady clock, seconds
  int lost_sighted_ = 0;   // frames since that showed something
  bool jump_told_ = false;  // of the time, to the user
  bool restarted_ = false;  // Reset() was called since the last frame

  std::mutex driving_;  // held by the driving call that is under way
  mutable std::mutex shown_mutex_;
  std::shared_ptr<const Shown> shown_;
};

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
  const int number = first_number_ + log_.size() - 1;
  movers_.Begin(prepared, number);
  const Stopwatch extracting;
  const auto frame = tracker_.Extract(prepared.image, prepared.right, prepared.depth, time, number,
                                      movers_.Expected());
  extract_ms_.Add(extracting.Milliseconds());
  if (dense_) frame->picture = PictureOf(prepared);
  last_ = {};
  last_.frame = frame;
  const TrackResult result = state_ == TrackState::kTracking ? Continue(frame) : FindBack(frame);
  // Only while a map is to be started may a frame yet become a keyframe.
  const bool may_start = dense_ && state_ == TrackState::kInitialising;
  frame->picture = may_start ? Copied(*frame->picture) : nullptr;
  movers_.End(*last_.frame, result);
  Show();
  log_.End();
  if (log_.size() % kReanchorFrames == 0) Reanchor();
  return result;
}

// What the time of the next frame says: why it does not go on where the last one was; "" when it
// does. Throws when it is not to be taken.
const char* Slam::Impl::Tick(double time) {
  const double before = log_.empty() ? time : log_.time();
  switch (clock_.Take(time)) {
    case ClockStep::kGoesOn:
      return std::exchange(restarted_, false) ? "a new recording" : "";
    case ClockStep::kLate:
      ThrowInput("the frame's time does not grow");
    case ClockStep::kGap:
      Cut();
      if (!std::exchange(jump_told_, true)) WarnOfJump(time - before);
      return "after a gap in time";
    case ClockStep::kBack:
      Cut();
      log_.BeginRecording();
      if (!std::exchange(jump_told_, true)) WarnOfJump(time - before);
      return "the clock was set back";
  }
  return "";
}

// The next frame may show anything: nothing is taken from the last one.
void Slam::Impl::Cut() {
  ++cuts_;
  if (young_.on_trial()) {
    GiveUpStart("");
  } else if (state_ == TrackState::kTracking) {
    Lose();
  } else if (state_ == TrackState::kInitialising) {
    young_.Reset();
  }
}

void Slam::Impl::Reset() {
  const std::lock_guard<std::mutex> driving(driving_);
  if (log_.empty() || restarted_) return;
  Cut();
  clock_.Restart();
  log_.BeginRecording();
  restarted_ = true;
}

void Slam::Impl::Show() {
  const auto shown =
      std::make_shared<Shown>(Shown{last_.frame, last_.matches, movers_.BeliefOfCells()});
  const std::lock_guard<std::mutex> lock(shown_mutex_);
  shown_ = shown;
}

// A frame ended in the middle. The tracker remembers a frame as a whole or not at all, and goes on
// from the last one; what else is carried from frame to frame is begun anew.
void Slam::Impl::Recover(TrackState before) noexcept {
  state_ = before;
  movers_.Recover();
  young_.Reset();
  EndFrame();
}

void Slam::Impl::EndFrame() noexcept {
  try {
    log_.End();
  } catch (...) {  // no memory: tried again with the next frame, and by Finish()
  }
}

// `map`: the one the pose is in.
void Slam::Impl::Place(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map) {
  const Anchor anchor = AnchorTo(map.state(), reference, placed.T_camera_world);
  movers_.Place(WorldOf(reference, map));
  tracker_.Remember(placed, reference, map);
  workers_.map().ReleaseLandmarkIds(map.version());  // what was remembered before is forgotten
  log_.Place(anchor, placed.T_camera_world.Inverse());
}

void Slam::Impl::AddKeyFrame(PlacedFrame& placed, const Anchor& anchor) {
  const std::shared_ptr<const Picture> picture = placed.frame->picture;
  LeaveOutMovers(placed, camera_);
  const KeyFrameId id = workers_.mapper().Insert(placed.frame, anchor, placed.matches);
  const MapSnapshot map = workers_.map().Snapshot();
  const KeyFrame& keyframe = *map.Find(id);
  placed.T_camera_world = keyframe.T_camera_world;
  placed.matches = keyframe.landmarks;
  tracker_.KeyFrameInserted(placed.frame->number);
  Place(placed, id, map);
  workers_.Keep(id, picture.get());
  workers_.Add(id);
}

// No pose: known places first; a new map only where none is known, or none was recognised for long.
TrackResult Slam::Impl::FindBack(const std::shared_ptr<Frame>& frame) {
  const MapSnapshot map = workers_.map().Snapshot();
  movers_.Judge(*frame, nullptr);
  if (map.keyframe_count() > 0) {
    const Stopwatch watch;
    std::vector<KeyFrameId> candidates;
    if (state_ == TrackState::kLost && map.Find(tracker_.reference()))
      candidates.push_back(tracker_.reference());
    const std::vector<MapId> dropped = workers_.dropped();
    const auto may_be = [&](KeyFrameId id) {
      const KeyFrame* keyframe = map.Find(id);
      return keyframe && (candidates.empty() || id != candidates[0]) &&
             std::find(dropped.begin(), dropped.end(), keyframe->map) == dropped.end();
    };
    const Frame still = KeypointSubset(*frame, MappableKeypoints(*frame), camera_);
    for (const PlaceMatch& match : workers_.places().Query(still, may_be, kRelocaliseCandidates)) {
      candidates.push_back(match.id);
    }
    TrackEstimate estimate = tracker_.Relocalise(frame, map, candidates);
    track_ms_.Add(watch.Milliseconds());
    if (estimate.tracked) {
      ++relocalisations_;
      young_.Reset();
      // A place just found again is confirmed by the frames after it before the map grows on it.
      tracker_.KeyFrameInserted(frame->number);
      estimate.wants_keyframe = false;
      return Accept(std::move(estimate), map);
    }
  }
  if (state_ == TrackState::kLost) {
    const auto sighted = 100 * settings_.tracker.match_scale;  // corners
    lost_sighted_ += static_cast<double>(frame->keypoints.size()) >= sighted;
    const bool long_lost = clock_.steady() - lost_since_ >= settings_.new_map_seconds &&
                           lost_sighted_ >= settings_.new_map_frames;
    if (!long_lost || settings_.localise || workers_.mapping_stopped()) {
      TrackResult result;
      result.state = state_;
      result.reason = "the place was not recognised";
      return result;
    }
    LeaveMap();
  }
  return Start(frame);
}

// Between two frames: from then on none of what the tracker's thread remembers needs a keyframe
// that was culled before.
void Slam::Impl::Reanchor() {
  const MapSnapshot map = workers_.map().Snapshot();
  log_.Reanchor(map);
  tracker_.Reanchor(map);
  workers_.map().ReleaseCulledKeyFrames(map.version());
}

void Slam::Impl::Lose() {
  tracker_.Forget();
  state_ = TrackState::kLost;
  lost_since_ = clock_.steady();
  lost_sighted_ = 0;
}

// A map of a few keyframes is worth less than the confusion it makes; one that was loaded is kept.
void Slam::Impl::LeaveMap() {
  state_ = TrackState::kInitialising;
  young_.Reset();
  const MapSnapshot map = workers_.map().Snapshot();
  const MapId left = map.MapOf(tracker_.reference());
  if (!left.valid()) return;
  const std::vector<KeyFrameId> keyframes = map.KeyFramesOf(left);
  const bool loaded = map.Find(keyframes.front())->frame->number < first_number_;
  if (!loaded && static_cast<int>(keyframes.size()) < settings_.min_map_keyframes)
    workers_.Drop(left);
}

TrackResult Slam::Impl::Start(const std::shared_ptr<Frame>& frame) {
  TrackResult result;
  if (workers_.mapping_stopped()) {
    result.reason = "mapping has stopped";
    return result;
  }
  if (movers_.on()) {
    last_.frame = std::make_shared<Frame>(*frame);
    *frame = KeypointSubset(*frame, MappableKeypoints(*frame), camera_);
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
    result.reason = young_.reason();
    return false;
  }
  if (!begun->holds) {
    result = GiveUpStart("the first points did not hold");
    return false;
  }
  tracker_.KeyFrameInserted(frame->number);
  Place(begun->placed, begun->id, begun->map);
  result.matches = begun->placed.inliers;
  return true;
}

TrackResult Slam::Impl::GiveUpStart(const char* reason) {
  young_.GiveUp();
  tracker_.Forget();
  movers_.Forget();
  state_ = TrackState::kInitialising;
  TrackResult result;
  result.reason = reason;
  return result;
}

TrackResult Slam::Impl::Continue(const std::shared_ptr<Frame>& frame) {
  const Stopwatch watch;
  const MapSnapshot map = workers_.map().Snapshot();
  PlacedFrame guess = tracker_.Predict(frame, map);
  const double predicting = watch.Milliseconds();
  const PoseGuess where = GuessOf(guess, tracker_.reference(), map);
  movers_.Judge(*frame, &where);
  const Stopwatch estimating;
  TrackEstimate estimate = tracker_.Estimate(std::move(guess), map);
  track_ms_.Add(predicting + estimating.Milliseconds());
  if (young_.on_trial() && !young_.Confirm(estimate))
    return GiveUpStart("the first points did not hold");
  if (young_.IsYoung(*frame, tracker_.reference(), map) && movers_.FollowsMover())
    return GiveUpStart("the first points moved");
  if (estimate.tracked) return Accept(std::move(estimate), map);
  Lose();
  TrackResult result;
  result.state = state_;
  result.reason = "too few landmarks found";
  return result;
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

void Slam::Impl::Finish(double limit) {
  const std::lock_guard<std::mutex> driving(driving_);
  EndFrame();
  workers_.Drain(limit);
}

SlamHealth Slam::Impl::Health() const {
  SlamHealth health{workers_.health()};
  for (StageHealth& stage : movers_.health()) health.stages.push_back(std::move(stage));
  return health;
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

Slam::Slam(const Camera& camera, const SlamSettings& settings, std::shared_ptr<Detector> detector)
    : impl_(std::make_unique<Impl>(camera, settings, detector)) {}
Slam::~Slam() = default;
TrackResult Slam::Track(const FrameInput& input) { return impl_->Track(input); }
void Slam::Reset() { impl_->Reset(); }
void Slam::Finish(double limit) { impl_->Finish(limit); }
void Slam::CutFinishShort() { impl_->workers_.CutShort(); }
SlamHealth Slam::Health() const { return impl_->Health(); }
void Slam::Load(const SavedMap& saved) { impl_->Load(saved); }
MapSnapshot Slam::Snapshot() const { return impl_->workers_.map().Snapshot(); }
const Camera& Slam::camera() const { return impl_->camera_; }
int Slam::frames() const { return impl_->frames_; }
int Slam::first_number() const { return impl_->first_number_; }

std::vector<FeatureUse> Slam::Features() const {
  std::vector<FeatureUse> features;
  const auto last = impl_->shown();
  if (!last) return features;
  for (size_t k = 0; k < last->frame->keypoints.size(); ++k) {
    const Keypoint& keypoint = last->frame->keypoints[k];
    features.push_back({keypoint.raw_x, keypoint.raw_y, last->frame->Static(static_cast<int>(k)),
                        k < last->matches.size() && last->matches[k].valid()});
  }
  return features;
}

cv::Mat Slam::MoverMask() const {
  const auto last = impl_->shown();
  if (!last || last->belief_of_cells.empty()) return {};
  return MaskOf(last->belief_of_cells, {impl_->camera_.width, impl_->camera_.height});
}

SlamCounts Slam::Counts() const {
  return {impl_->relocalisations_, impl_->workers_.loops(), impl_->workers_.merges(), impl_->cuts_,
          impl_->log_.let_go()};
}

SemiDenseReport Slam::SemiDense() const { return impl_->workers_.SemiDense(); }

std::string Slam::SaveMap() const {
  // Places first: they are never ahead of the map then, which may grow meanwhile.
  SavedPlaces places = impl_->workers_.places().Save();
  return EncodeMap({Snapshot(), impl_->camera_, NameOf(impl_->settings_.sensor),
                    impl_->settings_.All(), std::move(places)});
}

StageTimes Slam::Times() const {
  StageTimes times;
  times.frame = impl_->frame_ms_.All();
  times.extract = impl_->extract_ms_.All();
  times.track = impl_->track_ms_.All();
  times.map = impl_->workers_.MapMilliseconds();
  times.loop = impl_->workers_.LoopMilliseconds();
  times.semidense = impl_->workers_.SemiDenseMilliseconds();
  times.detect = impl_->movers_.DetectorMilliseconds();
  times.dynamics = impl_->movers_.Milliseconds();
  return times;
}

std::vector<FramePose> Slam::Trajectory(int since) const {
  return impl_->log_.Trajectory(impl_->workers_.map(), since);
}

}  // namespace alidade
