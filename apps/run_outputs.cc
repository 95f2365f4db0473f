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

// trajectory.1.txt and the like, of further maps.
bool IsNumbered(const std::string& name, const std::string& what) {
  if (name.rfind(what + ".", 0) != 0) return false;
  const std::string rest = name.substr(what.size() + 1);
  const size_t digits = rest.find_first_not_of("0123456789");
  return digits != 0 && digits != std::string::npos && rest.rfind(".txt", digits) == digits;
}

// One of ours, or a temporary of one, left by a run that was killed while it wrote.
bool IsOurs(const std::string& name) {
  for (const std::string ours : kOurFiles) {
    if (name == ours || name.rfind(ours + ".tmp", 0) == 0) return true;
  }
  return IsNumbered(name, "trajectory") || IsNumbered(name, "keyframes");
}

bool HoldsOurStats(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "stats.json", error)) return false;
  const auto stats =
      nlohmann::json::parse(ReadFile((folder / "stats.json").string()), nullptr, false);
  return stats.is_object() && stats.contains("version") && stats.contains("source") &&
         stats.contains("coverage");
}

void RemoveOurFiles(const fs::path& folder, const fs::path& kept = {}) {
  std::vector<fs::path> ours;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code none;
    if (!kept.empty() && fs::equivalent(entry.path(), kept, none)) continue;
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
  for (LandmarkId id : results.map.Landmarks()) {  // others lie in worlds of their own
    if (results.map.MapOf(results.map.Find(id)->reference) != results.maps.front().id) continue;
    cloud.points.push_back(
        (results.R_camera_rectified * results.map.Find(id)->p_world).cast<float>());
  }
  return EncodePly(cloud, CloudFormat::kAscii);
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path, const std::string& kept)
    : path_(path), kept_(kept) {
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
    RemoveOurFiles(path, kept_);
  } else {
    fs::create_directories(path, error);
    if (error) ThrowInput(what + "cannot be made: " + error.message());
    made_ = true;
  }
  // As much as a short run leaves.
  const std::string probe(64 * 1024, '\0');
  try {
    Write("stats.json", probe);
    RemoveOurFiles(path_, kept_);
  } catch (const Error&) {
    Remove();
    throw;
  }
}

void OutputFolder::Write(const std::string& name, const std::string& bytes) {
  AtomicWriteFile((fs::path(path_) / name).string(), bytes);
}

void OutputFolder::Remove() {
  RemoveOurFiles(path_, kept_);
  std::error_code ignored;
  if (made_) fs::remove(path_, ignored);  // only when it is empty
}

RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunRecord& record,
                        bool with_map) {
  const RunResults results = ResultsOf(slam, record);
  bool useful = false;
  try {
    for (size_t i = 0; i < results.maps.size(); ++i) {
      const MapResults& map = results.maps[i];
      if (i > 0 && map.trajectory.empty()) break;  // of a loaded map nothing was seen of
      folder.Write(NumberedFile("trajectory", i), FormatTumTrajectory(map.trajectory));
      folder.Write(NumberedFile("keyframes", i), FormatTumTrajectory(map.keyframes));
    }
    folder.Write("trajectory_live.txt", FormatTumTrajectory(results.maps.front().live));
    if (!record.truth.empty()) {
      folder.Write("groundtruth.txt", FormatTumTrajectory(record.truth));
    }
    folder.Write("stats.json", StatsJson(record, results));
    useful = true;
    if (with_map) folder.Write("map.alidade", slam.SaveMap());
    folder.Write("landmarks.ply", LandmarksPly(results));
    folder.Write("report.html", ReportHtml(record, results));
  } catch (const Error&) {
    if (!useful) folder.Remove();
    throw;
  }
  return {record.frames,
          results.tracked,
          results.map.keyframe_count(),
          results.map.landmark_count(),
          static_cast<int>(results.map.Maps().size()),
          PathLength(results.maps.front().trajectory)};
}

}  // namespace alidade
