#include "bench/parts/revisits.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/features/depth_image.h"
#include "alidade/features/extractor.h"
#include "alidade/io/association.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/sources/synth_source.h"
#include "alidade/slam.h"

namespace alidade::bench {
namespace {

// Of the landmarks of `a` (keypoints with depth), the share in view of `b`.
double ShareInView(const PosedFrame& a, const PosedFrame& b, const Camera& camera) {
  constexpr double kNear = 0.1;                         // metres: not seen so close
  constexpr double kHiddenRatio = 0.1, kHidden = 0.02;  // of the distance, and metres: depth's and
                                                        // poses' errors stay below
  constexpr int kFew = 20;                              // landmarks that say nothing
  const Se3 T_b_a = b.T_world_camera.Inverse() * a.T_world_camera;
  const DepthImage depth_of_b(b.depth, camera);
  int landmarks = 0, seen = 0;
  for (const Keypoint& keypoint : a.frame->keypoints) {
    if (!keypoint.has_depth()) continue;
    ++landmarks;
    const Eigen::Vector3d p = T_b_a * camera.Unproject(keypoint.pixel(), keypoint.depth);
    if (p.z() < kNear) continue;
    const Eigen::Vector2d pixel = camera.Project(p);
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > camera.width - 1 ||
        pixel.y() > camera.height - 1) {
      continue;
    }
    const Eigen::Vector2d raw = camera.Distort(pixel);
    const double there = depth_of_b.At(static_cast<int>(std::lround(raw.x())),
                                       static_cast<int>(std::lround(raw.y())));
    if (there > 0 && std::abs(there - p.z()) > kHiddenRatio * p.z() + kHidden) continue;
    ++seen;
  }
  return landmarks < kFew ? 0 : static_cast<double>(seen) / landmarks;
}

double Shared(const PosedFrame& a, const PosedFrame& b, const Camera& camera) {
  return std::min(ShareInView(a, b, camera), ShareInView(b, a, camera));
}

std::vector<std::optional<Se3>> PosesFromTruth(const Recording& recording) {
  const Trajectory truth = ReadTrajectory(recording.source);
  std::vector<double> ours, theirs;
  for (const SourceFrame& frame : recording.frames) ours.push_back(frame.time);
  for (const StampedPose& pose : truth) theirs.push_back(pose.time);
  std::vector<std::optional<Se3>> poses(ours.size());
  const Se3 T_camera_rectified{recording.info.R_camera_rectified, Eigen::Vector3d::Zero()};
  for (const auto& [i, k] : AssociateByTime(ours, theirs, 0.02)) {
    poses[i] = truth[k].T_world_camera * T_camera_rectified;
  }
  return poses;
}

std::vector<std::optional<Se3>> PosesFromSlam(const Recording& recording) {
  SlamSettings settings;
  settings.sensor = recording.info.sensor;
  Slam slam(recording.info.camera, settings);
  for (const SourceFrame& frame : recording.frames) {
    slam.Track({frame.time, frame.image, frame.right, frame.depth});
  }
  slam.Finish();
  std::vector<std::optional<Se3>> poses(recording.frames.size());
  for (const FramePose& pose : slam.Trajectory()) {
    if (pose.tracked) poses[pose.index] = pose.T_world_camera;
  }
  return poses;
}

}  // namespace

std::vector<std::optional<Se3>> PosesOf(const Recording& recording) {
  std::vector<std::optional<Se3>> poses;
  for (const SourceFrame& frame : recording.frames) poses.push_back(frame.T_world_camera);
  if (poses[0]) return poses;
  try {
    return PosesFromTruth(recording);
  } catch (const Error&) {
    return PosesFromSlam(recording);
  }
}

std::vector<PosedFrame> TakeFrames(const Recording& recording) {
  constexpr size_t kMost = 200;
  constexpr double kKeep = 0.9;  // of the last keyframe's view
  const Camera& camera = recording.info.camera;
  if (recording.info.sensor == Sensor::kMono) {
    ThrowUsage("bench place: needs a recording with depth or two cameras, to know what is in view");
  }
  const std::vector<std::optional<Se3>> poses = PosesOf(recording);
  Extractor extractor, right_extractor;
  std::vector<PosedFrame> frames;
  int keyframe = -1;
  const size_t step = (poses.size() + kMost - 1) / kMost;
  for (size_t i = 0; i < poses.size(); i += step) {
    if (!poses[i]) continue;
    const SourceFrame& from = recording.frames[i];
    Frame frame = extractor.Extract(from.image, camera, from.time, from.number);
    if (!from.depth.empty()) {
      AttachDepth(from.depth, camera, frame);
    } else if (!from.right.empty()) {
      MatchStereo(right_extractor.Extract(from.right, camera, from.time, from.number), camera,
                  frame);
    }
    frame.pyramid.clear();
    frames.push_back({std::make_shared<Frame>(std::move(frame)), *poses[i], from.depth});
    if (keyframe < 0 || Shared(frames[keyframe], frames.back(), camera) < kKeep) {
      keyframe = static_cast<int>(frames.size()) - 1;
      frames.back().keyframe = true;
    }
  }
  return frames;
}

SharedViews::SharedViews(const std::vector<PosedFrame>& frames, const Camera& camera)
    : size_(static_cast<int>(frames.size())), shared_(frames.size() * frames.size(), 1) {
  ParallelFor(size_, [&](int a) {
    for (int b = 0; b < size_; ++b) {
      if (a != b) shared_[a * size_ + b] = Shared(frames[a], frames[b], camera);
    }
  });
}

int SharedViews::LastOfEarlierVisits(int query) const {
  int last = query - 1;
  while (last >= 0 && At(query, last) >= 0.25) --last;
  return last;
}

}  // namespace alidade::bench
