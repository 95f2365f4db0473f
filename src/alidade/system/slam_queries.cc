// The queries of Slam: any thread may call them beside a driving call. They read published values
// that never change.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/map/map_file.h"
#include "alidade/system/movers.h"
#include "alidade/system/slam_impl.h"

namespace alidade {

Camera Slam::Impl::CameraNow() const {
  Camera camera = pipeline_.camera().Get();
  camera.readout = pipeline_.workers().readout();
  return camera;
}

SlamHealth Slam::Impl::Health() const {
  SlamHealth health{pipeline_.workers().health()};
  for (StageHealth& stage : pipeline_.movers().health()) health.stages.push_back(std::move(stage));
  return health;
}

SlamHealth Slam::Health() const { return impl_->Health(); }
MapSnapshot Slam::Snapshot() const { return impl_->pipeline().workers().map().Snapshot(); }
double Slam::readout_sigma() const { return impl_->pipeline().workers().readout_sigma(); }
Camera Slam::camera() const { return impl_->CameraNow(); }
std::optional<CameraEstimate> Slam::camera_found() const {
  return impl_->pipeline().workers().lens_watch().found();
}
int Slam::camera_changes() const { return impl_->pipeline().counts().camera_changes; }
int Slam::frames() const { return impl_->frames(); }
int Slam::first_number() const { return impl_->pipeline().first_number(); }

std::vector<FeatureUse> Slam::Features() const {
  std::vector<FeatureUse> features;
  const auto last = impl_->pipeline().last_frame().Get();
  if (!last) return features;
  const MapSnapshot map = Snapshot();
  constexpr uint32_t kNew = 2;  // keyframes
  const auto is_new = [&](LandmarkId id) {
    const Landmark* landmark = id.valid() ? map.Find(id) : nullptr;
    return landmark && map.next_keyframe() - 1 - landmark->born.value < kNew;
  };
  for (size_t k = 0; k < last->frame->keypoints.size(); ++k) {
    const Keypoint& keypoint = last->frame->keypoints[k];
    const LandmarkId shows = k < last->matches.size() ? last->matches[k] : LandmarkId{};
    features.push_back({keypoint.raw_x, keypoint.raw_y, last->frame->Static(static_cast<int>(k)),
                        shows.valid(), is_new(shows)});
  }
  // A keyframe's features are those that may enter the map, in the frame's order.
  const KeyFrame* keyframe = last->keyframe.valid() ? map.Find(last->keyframe) : nullptr;
  if (!keyframe) return features;
  const std::vector<int> kept = MappableKeypoints(*last->frame);
  if (kept.size() != keyframe->landmarks.size()) return features;
  for (size_t i = 0; i < kept.size(); ++i) {
    FeatureUse& feature = features[static_cast<size_t>(kept[i])];
    feature.fresh = feature.fresh || is_new(keyframe->landmarks[i]);
  }
  return features;
}

std::optional<ShownDetections> Slam::Detections() const {
  const auto last = impl_->pipeline().last_frame().Get();
  if (!last || !last->detections) return {};
  ShownDetections shown{last->frame->number - last->detections->number,
                        last->detections_age,
                        last->detections->detections,
                        {}};
  const std::vector<std::string>& names = impl_->pipeline().movers().class_names();
  for (const Detection& d : shown.detections) {
    const auto index = static_cast<size_t>(d.class_id);
    shown.names.push_back(d.class_id >= 0 && index < names.size() ? names[index] : "");
  }
  return shown;
}

cv::Mat Slam::MoverMask() const {
  const auto last = impl_->pipeline().last_frame().Get();
  if (!last || last->belief_of_cells.empty()) return {};
  return MaskOf(last->belief_of_cells, last->image_size);
}

InertialReport Slam::Inertial() const { return impl_->pipeline().inertial().Get(); }

SlamCounts Slam::Counts() const {
  const FramePipeline& pipeline = impl_->pipeline();
  SlamCounts counts;
  counts.relocalizations = pipeline.counts().relocalizations;
  counts.loops = pipeline.workers().loops();
  counts.merges = pipeline.workers().merges();
  counts.cuts = impl_->cuts();
  counts.predicted = pipeline.counts().predicted;
  counts.left_out = pipeline.left_out().share();
  counts.let_go = pipeline.trajectory().let_go();
  return counts;
}

SemiDenseReport Slam::SemiDense() const { return impl_->pipeline().workers().SemiDense(); }

SavedMap Slam::Saved() const {
  // Places first: then they never refer to keyframes that the snapshot does not have yet.
  SavedPlaces places = impl_->pipeline().workers().places().Save();
  Camera camera = impl_->CameraNow();
  if (const auto found = camera_found()) camera.focal_sigma = found->focal_sigma;
  return {Snapshot(), camera, NameOf(impl_->settings().sensor), impl_->settings().All(),
          std::move(places)};
}

std::string Slam::SaveMap() const { return EncodeMap(Saved()); }

StageTimes Slam::Times() const {
  const FramePipeline& pipeline = impl_->pipeline();
  StageTimes times;
  times.frame = impl_->frame_milliseconds().All();
  times.extract = pipeline.extract_milliseconds().All();
  times.track = pipeline.track_milliseconds().All();
  times.map = pipeline.workers().map_milliseconds().All();
  times.loop = pipeline.workers().loop_milliseconds().All();
  times.semidense = pipeline.workers().semidense_milliseconds().All();
  times.detect = pipeline.movers().detector_milliseconds().All();
  times.dynamics = pipeline.movers().milliseconds().All();
  return times;
}

LatestTimes Slam::Latest() const {
  const FramePipeline& pipeline = impl_->pipeline();
  return {impl_->frame_milliseconds().Last(),
          pipeline.extract_milliseconds().Last(),
          pipeline.track_milliseconds().Last(),
          pipeline.workers().map_milliseconds().Last(),
          pipeline.workers().loop_milliseconds().Last(),
          pipeline.workers().semidense_milliseconds().Last(),
          pipeline.movers().detector_milliseconds().Last(),
          pipeline.movers().milliseconds().Last()};
}

std::vector<FramePose> Slam::Trajectory(int since) const {
  return impl_->pipeline().trajectory().Trajectory(impl_->pipeline().workers().map(), since);
}

}  // namespace alidade
