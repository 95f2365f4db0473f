#include "alidade/run/export/result_stream.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/export/posed_frames.h"
#include "alidade/stream/stream_encoder.h"
#include "alidade/version.h"

namespace alidade {
namespace {

constexpr double kSameStamp = 1e-6;     // seconds
constexpr double kSamePosition = 1e-5;  // of the extent of the keyframes

// A keyframe's pose, in the world of the map and in that of the files.
struct PosedKeyFrame {
  double time = 0;  // seconds
  KeyFrameId id;
  Se3 T_map_camera, T_files_camera;
};

bool EarlierPosed(const PosedKeyFrame& a, const PosedKeyFrame& b) { return a.time < b.time; }

// Keyframes of the map that have a pose in the trajectory, by time.
std::vector<PosedKeyFrame> PosedKeyFramesIn(const Trajectory& trajectory, const SavedMap& saved,
                                            const MapPart& part) {
  std::vector<PosedKeyFrame> known;
  for (KeyFrameId id : part.keyframes) {
    const KeyFrame& keyframe = *saved.map.Find(id);
    const double time = keyframe.frame->time;
    const auto at =
        std::lower_bound(trajectory.begin(), trajectory.end(), time - kSameStamp,
                         [](const StampedPose& pose, double wanted) { return pose.time < wanted; });
    if (at == trajectory.end() || at->time > time + kSameStamp) continue;
    known.push_back({time, id, keyframe.T_camera_world.Inverse(), at->T_world_camera});
  }
  std::sort(known.begin(), known.end(), EarlierPosed);
  return known;
}

const PosedKeyFrame& NearestKeyFrame(double time, const std::vector<PosedKeyFrame>& known) {
  const auto after =
      std::lower_bound(known.begin(), known.end(), PosedKeyFrame{time, {}, {}, {}}, EarlierPosed);
  if (after == known.begin()) return *after;
  const auto before = std::prev(after);
  return after == known.end() || time - before->time < after->time - time ? *before : *after;
}

// Relative to the keyframe next in time, so that the path goes through the keyframes of the map.
std::vector<StreamFrame> PathFramesOf(const Trajectory& trajectory,
                                      const std::vector<PosedKeyFrame>& known,
                                      const MapSnapshot& map) {
  std::vector<StreamFrame> frames;
  for (const StampedPose& pose : trajectory) {
    const PosedKeyFrame& near = NearestKeyFrame(pose.time, known);
    StreamFrame frame;
    frame.time = pose.time;
    frame.result.state = TrackState::kTracking;
    frame.pose.tracked = true;
    frame.pose.reference = near.id;
    frame.pose.T_reference_camera = near.T_files_camera.Inverse() * pose.T_world_camera;
    frame.pose.T_reference_camera.t /= map.Find(near.id)->scale;
    frame.map = map;
    frames.push_back(std::move(frame));
  }
  return frames;
}

// By least squares over the positions of the keyframes (Umeyama 1991, without scale).
Se3 MapFromFiles(const std::vector<PosedKeyFrame>& known) {
  Eigen::Matrix3Xd files(3, known.size()), map(3, known.size());
  for (size_t i = 0; i < known.size(); ++i) {
    files.col(static_cast<long>(i)) = known[i].T_files_camera.t;
    map.col(static_cast<long>(i)) = known[i].T_map_camera.t;
  }
  const double extent = (map.colwise() - map.rowwise().mean().eval()).colwise().norm().maxCoeff();
  if (known.size() < 3 || (files - map).colwise().norm().maxCoeff() <= kSamePosition * extent)
    return {};
  const Eigen::Matrix4d T = Eigen::umeyama(files, map, false);
  return {T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>()};
}

}  // namespace

ResultStream StreamOfResult(const SavedMap& saved, const std::string& path) {
  StreamSource source;
  source.program = "alidade " ALIDADE_VERSION;
  source.source = path;
  source.sensor = saved.sensor;
  source.unit = saved.sensor == NameOf(Sensor::kMono) ? "map units" : "m";
  source.camera = saved.camera;
  StreamEncoder encoder(source);
  ResultStream result;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    const std::string cloud = path + "/semidense.ply";
    if (IsFile(cloud)) result.cloud = cloud;
    std::vector<StreamFrame> frames;
    for (const MapPart& part : PartsOf(saved.map)) {
      const std::string file = TrajectoryFileFor(saved, part, path);
      if (file.empty()) continue;
      Trajectory trajectory = ReadTrajectory(file);
      std::stable_sort(trajectory.begin(), trajectory.end(),
                       [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
      const std::vector<PosedKeyFrame> known = PosedKeyFramesIn(trajectory, saved, part);
      if (known.empty()) continue;
      if (frames.empty()) result.T_map_files = MapFromFiles(known);
      for (StreamFrame& frame : PathFramesOf(trajectory, known, saved.map))
        frames.push_back(std::move(frame));
    }
    std::stable_sort(frames.begin(), frames.end(),
                     [](const StreamFrame& a, const StreamFrame& b) { return a.time < b.time; });
    for (size_t i = 0; i < frames.size(); ++i) {
      frames[i].number = static_cast<int>(i);
      encoder.Add(frames[i]);
    }
  }
  encoder.End(saved.map);
  result.messages = encoder.Whole();
  result.messages.push_back(encoder.Playback({false, true, false}));
  return result;
}

}  // namespace alidade
