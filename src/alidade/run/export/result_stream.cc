#include "alidade/run/export/result_stream.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/export/posed_frames.h"
#include "alidade/run/world/moved_map.h"
#include "alidade/run/world/trajectory_file_for.h"
#include "alidade/run/world/written_turn.h"
#include "alidade/stream/stream_encoder.h"
#include "alidade/version.h"

namespace alidade {
namespace {

bool EarlierKnown(const KnownPose& a, const KnownPose& b) { return a.first.time < b.first.time; }

KeyFrameId NearestKeyFrame(double time, const std::vector<KnownPose>& known) {
  StampedPose wanted;
  wanted.time = time;
  const auto after =
      std::lower_bound(known.begin(), known.end(), KnownPose(wanted, KeyFrameId{}), EarlierKnown);
  if (after == known.begin()) return after->second;
  const auto before = std::prev(after);
  const bool use_before =
      after == known.end() || time - before->first.time < after->first.time - time;
  return (use_before ? before : after)->second;
}

// Anchored to the keyframe next in time. `turn`: WrittenTurn().
std::vector<StreamFrame> PathFramesOf(const Trajectory& trajectory,
                                      const std::vector<KnownPose>& known,
                                      const Eigen::Matrix3d& turn, const MapSnapshot& map) {
  const Se3 T_written_map{turn, Eigen::Vector3d::Zero()};
  std::vector<StreamFrame> frames;
  for (const StampedPose& pose : trajectory) {
    const KeyFrame& near = *map.Find(NearestKeyFrame(pose.time, known));
    StreamFrame frame;
    frame.time = pose.time;
    frame.result.state = TrackState::kTracking;
    frame.pose.tracked = true;
    frame.pose.reference = near.id;
    frame.pose.T_reference_camera =
        near.T_camera_world * (T_written_map.Inverse() * pose.T_world_camera * T_written_map);
    frame.pose.T_reference_camera.t /= near.scale;
    frame.map = map;
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace

ResultStream StreamOfResult(const SavedMap& saved, const std::string& path) {
  StreamSource source;
  source.program = "alidade " ALIDADE_VERSION;
  source.source = path;
  source.sensor = saved.sensor;
  const std::vector<MapPart> all = PartsOf(saved.map);
  source.unit =
      InMeters(saved, all.empty() ? MapId{} : WorldOf(saved, all.front()).map) ? "m" : "map units";
  source.camera = saved.camera;
  StreamEncoder encoder(source);
  ResultStream result;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    const std::string cloud = path + "/semidense.ply";
    if (IsFile(cloud)) result.cloud = cloud;
    const std::string mesh = path + "/mesh.ply";
    if (IsFile(mesh)) result.mesh = mesh;
    std::vector<StreamFrame> frames;
    for (const MapPart& part : PartsOf(saved.map)) {
      const std::string file = TrajectoryFileFor(saved, part, path);
      if (file.empty()) continue;
      Trajectory trajectory = ReadTrajectory(file);
      std::stable_sort(trajectory.begin(), trajectory.end(),
                       [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
      const std::vector<KnownPose> known = KeyFramesIn(trajectory, saved, part);
      if (known.empty()) continue;
      const Eigen::Matrix3d turn = WrittenTurn(saved.map, known);
      if (frames.empty()) result.T_map_files.R = turn.transpose();
      for (StreamFrame& frame : PathFramesOf(trajectory, known, turn, saved.map))
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
