// What any thread may ask beside Track(): answered from what is published and never changes again.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/map/map_file.h"
#include "alidade/system/movers.h"
#include "alidade/system/slam_impl.h"

namespace alidade {

void Slam::Impl::Show() {
  const auto shown = std::make_shared<Shown>(Shown{last_.frame, last_.matches,
                                                   movers_.BeliefOfCells(), last_keyframe_,
                                                   movers_.detections(), movers_.detections_age()});
  const std::lock_guard<std::mutex> lock(shown_mutex_);
  shown_ = shown;
}

SlamHealth Slam::Health() const { return impl_->Health(); }
MapSnapshot Slam::Snapshot() const { return impl_->workers_.map().Snapshot(); }
double Slam::readout_sigma() const { return impl_->workers_.readout_sigma(); }
Camera Slam::camera() const { return impl_->CameraNow(); }
std::optional<CameraEstimate> Slam::camera_found() const {
  return impl_->workers_.lens_watch().found();
}
int Slam::camera_changes() const { return impl_->camera_changes_; }
int Slam::frames() const { return impl_->frames_; }
int Slam::first_number() const { return impl_->first_number_; }

std::vector<FeatureUse> Slam::Features() const {
  std::vector<FeatureUse> features;
  const auto last = impl_->shown();
  if (!last) return features;
  const MapSnapshot map = impl_->workers_.map().Snapshot();
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
  const auto last = impl_->shown();
  if (!last || !last->detections) return {};
  ShownDetections shown{last->frame->number - last->detections->number,
                        last->detections_age,
                        last->detections->detections,
                        {}};
  const std::vector<std::string>& names = impl_->movers_.class_names();
  for (const Detection& d : shown.detections) {
    const auto index = static_cast<size_t>(d.class_id);
    shown.names.push_back(d.class_id >= 0 && index < names.size() ? names[index] : "");
  }
  return shown;
}

cv::Mat Slam::MoverMask() const {
  const auto last = impl_->shown();
  if (!last || last->belief_of_cells.empty()) return {};
  return MaskOf(last->belief_of_cells, {impl_->camera_.width, impl_->camera_.height});
}

SlamCounts Slam::Counts() const {
  return {impl_->relocalisations_, impl_->workers_.loops(), impl_->workers_.merges(), impl_->cuts_,
          impl_->predicted_,       impl_->log_.let_go()};
}

SemiDenseReport Slam::SemiDense() const { return impl_->workers_.SemiDense(); }

SavedMap Slam::Saved() const {
  // Places first: they are never ahead of the map then, which may grow meanwhile.
  SavedPlaces places = impl_->workers_.places().Save();
  return {Snapshot(), impl_->CameraNow(), NameOf(impl_->settings_.sensor), impl_->settings_.All(),
          std::move(places)};
}

std::string Slam::SaveMap() const { return EncodeMap(Saved()); }

StageTimes Slam::Times() const {
  StageTimes times;
  times.frame = impl_->frame_ms_.All();
  times.extract = impl_->extract_ms_.All();
  times.track = impl_->track_ms_.All();
  times.map = impl_->workers_.map_milliseconds().All();
  times.loop = impl_->workers_.loop_milliseconds().All();
  times.semidense = impl_->workers_.semidense_milliseconds().All();
  times.detect = impl_->movers_.detector_milliseconds().All();
  times.dynamics = impl_->movers_.milliseconds().All();
  return times;
}

LatestTimes Slam::Latest() const {
  const Workers& workers = impl_->workers_;
  const MoverWatch& movers = impl_->movers_;
  return {impl_->frame_ms_.Last(),
          impl_->extract_ms_.Last(),
          impl_->track_ms_.Last(),
          workers.map_milliseconds().Last(),
          workers.loop_milliseconds().Last(),
          workers.semidense_milliseconds().Last(),
          movers.detector_milliseconds().Last(),
          movers.milliseconds().Last()};
}

std::vector<FramePose> Slam::Trajectory(int since) const {
  return impl_->log_.Trajectory(impl_->workers_.map(), since);
}

}  // namespace alidade
