#include "alidade/system/start/young_map.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "alidade/base/median.h"
#include "alidade/features/glance.h"

namespace alidade {

YoungMap::YoungMap(const Camera& camera, const SlamSettings& settings, Workers& workers)
    : settings_(settings),
      workers_(workers),
      start_(camera, settings.start),
      least_motion_(settings.start.min_still_motion * camera.width) {}

std::optional<YoungMap::Begun> YoungMap::Begin(const std::shared_ptr<const Frame>& frame) {
  const auto views = start_.Add(frame);
  if (!views) return {};
  Mapper::TwoViewMap two;
  const auto first = std::make_shared<Frame>(*views->a);  // the map holds no images
  first->picture = nullptr;
  first->glance.release();
  two.a = first;
  two.b = views->b;
  two.T_b_a = views->T_b_a;
  for (const auto& p : views->points) two.points.push_back({p.p_a, p.keypoint_a, p.keypoint_b});
  const KeyFrameId id = workers_.mapper().InsertTwoViews(two);
  const MapSnapshot map = workers_.map().Snapshot();
  const KeyFrame& keyframe = *map.Find(id);
  map_ = keyframe.map;
  keyframes_[0] = keyframe.parent;
  keyframes_[1] = id;
  workers_.Keep(keyframe.parent, views->a->picture.get());
  workers_.Keep(id, two.b->picture.get());
  begun_points_ =
      static_cast<int>(std::count_if(keyframe.landmarks.begin(), keyframe.landmarks.end(),
                                     [](LandmarkId landmark) { return landmark.valid(); }));
  trial_left_ = settings_.start.trial_frames;
  started_ = frame->number;
  still_ = moved_ = 0;
  views_ = {{views->a->number, views->a->glance, {}}};
  const KeyFrame& parent = *map.Find(keyframe.parent);
  for (size_t i = 0; i < parent.landmarks.size(); ++i) {
    if (parent.landmarks[i].valid())
      views_[0].pixels[parent.landmarks[i]] = views->a->keypoints[i].pixel();
  }
  return Begun{{frame, keyframe.T_camera_world, keyframe.landmarks, begun_points_, {}},
               id,
               map,
               begun_points_ >= settings_.start.two_view.min_triangulated};
}

bool YoungMap::Confirm(const TrackEstimate& estimate) {
  // Share of the landmarks that should be visible, not of all: a driving camera passes many of them
  // within five frames.
  const auto in_sight = static_cast<double>(estimate.sightings.size());
  if (!estimate.tracked || estimate.placed.inliers < settings_.start.trial_share * in_sight)
    return false;
  if (--trial_left_ == 0) {
    for (KeyFrameId id : keyframes_) workers_.AddMapped(id);
  }
  return true;
}

bool YoungMap::IsYoung(const Frame& frame, KeyFrameId reference, const MapSnapshot& map) const {
  return started_ >= 0 && frame.number - started_ <= kYoung && map.MapOf(reference) == map_;
}

bool YoungMap::StandsStill(const PlacedFrame& placed) {
  const MonoStartSettings& settings = settings_.start;
  View view{placed.frame->number, placed.frame->glance, {}};
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    if (placed.matches[i].valid())
      view.pixels[placed.matches[i]] = placed.frame->keypoints[i].pixel();
  }
  const View* before = LastBeforeMotion(view.pixels, view.number);
  if (before) {
    const bool stays = StillShare(before->glance, view.glance) >= settings.max_still_picture;
    ++(stays ? still_ : moved_);
  }
  views_.push_back(std::move(view));
  if (views_.size() > size_t{kStillFrames}) views_.erase(views_.begin());
  return still_ >= settings.min_still_frames && still_ > moved_;
}

// The newest such view, not an older one: a moving camera may have come back to an older view, and
// arms in front of a stationary camera hide more and more of it.
const YoungMap::View* YoungMap::LastBeforeMotion(const Pixels& now, int number) const {
  constexpr size_t kFewest = 20;  // landmarks that both views must show
  for (auto view = views_.rbegin(); view != views_.rend(); ++view) {
    if (number - view->number > kStillFrames) break;
    std::vector<double> motion;
    for (const auto& [landmark, pixel] : now) {
      const auto then = view->pixels.find(landmark);
      if (then != view->pixels.end()) motion.push_back((pixel - then->second).norm());
    }
    if (motion.size() >= kFewest && UpperMedian(motion) >= least_motion_) return &*view;
  }
  return nullptr;
}

void YoungMap::SetCamera(const Camera& camera, double focal_sigma) {
  settings_.start.two_view.lens_uncertainty = 3 * focal_sigma;
  start_ = MonoStart(camera, settings_.start);
  views_.clear();  // their pixels are of another camera
}

void YoungMap::Drop() {
  if (map_.valid()) workers_.Drop(map_);
  map_ = {};
  start_.Reset();
  trial_left_ = 0;
  started_ = -1;
  views_.clear();
}

}  // namespace alidade
