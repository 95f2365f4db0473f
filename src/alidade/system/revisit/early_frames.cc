#include "alidade/system/revisit/early_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "alidade/features/undistort.h"
#include "alidade/map/view.h"

namespace alidade {
namespace {

// The keyframe of map `of` whose frame number is nearest to `number`.
KeyFrameId NearestKeyFrame(const MapSnapshot& map, MapId of, int number) {
  KeyFrameId nearest;
  int least = 0;
  for (KeyFrameId id : map.KeyFramesOf(of)) {
    const int gap = std::abs(map.Find(id)->frame->number - number);
    if (nearest.valid() && gap >= least) continue;
    nearest = id;
    least = gap;
  }
  return nearest;
}

}  // namespace

void EarlyFrames::Keep(const Frame& frame, int index, MapId map) {
  if (settings_.max_frames == 0) return;
  auto kept = std::make_shared<Frame>(frame);
  kept->picture = nullptr;
  kept->glance.release();
  if (static_cast<int>(frames_.size()) >= settings_.max_frames) frames_.pop_front();
  frames_.push_back({std::move(kept), index, map, !map.valid()});
}

void EarlyFrames::Wait(const Frame& frame, int index) { Keep(frame, index, {}); }

void EarlyFrames::Begin(MapId map, int number) {
  for (Early& early : frames_) {
    if (!early.map.valid()) early.map = map;
  }
  map_ = map;
  begun_ = number;
}

void EarlyFrames::Tracked(const Frame& frame, int index) {
  if (Wants(frame.number)) Keep(frame, index, map_);
}

void EarlyFrames::Release() {
  for (Early& early : frames_) {
    if (early.map == map_) early = {early.frame, early.index, {}, true};
  }
  map_ = {};
}

void EarlyFrames::ForgetWaiting() {
  std::erase_if(frames_, [](const Early& early) { return !early.map.valid(); });
}

void EarlyFrames::Reanchor(const MapSnapshot& map) {
  for (Step& step : way_) step.anchor = Reanchored(map.state(), step.anchor);
  std::erase_if(way_, [](const Step& step) { return !step.anchor.keyframe.valid(); });
}

void EarlyFrames::SetCamera(const Camera& camera) {
  for (Early& early : frames_) {
    auto frame = std::make_shared<Frame>(*early.frame);
    UndistortKeypoints(camera, *frame);
    early.frame = std::move(frame);
  }
}

void EarlyFrames::Place(int count, int number, Tracker& tracker, const MapSnapshot& map,
                        FrameLog& log) {
  if (number - begun_ < settings_.settle_frames) return;
  for (; count > 0; --count) {
    const auto last = std::find_if(frames_.rbegin(), frames_.rend(),
                                   [](const Early& early) { return early.map.valid(); });
    if (last == frames_.rend()) return;
    PlaceOne(*last, tracker, map, log);
    frames_.erase(std::next(last).base());  // if PlaceOne() throws, the frame stays
  }
}

void EarlyFrames::PlaceOne(const Early& early, Tracker& tracker, const MapSnapshot& map,
                           FrameLog& log) {
  const KeyFrameId near = NearestKeyFrame(map, early.map, early.frame->number);
  if (!near.valid()) return;  // the map was dropped
  const double time = early.frame->time;
  if (map.Find(near)->frame->number == early.frame->number) {
    const Anchor anchor{near, Se3(), map.ScaleOf(near)};
    log.PlaceLate(early.index, anchor);
    Passed(time, anchor, early.map);
    return;
  }
  if (early.before && missed_in_ != early.map) {
    missed_in_ = early.map;
    missed_ = 0;
  }
  if (early.before && missed_ >= settings_.max_missed_frames) return;
  const TrackEstimate estimate = tracker.PlaceAgain(early.frame, map, near);
  if (early.before) missed_ = estimate.tracked ? 0 : missed_ + 1;
  if (!estimate.tracked) return;
  if (early.before && way_in_ == early.map && Leaps(estimate, map)) {
    missed_ = settings_.max_missed_frames;
    return;
  }
  const Anchor anchor = AnchorTo(map.state(), estimate.reference, estimate.placed.T_camera_world);
  log.PlaceLate(early.index, anchor);
  Passed(time, anchor, early.map);
}

void EarlyFrames::Passed(double time, const Anchor& anchor, MapId map) {
  if (way_in_ != map) way_.clear();
  way_in_ = map;
  way_.push_back({time, anchor});
  while (way_.size() > 2 && way_[1].time - time >= settings_.leap_seconds) way_.pop_front();
}

// Motion gate: with x, v the position and velocity extrapolated from the frames localized after
// this one, and p, sigma its own position and standard deviation, true if |p - x| is above max_leap
// (|v| max(|dt|, leap_seconds) + 3 sigma), and above min_leap times the median depth.
bool EarlyFrames::Leaps(const TrackEstimate& estimate, const MapSnapshot& map) const {
  if (way_.size() < 2) return false;
  const PlacedFrame& placed = estimate.placed;
  const auto centre = [&](const Step& step) {
    return PoseOf(map.state(), step.anchor).Inverse().t;
  };
  const Step &first = way_.front(), &last = way_.back();
  const double seconds = placed.frame->time - last.time;  // negative: going back
  const Eigen::Vector3d velocity = (centre(last) - centre(first)) / (last.time - first.time);
  const Eigen::Vector3d expected = centre(last) + velocity * seconds;
  const double off = (placed.T_camera_world.Inverse().t - expected).norm();
  const double way = velocity.norm() * std::max(std::abs(seconds), settings_.leap_seconds);
  const double sigma = std::sqrt(placed.covariance.topLeftCorner<3, 3>().trace());
  const double depth = MedianDepth(map, *map.Find(estimate.reference)).value_or(0);
  return off > settings_.max_leap * (way + 3 * sigma) && off > settings_.min_leap * depth;
}

}  // namespace alidade
