#include "alidade/run/merge/merge_inputs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/folder/output_folder.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/run/world/written_turn.h"

namespace alidade {
namespace {

constexpr double kSameTime = 1e-6;  // seconds: stamps are written with at least 6 digits

std::string OwnName(const std::string& path) {
  const std::filesystem::path whole = std::filesystem::path(path + "/").lexically_normal();
  std::filesystem::path last = whole.parent_path().filename();
  if (last == "map.alidade")
    last = std::filesystem::absolute(whole).parent_path().parent_path().filename();
  if (last.extension() == ".alidade") last = last.stem();
  return last.empty() ? "map" : last.string();
}

// monday, monday-2, …
std::string Fresh(const std::string& name, std::set<std::string>& taken) {
  std::string fresh = name;
  for (int i = 2; !taken.insert(fresh).second; ++i) fresh = name + "-" + std::to_string(i);
  return fresh;
}

// Existing keyframes by time; of those with equal times (a recording added to the map of another)
// the newest.
std::map<double, KeyFrameId> ByTime(const MapSnapshot& map) {
  std::map<double, KeyFrameId> by_time;
  map.keyframes().ForEach(
      [&](const KeyFrame& keyframe) { by_time[keyframe.frame->time] = keyframe.id; });
  return by_time;
}

KeyFrameId KeyFrameAt(const std::map<double, KeyFrameId>& by_time, double time) {
  const auto it = by_time.lower_bound(time - kSameTime);
  return it != by_time.end() && it->first <= time + kSameTime ? it->second : KeyFrameId{};
}

// The keyframes of the trajectory file, with the corresponding ones of the map.
std::vector<std::pair<StampedPose, KeyFrameId>> Known(const Trajectory& written,
                                                      const std::map<double, KeyFrameId>& by_time) {
  std::vector<std::pair<StampedPose, KeyFrameId>> known;
  for (const StampedPose& pose : written) {
    const KeyFrameId id = KeyFrameAt(by_time, pose.time);
    if (id.valid()) known.push_back({pose, id});
  }
  return known;
}

void ReadPaths(MergeInput& input) {
  const std::map<double, KeyFrameId> by_time = ByTime(input.saved.map);
  const bool is_folder = IsFolder(input.path);
  bool turn_known = false;
  for (size_t i = 0; is_folder; ++i) {
    const std::string frames = input.path + "/" + NumberedFile("trajectory", i),
                      keyframes = input.path + "/" + NumberedFile("keyframes", i);
    if (!IsFile(frames) || !IsFile(keyframes)) break;
    const auto known = Known(ReadTrajectory(keyframes), by_time);
    if (known.empty()) continue;
    if (!std::exchange(turn_known, true))
      input.R_camera_rectified = WrittenTurn(input.saved.map, known);
    std::map<MapId, int> votes;
    for (const auto& [pose, id] : known) ++votes[input.saved.map.MapOf(id)];
    const auto most =
        std::max_element(votes.begin(), votes.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    input.paths.push_back({most->first, ReadTrajectory(frames), false});
  }
  if (!input.paths.empty()) return;
  for (MapId id : input.saved.map.Maps()) {
    Path path{id, {}, true};
    for (KeyFrameId keyframe : input.saved.map.KeyFramesOf(id)) {
      const KeyFrame& k = *input.saved.map.Find(keyframe);
      path.frames.push_back({k.frame->time, k.T_camera_world.Inverse(), {}});
    }
    input.paths.push_back(std::move(path));
  }
}

// Poses of a keyframe before and after the merge, in the trajectories' convention.
struct Moved {
  double time = 0;
  Se3 T_old, T_new;  // T_world_camera
  double growth = 1;

  Se3 Of(const Se3& T_world_frame) const {
    Se3 T_here_frame = T_old.Inverse() * T_world_frame;
    T_here_frame.t *= growth;
    return T_new * T_here_frame;
  }
};

// Interpolates from `a` to `b`.
Se3 Blend(const Se3& a, const Se3& b, double share) {
  const Eigen::Quaterniond R =
      Eigen::Quaterniond(a.R).slerp(share, Eigen::Quaterniond(b.R)).normalized();
  return {R.toRotationMatrix(), (1 - share) * a.t + share * b.t};
}

}  // namespace

std::vector<MergeInput> ReadMergeInputs(const std::vector<std::string>& paths) {
  if (paths.size() < 2) ThrowUsage("nothing to merge: give at least two maps");
  std::vector<MergeInput> inputs;
  std::set<std::string> names;
  for (const std::string& path : paths) {
    MergeInput input;
    input.name = Fresh(OwnName(path), names);
    input.path = path;
    input.saved = ReadSavedMap(path);
    if (input.saved.map.keyframe_count() == 0)
      ThrowInput(SavedMapPath(path) + ": the map is empty");
    ReadPaths(input);
    inputs.push_back(std::move(input));
  }
  return inputs;
}

std::vector<Path> MovedPaths(const MergeInput& input, const UnitedPart& part,
                             const MapSnapshot& merged) {
  const Se3 turn{input.R_camera_rectified, Eigen::Vector3d::Zero()};
  const auto mounted = [&](const Se3& T_camera_world) {
    return turn * T_camera_world.Inverse() * turn.Inverse();
  };
  std::vector<Path> paths;
  for (const Path& path : input.paths) {
    std::vector<Moved> moved;
    MapId world;
    for (const auto& [time, id] : ByTime(input.saved.map)) {
      const KeyFrame& old = *input.saved.map.Find(id);
      if (old.map != path.world) continue;
      const KeyFrame& now = *merged.Find(KeyFrameId{id.value + part.first_keyframe});
      moved.push_back(
          {time, mounted(old.T_camera_world), mounted(now.T_camera_world), now.scale / old.scale});
      world = now.map;
    }
    Path there{world, path.frames, path.keyframes_only};
    for (StampedPose& pose : there.frames) {
      const auto after =
          std::lower_bound(moved.begin(), moved.end(), pose.time,
                           [](const Moved& m, double time) { return m.time < time; });
      const Moved& b = after == moved.end() ? moved.back() : *after;
      const Moved& a = after == moved.begin() ? moved.front() : *(after - 1);
      const Se3& T = pose.T_world_camera;
      const double span = b.time - a.time;
      pose.T_world_camera =
          span > 0 ? Blend(a.Of(T), b.Of(T), std::clamp((pose.time - a.time) / span, 0.0, 1.0))
                   : a.Of(T);
    }
    paths.push_back(std::move(there));
  }
  return paths;
}

}  // namespace alidade
