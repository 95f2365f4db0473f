#include "alidade/io/files/trajectory_file.h"

#include <algorithm>
#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/euroc_calibration.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::string TruthIn(const std::string& folder) {
  for (const char* name : {"groundtruth.txt", "mav0/state_groundtruth_estimate0/data.csv",
                           "state_groundtruth_estimate0/data.csv", "poses.txt", "trajectory.txt"}) {
    if (IsThere(folder + "/" + name)) return folder + "/" + name;
  }
  ThrowInput(
      "there is no trajectory in " + folder +
      " (groundtruth.txt, mav0/state_groundtruth_estimate0/data.csv, poses.txt or trajectory.txt)");
}

Trajectory ReadEuroc(const std::string& path, const std::string& text) {
  const std::string sensor =
      (fs::absolute(path).parent_path().parent_path() / "cam0/sensor.yaml").string();
  if (IsThere(sensor))
    return ParseEurocTrajectory(text, path, ReadEurocCamera(sensor).T_body_camera);
  LogWarning(
      path +
      ": without cam0/sensor.yaml next to it, these are poses of the body, not of the camera");
  return ParseEurocTrajectory(text, path, {});
}

Trajectory ReadKitti(const std::string& path, const std::string& text) {
  const fs::path folder = fs::absolute(path).parent_path();
  const fs::path sequence = folder.parent_path() / "sequences" / fs::path(path).stem();
  for (const fs::path& times : {folder / "times.txt", sequence / "times.txt"}) {
    if (IsThere(times.string()))
      return ParseKittiTrajectory(text, path, ReadFile(times.string()), times.string());
  }
  ThrowInput(path + " contains poses without times, and there is no times.txt next to it or in " +
             sequence.string());
}

}  // namespace

Trajectory ReadTrajectory(const std::string& path) {
  if (IsFolder(path)) return ReadTrajectory(TruthIn(path));
  const std::string text = ReadFile(path);
  CheckIsText(text, path);
  const auto lines = ContentLines(text);
  if (lines.empty()) ThrowInput(path + " contains no poses");
  const std::string_view first = lines.front().text;
  const size_t fields = Fields(first).size();
  if (fields == 12) return ReadKitti(path, text);
  if (first.find(',') != std::string_view::npos) return ReadEuroc(path, text);
  return ParseTumTrajectory(text, path);
}

Trajectory ReadEstimate(const std::string& path) {
  const std::string result = path + "/trajectory.txt";
  return ReadTrajectory(IsThere(result) ? result : path);
}

}  // namespace alidade
