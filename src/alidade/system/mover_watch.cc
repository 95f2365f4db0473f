#include "alidade/system/mover_watch.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/part_times.h"
#include "alidade/base/timing.h"

namespace alidade {

MoverWatch::MoverWatch(const Camera& camera, const SlamSettings& settings,
                       const std::shared_ptr<Detector>& detector)
    : detections_(settings.dynamics.mode == DynamicsMode::kFull ? detector : nullptr,
                  settings.dynamics, settings.threaded, settings.seed),
      camera_(camera),
      sensor_(settings.sensor),
      settings_(settings.dynamics) {
  const DynamicsMode mode = settings.dynamics.mode;
  if (mode == DynamicsMode::kFull && !detector) ThrowUsage("dynamics full needs a detector");
  if (mode == DynamicsMode::kOff) return;
  if (mode == DynamicsMode::kFull) class_names_ = detector->ClassNames();
  filter_.emplace(camera_, settings_, class_names_);
  used_ = LeavesOutFromStart(mode);
}

bool MoverWatch::Watches(bool young) {
  if (!young && watched_ >= settings_.watch_frames && doubtful_ == 0) {  // examined long enough
    watched_ = 0;
    rest_ = settings_.watch_every - settings_.watch_frames;
  }
  if (young) rest_ = 0;
  if (rest_ > 0) {
    --rest_;
    return false;
  }
  if (watched_ == 0) {  // the filter's last frame is too old to compare with
    filter_.emplace(camera_, settings_, class_names_);
    moved_.clear();
    doubtful_ = 0;
  }
  ++watched_;
  return true;
}

void MoverWatch::Begin(const FrameInput& prepared, int number, bool placed, bool young) {
  const PartTimer timer(FramePart::kMovers);
  present_ms_ = 0;
  if (!placed) watched_ = 0;
  looks_ = filter_ && (used_ || (placed && Watches(young)));
  counts_ = looks_ && used_;
  if (!looks_) return;
  const cv::Mat& seen = prepared.color.empty() ? prepared.image : prepared.color;
  detections_.Offer(number, seen);
  const std::optional<FrameDetections> arrived = detections_.Take(number);
  Remember(arrived, number, prepared.time);
  const Stopwatch advancing;
  // While frames are only examined, the right image is left out: matching a stereo pair takes four
  // times as long as optical flow.
  const cv::Mat right = counts_ ? prepared.right : cv::Mat();
  filter_->Advance({number, prepared.time, prepared.image, prepared.depth, right}, arrived);
  present_ms_ += advancing.Milliseconds();
}

void MoverWatch::Remember(const std::optional<FrameDetections>& arrived, int number, double time) {
  constexpr size_t kWaiting = 1000;  // frames; 33 s at 30 per second, longer than any detector
  now_ = time;
  if (settings_.mode != DynamicsMode::kFull) return;
  offered_.push_back({number, time});
  if (offered_.size() > kWaiting) offered_.pop_front();
  if (!arrived) return;
  while (offered_.size() > 1 && offered_.front().first < arrived->number) offered_.pop_front();
  answer_time_ = offered_.front().second;
  answer_ = std::make_shared<const FrameDetections>(*arrived);
}

cv::Mat MoverWatch::Expected() const { return counts_ ? filter_->ExpectedMovers() : cv::Mat(); }

bool MoverWatch::MuchMoves(bool young) {
  moved_.push_back(filter_->MovedShare());
  if (moved_.size() < static_cast<size_t>(settings_.watch_mean)) return false;
  if (moved_.size() > static_cast<size_t>(settings_.watch_mean)) moved_.pop_front();
  const double mean =
      std::accumulate(moved_.begin(), moved_.end(), 0.0) / static_cast<double>(moved_.size());
  if (sensor_ == Sensor::kRgbd) return mean > settings_.watch_moved_depth;
  return mean > settings_.watch_moved && (young || sensor_ == Sensor::kStereo);
}

bool MoverWatch::FollowsMover(bool young) {
  const PartTimer timer(FramePart::kMovers);
  if (!looks_ || (counts_ && !young)) return false;
  const Stopwatch watch;
  const bool rival = filter_->RivalShare() > settings_.votes.rival_share;
  doubtful_ = std::max(0, doubtful_ + (rival ? 1 : -1));
  const int enough = young ? settings_.votes.rival_frames : settings_.watch_rival_frames;
  const bool follows = doubtful_ >= enough;
  if (!counts_ && (MuchMoves(young) || follows)) {
    LogWarning(
        "much of the image moves: moving objects are left out from now on (--dynamics off disables "
        "this)");
    used_ = true;
    counts_ = sensor_ != Sensor::kRgbd;  // this frame's tracks already give evidence on landmarks
  }
  present_ms_ += watch.Milliseconds();
  return follows;
}

void MoverWatch::Judge(Frame& frame, const PoseGuess* guess) {
  const PartTimer timer(FramePart::kMovers);
  if (!looks_) return;
  const Stopwatch watch;
  if (!guess) doubtful_ = 0;
  if (counts_) {
    filter_->Judge(frame, guess);
  } else {
    filter_->JudgeTracks(guess);
  }
  if (counts_ && frame.picture) {
    Picture picture = *frame.picture;
    const cv::Mat left_out = picture.mask;
    picture.mask = filter_->Mask();
    if (!left_out.empty()) cv::bitwise_or(picture.mask, left_out, picture.mask);
    frame.picture = std::make_shared<Picture>(picture);
  }
  present_ms_ += watch.Milliseconds();
}

LandmarkNews MoverWatch::NewsOf(const TrackEstimate& estimate, const MapSnapshot& map) const {
  const PartTimer timer(FramePart::kMovers);
  LandmarkNews news;
  int on_movers = 0;
  for (const SightingCount& s : estimate.sightings) {
    if (!looks_ || !counts_) {
      news.sightings.push_back({s.landmark, s.found});
      continue;
    }
    const Landmark* landmark = map.Find(s.landmark);
    if (!landmark) continue;
    const Sight sight = filter_->Look(estimate.placed.T_camera_world * landmark->p_world);
    on_movers += sight == Sight::kOnMover;
    news.evidence.push_back({s.landmark, EvidenceOf(sight, s.found, settings_.landmarks)});
    if (s.found || sight == Sight::kClear) news.sightings.push_back({s.landmark, s.found});
  }
  if (on_movers > settings_.landmarks.most_on_movers * static_cast<double>(news.evidence.size()))
    news.evidence.clear();
  return news;
}

void MoverWatch::Forget() {
  doubtful_ = 0;
  if (filter_) filter_->Forget();
}

void MoverWatch::End(const Frame& frame, const TrackResult& result) {
  const PartTimer timer(FramePart::kMovers);
  if (!looks_) return;
  looks_ = false;
  const Stopwatch watch;
  const Se3 T_camera_world = result.T_world_camera.Inverse();
  filter_->Remember(frame, result.state == TrackState::kTracking ? &T_camera_world : nullptr,
                    world_);
  milliseconds_.Add(present_ms_ + watch.Milliseconds());
}

void MoverWatch::SeedCorners(const cv::Mat& left_out) {
  const PartTimer timer(FramePart::kMovers);
  if (looks_) filter_->SeedCorners(left_out);
}

void MoverWatch::SetCamera(const Camera& camera) {
  camera_ = camera;
  watched_ = 0;
  if (filter_) filter_.emplace(camera_, settings_, class_names_);
}

void MoverWatch::Recover() noexcept {
  doubtful_ = watched_ = 0;
  looks_ = counts_ = false;
  if (settings_.mode == DynamicsMode::kOff || filter_failed_) return;
  try {
    filter_.emplace(camera_, settings_, class_names_);
  } catch (...) {  // filter_ is empty now
    used_ = false;
    const std::lock_guard<std::mutex> lock(failure_mutex_);
    failure_ = std::current_exception();
    filter_failed_ = true;
  }
}

void MoverWatch::Restart() noexcept {
  Recover();
  moved_.clear();
  used_ = !filter_failed_ && LeavesOutFromStart(settings_.mode);
}

std::vector<StageHealth> MoverWatch::health() const {
  std::vector<StageHealth> stages;
  const bool only_watches = settings_.mode == DynamicsMode::kAuto && !used_ && !filter_failed_;
  if (settings_.mode == DynamicsMode::kOff || only_watches) return stages;
  {
    const std::lock_guard<std::mutex> lock(failure_mutex_);
    stages.push_back(HealthOf("dynamics", failure_, 0));
  }
  if (settings_.mode == DynamicsMode::kFull)
    stages.push_back(HealthOf("detector", detections_.failure(), 0));
  return stages;
}

}  // namespace alidade
