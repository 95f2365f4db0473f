#include "alidade/run/folder/final_state.h"

#include <algorithm>

#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"

namespace alidade {
namespace {

std::optional<Cloud> CloudIn(const std::string& path) {
  if (!IsFile(path)) return std::nullopt;
  return DecodePly(ReadFile(path, size_t{1} << 31), path);
}

}  // namespace

FinalState FinalStateIn(const std::string& results) {
  FinalState state;
  const std::string trajectory = results + "/trajectory.txt";
  if (IsFile(trajectory)) {
    const std::string text = ReadFile(trajectory);
    // otherwise it has only a header: nothing was tracked
    if (text.find_first_of('\n') + 1 < text.size())
      state.trajectory = ParseTumTrajectory(text, trajectory);
  }
  state.landmarks = CloudIn(results + "/landmarks.ply");
  state.shape = CloudIn(results + "/semidense.ply");
  return state;
}

FinalState FinalStateOf(const SavedMap& saved, const MapPart& part) {
  FinalState state;
  for (KeyFrameId id : part.keyframes) {
    const KeyFrame& keyframe = *saved.map.Find(id);
    state.trajectory.push_back({keyframe.frame->time, keyframe.T_camera_world.Inverse(), {}});
  }
  std::stable_sort(state.trajectory.begin(), state.trajectory.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  state.landmarks.emplace();
  for (LandmarkId id : part.landmarks)
    state.landmarks->points.push_back(saved.map.Find(id)->p_world.cast<float>());
  return state;
}

}  // namespace alidade
