#include "alidade/system/early_frames.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "alidade/features/undistort.h"

namespace alidade {
namespace {

// Of the keyframes of a map the one whose frame came nearest in time.
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
  if (settings_.most == 0) return;
  auto kept = std::make_shared<Frame>(frame);
  kept->picture = nullptr;
  kept->glance.release();
  if (static_cast<int>(frames_.size()) >= settings_.most) frames_.pop_front();
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
  if (map_.valid() && frame.number - begun_ < settings_.settle) Keep(frame, index, map_);
}

void EarlyFrames::GiveUp() {
  for (Early& early : frames_) {
    if (early.map == map_) early = {early.frame, early.index, {}, true};
  }
  map_ = {};
}

void EarlyFrames::ForgetWaiting() {
  std::erase_if(frames_, [](const Early& early) { return !early.map.valid(); });
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
  if (number - begun_ < settings_.settle) return;
  for (; count > 0; --count) {
    const auto last = std::find_if(frames_.rbegin(), frames_.rend(),
                                   [](const Early& early) { return early.map.valid(); });
    if (last == frames_.rend()) return;
    PlaceOne(*last, tracker, map, log);
    frames_.erase(std::next(last).base());  // not when memory ran out
  }
}

void EarlyFrames::PlaceOne(const Early& early, Tracker& tracker, const MapSnapshot& map,
                           FrameLog& log) {
  const KeyFrameId near = NearestKeyFrame(map, early.map, early.frame->number);
  if (!near.valid()) return;  // its map is gone
  if (map.Find(near)->frame->number == early.frame->number) {
    log.PlaceLate(early.index, {near, Se3(), map.ScaleOf(near)});
    return;
  }
  if (early.before && missed_in_ != early.map) {
    missed_in_ = early.map;
    missed_ = 0;
  }
  if (early.before && missed_ >= settings_.most_missed) return;
  const TrackEstimate estimate = tracker.PlaceAgain(early.frame, map, near);
  if (estimate.tracked) {
    log.PlaceLate(early.index,
                  AnchorTo(map.state(), estimate.reference, estimate.placed.T_camera_world));
  }
  if (early.before) missed_ = estimate.tracked ? 0 : missed_ + 1;
}

}  // namespace alidade
