#include "run_outputs.h"

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/cloud.h"
#include "alidade/io/files/file.h"
#include "run_results.h"
#include "run_stats.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 8> kOurFiles = {
    "trajectory.txt", "trajectory_live.txt", "keyframes.txt", "groundtruth.txt",
    "map.alidade",    "landmarks.ply",       "report.html",   "stats.json"};

// One of ours, or a temporary of one, left by a run that was killed while it wrote.
bool IsOurs(const std::string& name) {
  for (const std::string ours : kOurFiles) {
    if (name == ours || name.rfind(ours + ".tmp", 0) == 0) return true;
  }
  return false;
}

bool HoldsOurStats(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "stats.json", error)) return false;
  const auto stats =
      nlohmann::json::parse(ReadFile((folder / "stats.json").string()), nullptr, false);
  return stats.is_object() && stats.contains("version") && stats.contains("source") &&
         stats.contains("coverage");
}

void RemoveOurFiles(const fs::path& folder) {
  std::vector<fs::path> ours;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (IsOurs(entry.path().filename().string())) ours.push_back(entry.path());
  }
  for (const fs::path& path : ours) {
    if (!fs::remove(path, error) && error) {
      ThrowInput("cannot remove " + path.string() + ": " + error.message());
    }
  }
}

std::string LandmarksPly(const RunResults& results) {
  Cloud cloud;
  for (LandmarkId id : results.map.Landmarks()) {
    cloud.points.push_back(
        (results.R_camera_rectified * results.map.Find(id)->p_world).cast<float>());
  }
  return EncodePly(cloud, CloudFormat::kAscii);
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  const std::string what = "--out " + path + ": ";
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) {
    if (!fs::is_directory(path, error)) ThrowInput(what + "there is a file of that name");
    const bool empty = fs::is_empty(path, error);
    if (error) ThrowInput(what + error.message());
    if (!empty && !HoldsOurStats(path)) {
      ThrowInput(
          what +
          "the folder exists and holds no earlier run (no stats.json of ours); name another");
    }
    RemoveOurFiles(path);
  } else {
    fs::create_directories(path, error);
    if (error) ThrowInput(what + "cannot be made: " + error.message());
    made_ = true;
  }
  // As much as a short run leaves.
  const std::string probe(64 * 1024, '\0');
  try {
    Write("stats.json", probe);
    RemoveOurFiles(path_);
  } catch (const Error&) {
    Remove();
    throw;
  }
}

void OutputFolder::Write(const std::string& name, const std::string& bytes) {
  AtomicWriteFile((fs::path(path_) / name).string(), bytes);
}

void OutputFolder::Remove() {
  RemoveOurFiles(path_);
  std::error_code ignored;
  if (made_) fs::remove(path_, ignored);  // only when it is empty
}

RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunRecord& record) {
  const RunResults results = ResultsOf(slam, record);
  bool useful = false;
  try {
    folder.Write("trajectory.txt", FormatTumTrajectory(results.trajectory));
    folder.Write("trajectory_live.txt", FormatTumTrajectory(results.live));
    folder.Write("keyframes.txt", FormatTumTrajectory(results.keyframes));
    if (!record.truth.empty()) {
      folder.Write("groundtruth.txt", FormatTumTrajectory(record.truth));
    }
    folder.Write("stats.json", StatsJson(record, results));
    useful = true;
    folder.Write("map.alidade", slam.SaveMap());
    folder.Write("landmarks.ply", LandmarksPly(results));
    folder.Write("report.html", ReportHtml(record, results));
  } catch (const Error&) {
    if (!useful) folder.Remove();
    throw;
  }
  return {record.frames, static_cast<int>(results.trajectory.size()), results.map.keyframe_count(),
          results.map.landmark_count(), PathLength(results.trajectory)};
}

}  // namespace alidade
