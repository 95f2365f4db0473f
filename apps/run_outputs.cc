#include "run_outputs.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "alidade/base/error.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/file.h"
#include "alidade/io/trajectory.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

const char* NameOf(Sensor sensor) {
  switch (sensor) {
    case Sensor::kMono: return "mono";
    case Sensor::kStereo: return "stereo";
    case Sensor::kRgbd: return "rgbd";
  }
  return "";
}

ordered_json ToJson(const std::vector<double>& samples) {
  if (samples.empty()) return nullptr;
  const Summary s = Summarise(samples);
  return {{"median", s.median}, {"mean", s.mean}, {"p95", s.p95}, {"max", s.max}, {"count", s.count}};
}

// Trajectories are the mounted camera's, the map's frame is the rectified one's at the start.
Se3 Mounted(const Se3& T_world_camera, const Eigen::Matrix3d& R_camera_rectified) {
  const Se3 turn{R_camera_rectified, Eigen::Vector3d::Zero()};
  return turn * T_world_camera * turn.Inverse();
}

// Times between losing track and finding it again, seconds; not before the start.
ordered_json LostSpans(const std::vector<FramePose>& poses) {
  ordered_json spans = ordered_json::array();
  const FramePose* last_tracked = nullptr;
  const FramePose* lost = nullptr;  // first frame of the span that is open
  for (const FramePose& pose : poses) {
    if (!pose.tracked) {
      if (last_tracked && !lost) lost = &pose;
      continue;
    }
    if (lost) spans.push_back({lost->time, pose.time});
    lost = nullptr;
    last_tracked = &pose;
  }
  if (lost) spans.push_back({lost->time, poses.back().time});
  return spans;
}

std::string LandmarksPly(const MapSnapshot& map, const Eigen::Matrix3d& R_camera_rectified) {
  const std::vector<LandmarkId> ids = map.Landmarks();
  std::ostringstream out;
  out << "ply\nformat ascii 1.0\ncomment Alidade landmarks, metres (monocular: map units)\nelement vertex " << ids.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (LandmarkId id : ids) {
    const Eigen::Vector3d p = R_camera_rectified * map.Find(id)->p_world;
    out << static_cast<float>(p.x()) << ' ' << static_cast<float>(p.y()) << ' ' << static_cast<float>(p.z()) << '\n';
  }
  return out.str();
}

}  // namespace

void PrepareOutput(const std::string& folder) {
  static const char* const kOurs[] = {"trajectory.txt", "trajectory_live.txt", "keyframes.txt", "map.alidade", "landmarks.ply",
                                      "report.html", "stats.json"};
  std::error_code error;
  if (fs::exists(folder, error)) {
    if (!fs::is_directory(folder, error)) ThrowInput("--out " + folder + ": not a folder");
    const bool empty = fs::is_empty(folder, error);
    if (!empty && !fs::exists(fs::path(folder) / "stats.json", error)) {
      ThrowInput("--out " + folder + ": the folder exists and holds no earlier run (no stats.json); name another");
    }
    for (const char* name : kOurs) fs::remove(fs::path(folder) / name, error);
    return;
  }
  fs::create_directories(folder, error);
  if (error) ThrowInput("--out " + folder + ": cannot be made (" + error.message() + ")");
}

int WriteOutputs(const std::string& folder, const Slam& slam, const RunRecord& record) {
  const std::vector<FramePose> poses = slam.Trajectory();
  const MapSnapshot map = slam.Snapshot();
  const Eigen::Matrix3d& turn = record.source.R_camera_rectified;
  Trajectory final_poses, live_poses, keyframe_poses;
  int initialised_at = -1;
  for (const FramePose& pose : poses) {
    if (!pose.tracked) continue;
    if (initialised_at < 0) initialised_at = record.numbers[pose.index];
    const std::string& stamp = record.stamps[pose.index];
    final_poses.push_back({pose.time, Mounted(pose.T_world_camera, turn), stamp});
    live_poses.push_back({pose.time, Mounted(pose.T_world_camera_live, turn), stamp});
  }
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame* keyframe = map.Find(id);
    keyframe_poses.push_back({keyframe->frame->time, Mounted(keyframe->T_camera_world.Inverse(), turn),
                              record.stamps[keyframe->frame->number]});
  }
  const auto path = [&](const char* name) { return (fs::path(folder) / name).string(); };
  AtomicWriteFile(path("trajectory.txt"), FormatTumTrajectory(final_poses));
  AtomicWriteFile(path("trajectory_live.txt"), FormatTumTrajectory(live_poses));
  AtomicWriteFile(path("keyframes.txt"), FormatTumTrajectory(keyframe_poses));
  AtomicWriteFile(path("map.alidade"), slam.SaveMap());
  AtomicWriteFile(path("landmarks.ply"), LandmarksPly(map, turn));

  ordered_json settings = {{"profile", record.profile},
                           {"schedule", record.settings.threaded ? "threaded" : "inline"},
                           {"threads", record.threads}};
  for (const auto& [name, value] : record.settings.All()) settings[name] = ordered_json::parse(value);
  const StageTimes times = slam.Times();
  const int tracked = static_cast<int>(final_poses.size());
  const ordered_json stats = {
      {"version", 1},
      {"source", record.source_path},
      {"sensor", NameOf(record.sensor)},
      {"settings", settings},
      {"frames", record.frames},
      {"tracked", tracked},
      {"coverage", record.frames > 0 ? static_cast<double>(tracked) / record.frames : 0.0},
      {"initialised_at", initialised_at < 0 ? ordered_json(nullptr) : ordered_json(initialised_at)},
      {"lost_spans", LostSpans(poses)},
      {"span", poses.empty() ? ordered_json(nullptr)
                             : ordered_json({poses.front().time, poses.back().time})},
      {"relocalisations", slam.relocalisations()},
      {"loops", 0},
      {"maps", map.keyframe_count() > 0 ? 1 : 0},
      {"keyframes", map.keyframe_count()},
      {"landmarks", map.landmark_count()},
      {"ms",
       {{"frame", ToJson(times.frame)},
        {"extract", ToJson(times.extract)},
        {"track", ToJson(times.track)},
        {"map", ToJson(times.map)},
        {"loop", nullptr},
        {"detect", nullptr},
        {"dynamics", nullptr},
        {"semidense", nullptr}}},
      {"cpu_s", record.cpu_s},
      {"wall_s", record.wall_s},
      {"peak_mb", PeakMegabytes()},
      {"dropped_frames", record.dropped},
      {"warnings", record.warnings}};
  AtomicWriteFile(path("stats.json"), stats.dump(2) + "\n");
  return tracked;
}

}  // namespace alidade
