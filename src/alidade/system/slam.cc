#include "alidade/system/slam.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/map/anchor.h"
#include "alidade/map/map_file.h"
#include "alidade/system/mapping_stage.h"
#include "alidade/tracking/tracker.h"

namespace alidade {
namespace {

Camera CameraInUse(Camera camera, const SlamSettings& settings) {
  camera.Check();
  if (settings.sensor != Sensor::kRgbd) camera.depth_factor = 0;
  if (settings.sensor != Sensor::kStereo) camera.baseline = 0;
  if (settings.sensor == Sensor::kRgbd && camera.depth_factor <= 0) {
    ThrowInput("camera: an RGB-D run needs depth_factor (depth image value per metre)");
  }
  if (settings.sensor == Sensor::kStereo && camera.baseline <= 0) {
    ThrowInput("camera: a stereo run needs the baseline between the cameras");
  }
  const bool shrink = settings.image_width > 0 && settings.image_width < camera.width;
  return shrink ? camera.ScaledToWidth(settings.image_width) : camera;
}

// One seed for every random choice.
SlamSettings Seeded(SlamSettings settings) {
  settings.tracker.seed = settings.start.two_view.seed = settings.seed;
  return settings;
}

// Where a frame is, by the keyframe it was placed against.
struct FrameRecord {
  double time = 0;
  bool tracked = false;
  Anchor anchor;
  Se3 T_world_camera_live;
};

}  // namespace

class Slam::Impl {
 public:
  Impl(const Camera& given, const SlamSettings& settings);
  TrackResult Track(const FrameInput& input);

  Camera given_;
  SlamSettings settings_;
  Camera camera_;
  MapStore map_;
  Tracker tracker_;
  MonoStart start_;
  Mapper mapper_;
  MappingStage mapping_;
  TrackState state_ = TrackState::kInitialising;
  std::vector<FrameRecord> records_;
  StageTimes times_;
  int relocalisations_ = 0;

 private:
  FrameInput Prepare(const FrameInput& input) const;
  TrackResult Start(const std::shared_ptr<Frame>& frame);
  TrackResult Continue(const std::shared_ptr<Frame>& frame);
  void Place(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map);
  void AddKeyFrame(PlacedFrame& placed, const Anchor& anchor);
  void GiveUpStart();

  int trial_left_ = 0;      // frames that have yet to confirm a young monocular map
  int trial_points_ = 0;    // landmarks it started with
  MapId map_id_;            // of that map
  size_t trial_begin_ = 0;  // first record placed in it
};

Slam::Impl::Impl(const Camera& given, const SlamSettings& settings)
    : given_(given),
      settings_(Seeded(settings)),
      camera_(CameraInUse(given, settings)),
      tracker_(camera_, settings_.tracker),
      start_(camera_, settings_.start),
      mapper_(map_, camera_, settings_.mapper),
      mapping_(mapper_, settings_.threaded) {
  settings_.Check();
}

FrameInput Slam::Impl::Prepare(const FrameInput& input) const {
  const auto check = [&](const cv::Mat& image, const char* what) {
    if (image.cols == given_.width && image.rows == given_.height) return;
    ThrowInput(std::string(what) + " of " + std::to_string(image.cols) + "x" +
               std::to_string(image.rows) + " pixels, but the camera has " +
               std::to_string(given_.width) + "x" + std::to_string(given_.height));
  };
  if (!std::isfinite(input.time)) ThrowInput("the frame's time is not a number");
  if (!records_.empty() && input.time <= records_.back().time)
    ThrowInput("the frame's time does not grow");
  check(input.image, "image");
  FrameInput prepared = input;
  if (settings_.sensor != Sensor::kStereo) prepared.right.release();
  if (settings_.sensor != Sensor::kRgbd) prepared.depth.release();
  if (!prepared.right.empty()) check(prepared.right, "right image");
  if (!prepared.depth.empty()) {
    check(prepared.depth, "depth image");
    if (prepared.depth.type() != CV_16U && prepared.depth.type() != CV_32F)
      ThrowInput("depth must be 16 bit or float");
  }
  for (cv::Mat* image : {&prepared.image, &prepared.right}) {
    if (image->empty()) continue;
    if (image->depth() != CV_8U) ThrowInput("images must have 8 bits per channel");
    if (image->channels() == 3) cv::cvtColor(*image, *image, cv::COLOR_BGR2GRAY);
    if (image->channels() == 4) cv::cvtColor(*image, *image, cv::COLOR_BGRA2GRAY);
    if (camera_.width != given_.width)
      cv::resize(*image, *image, {camera_.width, camera_.height}, 0, 0, cv::INTER_AREA);
  }
  if (!prepared.depth.empty() && camera_.width != given_.width) {
    cv::resize(prepared.depth, prepared.depth, {camera_.width, camera_.height}, 0, 0,
               cv::INTER_NEAREST);
  }
  return prepared;
}

TrackResult Slam::Impl::Track(const FrameInput& input) {
  const Stopwatch whole;
  const FrameInput prepared = Prepare(input);
  const Stopwatch extracting;
  const auto frame = tracker_.Extract(prepared.image, prepared.right, prepared.depth, prepared.time,
                                      static_cast<int>(records_.size()));
  times_.extract.push_back(extracting.Milliseconds());
  records_.push_back({});
  records_.back().time = input.time;
  const TrackResult result = state_ == TrackState::kInitialising ? Start(frame) : Continue(frame);
  times_.frame.push_back(whole.Milliseconds());
  return result;
}

// `map`: the one the pose is in.
void Slam::Impl::Place(const PlacedFrame& placed, KeyFrameId reference, const MapSnapshot& map) {
  FrameRecord& record = records_.back();
  record.tracked = true;
  record.anchor = AnchorTo(map.state(), reference, placed.T_camera_world);
  record.T_world_camera_live = placed.T_camera_world.Inverse();
  tracker_.Remember(placed, reference, map);
}

void Slam::Impl::AddKeyFrame(PlacedFrame& placed, const Anchor& anchor) {
  const KeyFrameId id = mapper_.Insert(placed.frame, anchor, placed.matches);
  const MapSnapshot map = map_.Snapshot();
  const KeyFrame& keyframe = *map.Find(id);
  placed.T_camera_world = keyframe.T_camera_world;
  placed.matches = keyframe.landmarks;
  tracker_.KeyFrameInserted(placed.frame->number);
  Place(placed, id, map);
  mapping_.Add(id);
}

TrackResult Slam::Impl::Start(const std::shared_ptr<Frame>& frame) {
  TrackResult result;
  if (settings_.sensor != Sensor::kMono) {
    int with_depth = 0;
    for (const Keypoint& keypoint : frame->keypoints) with_depth += keypoint.has_depth();
    const double wanted = 200 * settings_.tracker.match_scale;
    if (with_depth < wanted) {
      result.reason = "too few corners with depth";
      return result;
    }
    PlacedFrame placed;
    placed.frame = frame;
    placed.inliers = with_depth;
    AddKeyFrame(placed, Anchor{});
    result.matches = with_depth;
  } else {
    const auto views = start_.Add(frame);
    if (!views) {
      result.reason = start_.reason();
      return result;
    }
    Mapper::TwoViewMap two;
    two.a = views->a;
    two.b = views->b;
    two.T_b_a = views->T_b_a;
    for (const auto& p : views->points) two.points.push_back({p.p_a, p.keypoint_a, p.keypoint_b});
    const KeyFrameId id = mapper_.InsertTwoViews(two);
    const MapSnapshot map = map_.Snapshot();
    const KeyFrame* keyframe = map.Find(id);
    map_id_ = keyframe->map;
    trial_points_ =
        static_cast<int>(std::count_if(keyframe->landmarks.begin(), keyframe->landmarks.end(),
                                       [](LandmarkId landmark) { return landmark.valid(); }));
    trial_begin_ = records_.size() - 1;
    if (trial_points_ < settings_.start.two_view.min_triangulated) {
      GiveUpStart();
      result.reason = "the first points did not hold";
      return result;
    }
    trial_left_ = settings_.start.trial_frames;
    PlacedFrame placed{frame, keyframe->T_camera_world, keyframe->landmarks, trial_points_};
    tracker_.KeyFrameInserted(frame->number);
    Place(placed, id, map);
    result.matches = trial_points_;
  }
  state_ = TrackState::kTracking;
  result.state = state_;
  result.keyframe = true;
  result.T_world_camera = records_.back().T_world_camera_live;
  return result;
}

void Slam::Impl::GiveUpStart() {
  map_.Commit([&](MapCommit& commit) { commit.Remove(map_id_); });
  tracker_.Forget();
  start_.Reset();
  trial_left_ = 0;
  state_ = TrackState::kInitialising;
  for (size_t i = trial_begin_; i < records_.size(); ++i) records_[i].tracked = false;
}

TrackResult Slam::Impl::Continue(const std::shared_ptr<Frame>& frame) {
  const Stopwatch watch;
  const MapSnapshot map = map_.Snapshot();
  const bool was_lost = state_ == TrackState::kLost;
  PlacedFrame guess = was_lost ? tracker_.Recover(frame, map) : tracker_.Predict(frame, map);
  TrackEstimate estimate = tracker_.Estimate(std::move(guess), map);
  std::vector<std::pair<LandmarkId, bool>> sightings;
  for (const SightingCount& s : estimate.sightings) sightings.push_back({s.landmark, s.found});
  if (estimate.tracked) mapper_.Count(sightings);

  TrackResult result;
  if (trial_left_ > 0) {
    if (!estimate.tracked ||
        estimate.placed.inliers < settings_.start.trial_share * trial_points_) {
      GiveUpStart();
      result.reason = "the first points did not hold";
      times_.track.push_back(watch.Milliseconds());
      return result;
    }
    --trial_left_;
  }
  if (!estimate.tracked) {
    tracker_.Forget();
    state_ = TrackState::kLost;
    result.state = state_;
    result.reason = "too few landmarks found";
    times_.track.push_back(watch.Milliseconds());
    return result;
  }
  relocalisations_ += was_lost;
  state_ = TrackState::kTracking;
  // A busy mapper is not given more than it can chew; with depth the tracker lives on new
  // keyframes, so it may queue some.
  const bool may_insert = mapping_.backlog() < (settings_.sensor == Sensor::kMono ? 2 : 3);
  result.keyframe = estimate.wants_keyframe && trial_left_ == 0 && may_insert;
  times_.track.push_back(watch.Milliseconds());
  if (result.keyframe) {
    AddKeyFrame(estimate.placed,
                AnchorTo(map.state(), estimate.reference, estimate.placed.T_camera_world));
  } else {
    Place(estimate.placed, estimate.reference, map);
  }
  result.state = state_;
  result.matches = estimate.placed.inliers;
  result.T_world_camera = records_.back().T_world_camera_live;
  return result;
}

Slam::Slam(const Camera& camera, const SlamSettings& settings)
    : impl_(std::make_unique<Impl>(camera, settings)) {}
Slam::~Slam() = default;
TrackResult Slam::Track(const FrameInput& input) { return impl_->Track(input); }
void Slam::Finish() { impl_->mapping_.Drain(); }
MapSnapshot Slam::Snapshot() const { return impl_->map_.Snapshot(); }
const Camera& Slam::camera() const { return impl_->camera_; }
int Slam::relocalisations() const { return impl_->relocalisations_; }

std::string Slam::SaveMap() const {
  const Sensor sensor = impl_->settings_.sensor;
  const char* name = sensor == Sensor::kMono     ? "mono"
                     : sensor == Sensor::kStereo ? "stereo"
                                                 : "rgbd";
  return EncodeMap({Snapshot(), impl_->camera_, name, impl_->settings_.All()});
}

StageTimes Slam::Times() const {
  StageTimes times = impl_->times_;
  times.map = impl_->mapping_.Milliseconds();
  return times;
}

std::vector<FramePose> Slam::Trajectory() const {
  const MapSnapshot map = Snapshot();
  std::vector<FramePose> trajectory;
  for (size_t i = 0; i < impl_->records_.size(); ++i) {
    const FrameRecord& record = impl_->records_[i];
    FramePose pose;
    pose.index = static_cast<int>(i);
    pose.time = record.time;
    pose.tracked = record.tracked;
    if (record.tracked) {
      pose.T_world_camera = PoseOf(map.state(), record.anchor).Inverse();
      pose.T_world_camera_live = record.T_world_camera_live;
    }
    trajectory.push_back(pose);
  }
  return trajectory;
}

}  // namespace alidade
