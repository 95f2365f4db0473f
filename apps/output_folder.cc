#include "output_folder.h"

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 10> kOurFiles = {
    "trajectory.txt", "trajectory_live.txt", "keyframes.txt", "groundtruth.txt", "map.alidade",
    "landmarks.ply",  "semidense.ply",       "semidense.png", "report.html",     "stats.json"};
constexpr const char* kDepthFolder = "depth";

// trajectory.1.txt and the like, of further maps.
bool IsNumbered(const std::string& name, const std::string& what, const std::string& ending) {
  if (name.rfind(what + ".", 0) != 0) return false;
  const std::string rest = name.substr(what.size() + 1);
  const size_t digits = rest.find_first_not_of("0123456789");
  return digits != 0 && digits != std::string::npos && rest.rfind(ending, digits) == digits;
}

bool StartsWith(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

// By name: one of ours, or a temporary of one, left by a run that was killed while it wrote.
bool IsOurs(const std::string& name) {
  for (const std::string ours : kOurFiles) {
    if (name == ours || StartsWith(name, ours + ".tmp")) return true;
  }
  return IsNumbered(name, "trajectory", ".txt") || IsNumbered(name, "keyframes", ".txt") ||
         IsNumbered(name, "semidense", ".ply");
}

bool IsDepthList(const fs::path& path) {
  const std::string name = path.filename().string();
  if (StartsWith(name, "depth.txt.tmp")) return true;
  if (name != "depth.txt" && !IsNumbered(name, "depth", ".txt")) return false;
  std::error_code error;
  return fs::is_regular_file(path, error) &&
         StartsWith(ReadFile(path.string()), std::string(kDepthListHeader));
}

nlohmann::json StatsIn(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "stats.json", error)) return nullptr;
  return nlohmann::json::parse(ReadFile((folder / "stats.json").string()), nullptr, false);
}

bool AreOurs(const nlohmann::json& stats) {
  return stats.is_object() && stats.contains("version") && stats.contains("source") &&
         stats.contains("coverage");
}

bool MappedShape(const nlohmann::json& stats) {
  if (!AreOurs(stats) || !stats.contains("settings")) return false;
  const nlohmann::json& settings = stats["settings"];
  return settings.is_object() && settings.contains("semidense.enabled") &&
         settings["semidense.enabled"] == 1;
}

// What the lines of our lists begin with.
void AddStamps(const fs::path& list, std::set<std::string>& stamps) {
  const std::string text = ReadFile(list.string());
  for (const TextLine& line : ContentLines(text)) {
    const std::string stamp(line.text.substr(0, line.text.find_first_of(" \t")));
    if (stamp.find('/') == std::string::npos) stamps.insert(stamp);
  }
}

// Depth pictures of the run in `folder`, and temporaries of such: those its lists name and, for a
// run that was killed before it wrote them, those of its keyframes.
std::vector<fs::path> DepthPictures(const fs::path& folder) {
  const bool shape = MappedShape(StatsIn(folder));
  std::set<std::string> stamps;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool keyframes = name == "keyframes.txt" || IsNumbered(name, "keyframes", ".txt");
    if (IsDepthList(entry.path()) || (shape && keyframes)) AddStamps(entry.path(), stamps);
  }
  std::vector<fs::path> pictures;
  if (stamps.empty()) return pictures;
  for (const auto& entry : fs::directory_iterator(folder / kDepthFolder, error)) {
    const std::string name = entry.path().filename().string();
    const size_t ending = name.rfind(".png");
    if (ending == std::string::npos || stamps.count(name.substr(0, ending)) == 0) continue;
    const std::string rest = name.substr(ending);
    if (rest == ".png" || StartsWith(rest, ".png.tmp")) pictures.push_back(entry.path());
  }
  return pictures;
}

void RemoveOurFiles(const fs::path& folder, const fs::path& kept = {}) {
  const std::vector<fs::path> pictures = DepthPictures(folder);
  std::vector<fs::path> ours = pictures;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code none;
    if (!kept.empty() && fs::equivalent(entry.path(), kept, none)) continue;
    if (IsOurs(entry.path().filename().string()) || IsDepthList(entry.path()))
      ours.push_back(entry.path());
  }
  for (const fs::path& path : ours) {
    if (!fs::remove(path, error) && error) {
      ThrowInput("cannot remove " + path.string() + ": " + error.message());
    }
  }
  if (!pictures.empty()) fs::remove(folder / kDepthFolder, error);  // only when it is empty
}

}  // namespace

std::string NumberedFile(const std::string& name, size_t number, const std::string& ending) {
  return number == 0 ? name + ending : name + "." + std::to_string(number) + ending;
}

std::string DepthPictureFile(const std::string& stamp) {
  return std::string(kDepthFolder) + "/" + stamp + ".png";
}

std::string MaskPictureFile(const std::string& stamp) { return "mask/" + stamp + ".png"; }

OutputFolder::OutputFolder(const std::string& path, const std::string& kept)
    : path_(path), kept_(kept) {
  const std::string what = "--out " + path + ": ";
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) {
    if (!fs::is_directory(path, error)) ThrowInput(what + "there is a file of that name");
    const bool empty = fs::is_empty(path, error);
    if (error) ThrowInput(what + error.message());
    if (!empty && !AreOurs(StatsIn(path))) {
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
  const std::string probe(65536, '\0');
  try {
    Write("stats.json", probe);
    RemoveOurFiles(path_, kept_);
  } catch (const Error&) {
    Remove();
    throw;
  }
}

void OutputFolder::Write(const std::string& name, const std::string& bytes, Sync sync) {
  const fs::path path = fs::path(path_) / name;
  std::error_code error;
  if (fs::path(name).has_parent_path() && !fs::create_directories(path.parent_path(), error) &&
      error) {
    ThrowInput("cannot make " + path.parent_path().string() + ": " + error.message());
  }
  AtomicWriteFile(path.string(), bytes, sync);
}

void OutputFolder::Discard(const std::string& name) {
  const fs::path path = fs::path(path_) / name;
  std::error_code ignored;
  fs::remove(path, ignored);
  if (fs::path(name).has_parent_path()) fs::remove(path.parent_path(), ignored);
}

void OutputFolder::Remove() {
  RemoveOurFiles(path_, kept_);
  std::error_code ignored;
  if (made_) fs::remove(path_, ignored);  // only when it is empty
}

}  // namespace alidade
