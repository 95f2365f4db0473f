#include "alidade/system/young_map.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "alidade/base/median.h"
#include "alidade/features/glance.h"

namespace alidade {

YoungMap::YoungMap(const Camera& camera, const SlamSettings& settings, Workers& workers)
    : settings_(settings), workers_(workers), start_(camera, settings.start) {}

std::optional<YoungMap::Begun> YoungMap::Begin(const std::shared_ptr<const Frame>& frame) {
  const auto views = start_.Add(frame);
  if (!views) return {};
  Mapper::TwoViewMap two;
  const auto first = std::make_shared<Frame>(*views->a);  // the map keeps no pictures
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
  first_glance_ = views->a->glance;
  still_ = moved_ = 0;
  first_pixels_.clear();
  const KeyFrame& parent = *map.Find(keyframe.parent);
  for (size_t i = 0; i < parent.landmarks.size(); ++i) {
    if (parent.landmarks[i].valid())
      first_pixels_[parent.landmarks[i]] = views->a->keypoints[i].pixel();
  }
  return Begun{{frame, keyframe.T_camera_world, keyframe.landmarks, begun_points_, {}},
               id,
               map,
               begun_points_ >= settings_.start.two_view.min_triangulated};
}

bool YoungMap::Confirm(const TrackEstimate& estimate) {
  // Of the points that should be in sight: a camera that drives leaves many behind in five frames.
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
  constexpr int kFewest = 20;  // landmarks of the first view that must be in sight
  const MonoStartSettings& settings = settings_.start;
  std::vector<double> motion;
  for (size_t i = 0; i < placed.matches.size(); ++i) {
    const auto first = first_pixels_.find(placed.matches[i]);
    if (first != first_pixels_.end())
      motion.push_back((placed.frame->keypoints[i].pixel() - first->second).norm());
  }
  // A camera that came back to where it was shows the same picture, too.
  if (static_cast<int>(motion.size()) < kFewest ||
      UpperMedian(motion) < settings.min_still_motion * placed.frame->image.cols)
    return false;
  const bool stays = StillShare(first_glance_, placed.frame->glance) >= settings.max_still_picture;
  ++(stays ? still_ : moved_);
  return still_ >= settings.min_still_frames && still_ > moved_;
}

void YoungMap::SetCamera(const Camera& camera, double focal_sigma) {
  settings_.start.two_view.lens_uncertainty = 3 * focal_sigma;
  start_ = MonoStart(camera, settings_.start);
  first_pixels_.clear();  // of another camera
}

void YoungMap::GiveUp() {
  workers_.Drop(map_);
  start_.Reset();
  trial_left_ = 0;
  started_ = -1;
}

}  // namespace alidade
