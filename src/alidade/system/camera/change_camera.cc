#include "alidade/system/camera/change_camera.h"

#include <memory>
#include <utility>
#include <vector>

#include "alidade/map/adjust.h"

namespace alidade {
namespace {

std::shared_ptr<const Frame> FrameWith(const Frame& frame, const Camera& from, const Camera& to) {
  auto changed = std::make_shared<Frame>(frame);
  for (Keypoint& keypoint : changed->keypoints) {
    const Eigen::Vector2d raw(keypoint.raw_x, keypoint.raw_y);
    const Eigen::Vector2d moved = to.Undistort(raw) - from.Undistort(raw);
    keypoint.x += static_cast<float>(moved.x());
    keypoint.y += static_cast<float>(moved.y());
  }
  changed->grid = KeypointGrid(changed->keypoints, to.width, to.height);
  return changed;
}

}  // namespace

void AdjustWholeMap(MapStore& store, MapId id, const Camera& camera, const SlamSettings& settings,
                    const std::function<void(const char* what, int keyframes)>& step) {
  for (const char* round : {"adjusting all keyframes", "adjusting all keyframes again"}) {
    const MapSnapshot map = store.Snapshot();
    const std::vector<KeyFrameId> ids = map.KeyFramesOf(id);
    if (step) step(round, static_cast<int>(ids.size()));
    std::vector<KeyFrameId> free, fixed;
    for (KeyFrameId keyframe : ids)
      (map.Find(keyframe)->parent.valid() ? free : fixed).push_back(keyframe);
    const AdjustSettings adjust{settings.loop.noise, settings.loop.bundle};
    const Adjustment adjusted = AdjustKeyFrames(map, free, fixed, camera, adjust, nullptr);
    store.Commit([&](MapCommit& commit) {
      CommitAdjustment(commit, map, adjusted);
      const size_t needed = camera.bf() > 0 ? 1 : 2;  // observations that determine a position
      for (const auto& [landmark, keyframe] : adjusted.outliers) {
        const Landmark* left = commit.Find(landmark);
        if (left && left->observations.size() < needed) commit.Remove(landmark);
      }
      for (const auto& [landmark, p_world] : adjusted.points) commit.RefreshLandmark(landmark);
      for (KeyFrameId keyframe : ids) commit.RefreshCovisibility(keyframe);
      commit.CountCorrection();
    });
  }
}

SavedMap WithCamera(const SavedMap& saved, const Camera& camera, const SlamSettings& settings) {
  MapStore store;
  store.Restore(saved.map);
  store.Commit([&](MapCommit& commit) {
    for (KeyFrameId id : saved.map.KeyFrames())
      commit.Edit(id)->frame = FrameWith(*saved.map.Find(id)->frame, saved.camera, camera);
  });
  for (MapId id : saved.map.Maps()) AdjustWholeMap(store, id, camera, settings, {});
  SavedMap changed = saved;
  changed.map = store.Snapshot();
  changed.camera = camera;
  return changed;
}

}  // namespace alidade
