#include "alidade/run/export/posed_frames.h"

#include <algorithm>
#include <cmath>

#include "alidade/io/files/trajectory_file.h"
#include "alidade/map/view.h"
#include "alidade/run/world/moved_map.h"
#include "alidade/run/world/trajectory_file_for.h"

namespace alidade {
namespace {

constexpr double kSameMoment = 1e-6;   // seconds
constexpr double kLongestStep = 0.5;   // seconds between poses that tell a motion
constexpr double kMostMargin = 0.05;   // of the image's side
constexpr double kMarginShare = 0.95;  // of the frames

bool Earlier(const PosedFrame& a, const PosedFrame& b) { return a.time < b.time; }

std::vector<PosedFrame> KeyFramesByTime(const SavedMap& saved, const MapPart& part) {
  std::vector<PosedFrame> keyframes;
  for (KeyFrameId id : part.keyframes) {
    const KeyFrame& keyframe = *saved.map.Find(id);
    keyframes.push_back({keyframe.frame->time, keyframe.T_camera_world, id});
  }
  std::stable_sort(keyframes.begin(), keyframes.end(), Earlier);
  return keyframes;
}

}  // namespace

PosedFrames::PosedFrames(const SavedMap& saved, const MapPart& part, const std::string& folder,
                         const Eigen::Matrix3d& R_camera_rectified, const Sim3& T_now_then) {
  all_ = KeyFramesByTime(saved, part);
  for (KeyFrameId id : part.keyframes) {
    const KeyFrame& keyframe = *saved.map.Find(id);
    if (const auto depth = MedianDepth(saved.map, keyframe); depth && *depth > 0)
      inverse_depths_.push_back({keyframe.frame->time, 1 / *depth});
  }
  keyframes_ = all_.size();
  std::sort(inverse_depths_.begin(), inverse_depths_.end());
  if (const std::string file = TrajectoryFileFor(saved, part, folder); !file.empty()) {
    const Se3 turn{R_camera_rectified, Eigen::Vector3d::Zero()};
    for (const StampedPose& pose : ReadTrajectory(file)) {
      const Se3 T_world_camera = turn.Inverse() * pose.T_world_camera * turn;
      trajectory_.push_back({pose.time, InNewWorld(T_world_camera, T_now_then).Inverse(), {}});
    }
    std::stable_sort(trajectory_.begin(), trajectory_.end(), Earlier);
    all_.insert(all_.end(), trajectory_.begin(), trajectory_.end());
    std::stable_sort(all_.begin(), all_.end(), Earlier);
  }
}

std::vector<PosedFrame> PosedFrames::At(double time) const {
  std::vector<PosedFrame> found;
  auto at =
      std::lower_bound(all_.begin(), all_.end(), PosedFrame{time - kSameMoment, {}, {}}, Earlier);
  for (; at != all_.end() && at->time <= time + kSameMoment; ++at) found.push_back(*at);
  std::stable_partition(found.begin(), found.end(),
                        [](const PosedFrame& frame) { return frame.keyframe.valid(); });
  return found;
}

std::vector<double> PosedFrames::Times(bool keyframes_only) const {
  std::vector<double> times;
  for (const PosedFrame& frame : all_) {
    if (!keyframes_only || frame.keyframe.valid()) times.push_back(frame.time);
  }
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

ReadoutMotion PosedFrames::MotionAt(double time) const {
  ReadoutMotion readout;
  if (trajectory_.empty()) return readout;
  const auto after = std::lower_bound(trajectory_.begin(), trajectory_.end(),
                                      PosedFrame{time + kSameMoment, {}, {}}, Earlier);
  const auto here = std::lower_bound(trajectory_.begin(), trajectory_.end(),
                                     PosedFrame{time - kSameMoment, {}, {}}, Earlier);
  const auto a = here == trajectory_.begin() ? here : here - 1;
  const auto b = after == trajectory_.end() ? after - 1 : after;
  if (!(b->time > a->time) || b->time - a->time > 2 * kLongestStep) return readout;
  readout.motion = (b->T_camera_world * a->T_camera_world.Inverse()).Log() / (b->time - a->time);
  if (!inverse_depths_.empty()) {
    const auto next =
        std::lower_bound(inverse_depths_.begin(), inverse_depths_.end(), std::make_pair(time, 0.0));
    const auto last = next == inverse_depths_.begin() ? next : next - 1;
    const bool use_last = next == inverse_depths_.end() || time - last->first < next->first - time;
    readout.inverse_depth = (use_last ? last : next)->second;
  }
  return readout;
}

Eigen::Vector2d PosedFrames::MarginFor(const Camera& camera) const {
  Eigen::Vector2d margin = Eigen::Vector2d::Zero();
  if (!camera.RollingShutter() || trajectory_.empty()) return margin;
  std::vector<double> x, y;
  for (const PosedFrame& frame : trajectory_) {
    const ReadoutMotion readout = MotionAt(frame.time);
    double most_x = 0, most_y = 0;
    for (const double u : {0.0, camera.width - 1.0}) {
      for (const double v : {0.0, camera.height - 1.0}) {
        const Se3 later = Se3::Exp(camera.ReadAfterMiddle(u, v) * readout.motion);
        const Eigen::Vector3d ray = camera.Unproject(camera.Undistort({u, v})),
                              p = later.R * ray + readout.inverse_depth * later.t;
        if (!(p.z() > 0)) continue;
        const Eigen::Vector2d moved = camera.Project(p) - camera.Project(ray);
        most_x = std::max(most_x, std::abs(moved.x()));
        most_y = std::max(most_y, std::abs(moved.y()));
      }
    }
    x.push_back(most_x);
    y.push_back(most_y);
  }
  const auto at_share = [](std::vector<double>& values) {
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(
                                          kMarginShare * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  };
  return {std::min(at_share(x), kMostMargin * camera.width),
          std::min(at_share(y), kMostMargin * camera.height)};
}

}  // namespace alidade
