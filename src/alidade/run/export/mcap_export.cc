#include "alidade/run/export/mcap_export.h"

#include <filesystem>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/folder/final_state.h"
#include "alidade/run/folder/result_folder.h"
#include "alidade/run/recorder/mcap_log.h"
#include "alidade/run/recorder/stream_file.h"
#include "alidade/run/recorder/stream_to_ros.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::vector<RosPose> RosPathOf(const Trajectory& trajectory) {
  std::vector<RosPose> path;
  for (const StampedPose& pose : trajectory)
    path.push_back({RosTime::FromSeconds(pose.time), pose.T_world_camera});
  return path;
}

// Writes the complete final state.
void TellState(RosLog& log, double time, const FinalState& state) {
  if (!state.trajectory.empty()) log.Path(time, RosPathOf(state.trajectory));
  if (state.landmarks) log.Landmarks(time, *state.landmarks);
  if (state.shape) log.Shape(time, *state.shape);
}

McapCounts CountsOf(int frames, const FinalState& state, const McapLog& file) {
  const auto points = [](const std::optional<Cloud>& cloud) {
    return cloud ? cloud->points.size() : 0;
  };
  return {frames, points(state.landmarks), points(state.shape), file.bytes()};
}

// Writes frames individually, and the final state before and after them.
McapCounts TellKnown(const Trajectory& frames, const FinalState& state,
                     const std::optional<Camera>& camera, const std::vector<RosStatus>& diagnostics,
                     const std::string& out, const std::string& program) {
  McapLog file(out, program);
  RosLog& log = file.log();
  for (const StampedPose& frame : frames) {
    log.Pose(frame.time, frame.T_world_camera);
    if (camera) log.Calibration(frame.time, *camera);
    if (&frame == &frames.front()) TellState(log, frame.time, state);
  }
  const double end = (frames.empty() ? 0 : frames.back().time) + kAfterTheLastFrame;
  if (!state.trajectory.empty()) log.Transforms(end, state.trajectory.back().T_world_camera);
  TellState(log, end, state);
  if (!diagnostics.empty()) log.Diagnostics(end, diagnostics);
  file.Close();
  return CountsOf(static_cast<int>(frames.size()), state, file);
}

std::string CountText(const std::optional<double>& number) {
  return number ? std::to_string(static_cast<long>(*number)) : "unknown";
}

std::vector<RosStatus> StatusOf(const ResultFolder& result) {
  RosStatus state;
  state.name = "alidade: run";
  state.hardware_id = result.source;
  state.message = CountText(result.tracked) + " of " + CountText(result.frames) + " frames tracked";
  state.values = {{"keyframes", CountText(result.keyframes)},
                  {"landmarks", CountText(result.landmarks)},
                  {"loops", CountText(result.loops)},
                  {"maps", CountText(result.maps)}};
  std::vector<float> medians;
  for (const MedianBar& bar : result.milliseconds)
    medians.push_back(bar.median > 0 ? static_cast<float>(bar.median) : -1.f);
  RosStatus ms = MillisecondsStatus(medians);
  ms.message += " (medians)";
  return {state, ms};
}

}  // namespace

std::string StreamIn(const std::string& path) {
  const std::string file = IsFolder(path) ? path + "/run.stream" : path;
  return fs::path(file).extension() == ".stream" && IsFile(file) ? file : "";
}

McapCounts ExportStream(const std::string& stream, const std::string& out,
                        const std::string& program) {
  StreamFileReader reader(stream);
  McapLog file(out, program);
  StreamToRos ros(file.log(), {});
  try {
    while (const std::optional<std::string> message = reader.Next()) ros.Take(*message);
  } catch (const Error& error) {
    throw Error(error.kind(), stream + ": " + error.what());
  }
  if (ros.scene().frames == 0) ThrowInput(stream + " contains no recorded frame");
  const std::string folder = fs::path(stream).parent_path().string();
  FinalState state;
  if (IsFile(fs::path(folder) / "stats.json")) state = FinalStateIn(folder.empty() ? "." : folder);
  ros.End(state);
  file.Close();
  McapCounts counts = CountsOf(ros.scene().frames, state, file);
  if (!state.landmarks) counts.landmarks = ros.scene().landmarks.size();
  return counts;
}

McapCounts ExportResults(const std::string& folder, const std::string& out,
                         const std::string& program) {
  const ResultFolder result = ReadResultFolder(folder);
  const FinalState state = FinalStateIn(folder);
  if (state.trajectory.empty()) ThrowInput(folder + " contains no map");
  const std::string live = folder + "/trajectory_live.txt";
  const Trajectory frames = IsFile(live) ? ReadTrajectory(live) : state.trajectory;
  return TellKnown(frames, state, result.camera, StatusOf(result), out, program);
}

McapCounts ExportMapToMcap(const SavedMap& saved, const MapPart& part, const std::string& out,
                           const std::string& program) {
  const FinalState state = FinalStateOf(saved, part);
  return TellKnown(state.trajectory, state, saved.camera, {}, out, program);
}

}  // namespace alidade
