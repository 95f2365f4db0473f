#include "alidade/calibration/camera_correction.h"

#include <memory>
#include <utility>
#include <vector>

#include "alidade/base/median.h"
#include "alidade/features/rolling_shutter.h"
#include "alidade/features/undistort.h"

namespace alidade {
namespace {

// Inverse depth of each keypoint's landmark, 1 / map units; 0: no landmark.
std::vector<float> InverseDepths(const MapCommit& commit, const KeyFrame& keyframe) {
  std::vector<float> inverse_depths(keyframe.landmarks.size(), 0.0f);
  for (size_t i = 0; i < inverse_depths.size(); ++i) {
    const LandmarkId id = keyframe.landmarks[i];
    const Landmark* landmark = id.valid() ? commit.Find(id) : nullptr;
    if (!landmark) continue;
    const double z = (keyframe.T_camera_world * landmark->p_world).z();
    if (z > 0) inverse_depths[i] = static_cast<float>(1 / z);
  }
  return inverse_depths;
}

std::vector<KeyFrameId> LiveKeyFrames(const MapCommit& commit) {
  std::vector<KeyFrameId> ids;
  commit.state().keyframes.ForEach([&](const KeyFrame& keyframe) { ids.push_back(keyframe.id); });
  return ids;
}

}  // namespace

Vector6d MotionOf(const KeyFrame& keyframe) {
  Vector6d motion = keyframe.frame->motion;
  motion.head<3>() *= keyframe.scale;
  return motion;
}

void CommitShutter(MapCommit& commit, const Camera& camera) {
  for (KeyFrameId id : LiveKeyFrames(commit)) {
    const KeyFrame* keyframe = commit.Find(id);
    if (keyframe->frame->motion.isZero(0)) continue;
    const std::vector<float> inverse_depths = InverseDepths(commit, *keyframe);
    std::vector<float> known;
    for (float w : inverse_depths) {
      if (w > 0) known.push_back(w);
    }
    auto frame = std::make_shared<Frame>(*keyframe->frame);
    const Vector6d motion = frame->motion;
    UndoRollingShutter(camera, MotionOf(*keyframe), inverse_depths,
                       known.empty() ? 0 : UpperMedian(known), *frame);
    frame->motion = motion;  // stays in map units at the keyframe's creation
    commit.Edit(id)->frame = std::move(frame);
  }
}

void CommitCamera(MapCommit& commit, const Camera& camera) {
  for (KeyFrameId id : LiveKeyFrames(commit)) {
    auto frame = std::make_shared<Frame>(*commit.Find(id)->frame);
    UndistortKeypoints(camera, *frame);
    commit.Edit(id)->frame = std::move(frame);
  }
  if (camera.RollingShutter()) CommitShutter(commit, camera);
}

}  // namespace alidade
