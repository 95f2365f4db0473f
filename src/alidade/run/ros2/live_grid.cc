#include "alidade/run/ros2/live_grid.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/features/depth_image.h"
#include "alidade/run/export/pinhole_images.h"
#include "alidade/surface/stereo_depth.h"

namespace alidade {
namespace {

constexpr double kNearestMatched = 0.3;  // meters, of depth from a pair: nearer is not matched

cv::Mat1f EachOf(const cv::Mat1f& image, int k) {
  cv::Mat1f kept(image.rows / k, image.cols / k);
  for (int y = 0; y < kept.rows; ++y) {
    for (int x = 0; x < kept.cols; ++x) kept(y, x) = image(k * y + k / 2, k * x + k / 2);
  }
  return kept;
}

// Every k-th pixel of a depth image, with its camera.
DenseView Thinned(DenseView view, int most_width) {
  const int k = (view.depth.cols + most_width - 1) / most_width;
  if (k <= 1) return view;
  const int middle = k / 2;
  view.depth = EachOf(view.depth, k);
  view.inverse_sigmas = EachOf(view.inverse_sigmas, k);
  view.camera.fx /= k;
  view.camera.fy /= k;
  view.camera.cx = (view.camera.cx - middle) / k;
  view.camera.cy = (view.camera.cy - middle) / k;
  view.camera.width = view.depth.cols;
  view.camera.height = view.depth.rows;
  return view;
}

// How far a point at `range` moves between two poses, at most.
double MotionAt(double range, const Se3& a, const Se3& b) {
  const Vector6d motion = (a.Inverse() * b).Log();
  return motion.head<3>().norm() + range * motion.tail<3>().norm();
}

}  // namespace

LiveGrid::LiveGrid(const LiveGridSettings& settings, const WatchedRun& run, const Se3& T_map_world,
                   Tell tell)
    : settings_(settings),
      slam_(run.slam),
      source_(run.setup.source),
      T_map_view_world_(T_map_world * Se3{source_.R_camera_rectified, Eigen::Vector3d::Zero()}),
      tell_(std::move(tell)) {
  if (source_.sensor == Sensor::kMono)
    ThrowUsage("a grid needs depth images or a stereo pair: one camera tells no depth of floors");
  thread_ = std::thread([this] { Work(); });
}

LiveGrid::~LiveGrid() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveGrid::Add(const SourceFrame& frame, const TrackResult& result) {
  const bool stereo = source_.sensor == Sensor::kStereo;
  const cv::Mat& partner = stereo ? frame.right : frame.depth;
  if (!result.keyframe || partner.empty()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.push_back(
      {slam_.first_number() + slam_.frames() - 1, stereo ? frame.image : cv::Mat(), partner});
}

void LiveGrid::Work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ends_) {
    changed_.wait_for(lock, std::chrono::duration<double>(settings_.period), [&] { return ends_; });
    const std::vector<Waiting> waiting = std::exchange(waiting_, {});
    lock.unlock();
    try {
      for (const Waiting& one : waiting) kept_[one.number].view = ViewOf(one);
      Place(slam_.Snapshot());
      if (!kept_.empty() && FindTheFloor()) Fuse();
    } catch (...) {
      LogWarning("the grid was not updated: " + WhatOf(std::current_exception()));
    }
    lock.lock();
  }
}

DenseView LiveGrid::ViewOf(const Waiting& waiting) const {
  DenseView view;
  Camera recorded = slam_.camera();
  const double larger = static_cast<double>(source_.camera.width) / recorded.width;
  if (source_.sensor == Sensor::kStereo) {
    recorded.fx *= larger;
    const StereoMatch match =
        MatchStereo(waiting.image, waiting.partner, recorded, kNearestMatched);
    view.depth = match.depth;
    view.inverse_sigmas = match.inverse_sigmas;
    view.inverse_sigma = kDisparitySigma / (recorded.fx * recorded.baseline);
  } else {
    const DepthImage image(waiting.partner, source_.camera);
    view.depth.create(waiting.partner.size());
    for (int y = 0; y < view.depth.rows; ++y) {
      for (int x = 0; x < view.depth.cols; ++x) view.depth(y, x) = image.At(x, y);
    }
    view.inverse_sigma = kSensorInverseSigma;
  }
  const PinholeImages pinhole(slam_.camera(), {source_.camera.width, source_.camera.height});
  view.depth = WithoutSteps(pinhole.ApplyNearest(view.depth));
  if (!view.inverse_sigmas.empty()) view.inverse_sigmas = pinhole.ApplyNearest(view.inverse_sigmas);
  view.camera = pinhole.camera();
  return Thinned(std::move(view), settings_.most_width);
}

void LiveGrid::Place(const MapSnapshot& map) {
  MapId newest;
  std::map<int, Se3> poses;  // T_map_camera, by Frame::number
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    if (kept_.count(keyframe.frame->number) != 0) newest = map.MapOf(id);
  }
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    if (map.MapOf(id) == newest)
      poses[keyframe.frame->number] = T_map_view_world_ * keyframe.T_camera_world.Inverse();
  }
  for (auto kept = kept_.begin(); kept != kept_.end();) {
    const auto pose = poses.find(kept->first);
    if (pose == poses.end()) {
      if (kept->second.used) grid_ = nullptr;
      kept = kept_.erase(kept);
      continue;
    }
    kept->second.view.T_world_camera = pose->second;
    ++kept;
  }
}

bool LiveGrid::FindTheFloor() {
  constexpr size_t kViews = 60;  // evenly spread: more do not tell more of a plane
  const size_t step = 1 + kept_.size() / kViews;
  std::vector<DenseView> views;
  bool more = !T_map_floor_;
  size_t i = 0;
  for (const auto& [number, kept] : kept_) {
    if (i++ % step == 0) views.push_back(kept.view);
    more = more || !kept.used;
  }
  if (!more) return true;
  const std::optional<Floor> floor = FindFloor(views, Eigen::Vector3d::UnitZ());
  if (!floor) return T_map_floor_.has_value();
  const Se3 found = floor->FrameFor(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX()).Inverse();
  const double range = settings_.occupancy.SharpRange(views.front());
  if (T_map_floor_ && MotionAt(range, *T_map_floor_, found) < settings_.occupancy.clearance)
    return true;
  T_map_floor_ = found;
  grid_ = nullptr;
  return true;
}

void LiveGrid::Fuse() {
  bool anew = !grid_;
  for (const auto& [number, kept] : kept_) {
    const double range = settings_.occupancy.SharpRange(kept.view);
    if (kept.used &&
        MotionAt(range, *kept.used, kept.view.T_world_camera) > settings_.occupancy.cell)
      anew = true;
  }
  if (anew) grid_ = std::make_unique<OccupancyMap>(settings_.occupancy, T_map_floor_->Inverse());
  bool added = false;
  for (auto& [number, kept] : kept_) {
    if (kept.used && !anew) continue;
    grid_->Add(kept.view);
    kept.used = kept.view.T_world_camera;
    added = true;
  }
  if (added) tell_(grid_->Picture(), *T_map_floor_);
}

}  // namespace alidade
