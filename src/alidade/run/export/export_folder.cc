#include "alidade/run/export/export_folder.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kMarker = "export.json";
constexpr int kMarkerVersion = 2;
constexpr const char* kUnfinished = "unfinished";  // instead of the format
// What version 1 wrote, whose marker has no list.
constexpr std::array<const char*, 7> kFirstFiles = {"cameras.txt", "images.txt", "points3D.txt",
                                                    "cameras.bin", "images.bin", "points3D.bin",
                                                    kMarker};

std::set<std::string> FirstFiles() { return {kFirstFiles.begin(), kFirstFiles.end()}; }

// Null: the folder has no marker of ours.
ordered_json MarkerIn(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / kMarker, error)) return {};
  ordered_json marker = ordered_json::parse(ReadFile((folder / kMarker).string()), nullptr, false);
  return marker.is_object() && marker.contains("version") ? std::move(marker) : ordered_json();
}

// The files of an earlier export, from its marker; empty: it has none of ours.
std::set<std::string> FilesOfEarlier(const fs::path& folder) {
  const ordered_json marker = MarkerIn(folder);
  if (marker.is_null()) return {};
  if (marker.contains("colmap")) return FirstFiles();
  std::set<std::string> files;
  if (!marker.contains("files") || !marker["files"].is_array()) return files;
  for (const auto& file : marker["files"]) {
    if (file.is_string()) files.insert(file.get<std::string>());
  }
  files.insert(kMarker);
  return files;
}

// A file in `folder` that is not among `files`; empty: none.
std::string OtherFile(const fs::path& folder, const std::set<std::string>& files) {
  std::error_code error;
  for (auto at = fs::recursive_directory_iterator(folder, error);
       !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    if (at->is_directory(error) && !at->is_symlink(error)) continue;
    const std::string name = at->path().lexically_relative(folder).generic_string();
    if (files.count(name) == 0 || at->is_symlink(error)) return name;
  }
  return error ? error.message() : "";
}

// A folder that a killed export left: what this or the first version writes before it is done.
bool IsLeftover(const fs::path& folder) {
  std::error_code error;
  if (fs::is_regular_file(folder / kMarker, error)) return !FilesOfEarlier(folder).empty();
  return OtherFile(folder, FirstFiles()).empty();
}

bool IsComplete(const fs::path& folder) {
  const ordered_json marker = MarkerIn(folder);
  return marker.contains("format") && marker["format"] != kUnfinished;
}

std::string PathWithoutSlash(const std::string& folder) {
  fs::path path = fs::path(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::error_code error;
  if (fs::is_symlink(path, error)) {  // the folder it leads to is replaced, not the link
    path = fs::canonical(path, error);
    if (error) ThrowInput(folder + ": " + error.message());
  }
  return path.string();
}

void CheckIsFree(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error))) return;
  if (!fs::is_directory(path, error)) ThrowInput(path.string() + " is a file, not a folder");
  const bool empty = fs::is_empty(path, error);
  if (error) ThrowInput(path.string() + ": " + error.message());
  if (empty) return;
  const std::set<std::string> ours = FilesOfEarlier(path);
  const std::string other = ours.empty() ? "" : OtherFile(path, ours);
  if (!ours.empty() && other.empty()) return;
  ThrowInput(path.string() + ": the folder contains other files than an earlier export" +
             (other.empty() ? "" : " (" + other + ")") + "; choose another");
}

std::string CheckedPath(const std::string& folder) {
  std::string path = PathWithoutSlash(folder);
  CheckIsFree(path);
  for (const std::string& left : StaleTemporaries(path)) {
    std::error_code ignored;
    // Killed between two renames: the folder is missing, and what is left is complete.
    if (!fs::exists(path, ignored) && IsComplete(left)) {
      fs::rename(left, path, ignored);
      continue;
    }
    if (IsLeftover(left)) fs::remove_all(left, ignored);
  }
  return path;
}

std::string MarkerText(const std::string& format, const std::vector<std::string>& files) {
  const ordered_json marker = {{"version", kMarkerVersion}, {"format", format}, {"files", files}};
  return marker.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

ExportFolder::ExportFolder(const std::string& path) : path_(CheckedPath(path)) {}

void ExportFolder::Write(const std::string& name, const std::string& bytes) {
  if (!draft_) {
    draft_.emplace(path_);
    AtomicWriteFile(draft_->path() + "/" + kMarker, MarkerText(kUnfinished, {}));
  }
  const fs::path file = fs::path(draft_->path()) / name;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) ThrowInput(file.parent_path().string() + ": cannot be created: " + error.message());
  AtomicWriteFile(file.string(), bytes, Sync::kNo);
  files_.push_back(name);
}

void ExportFolder::Write(const std::vector<ColmapFile>& files, const std::string& subfolder) {
  for (const ColmapFile& file : files) Write(subfolder + file.name, file.bytes);
}

void ExportFolder::Place(const std::string& format) {
  AtomicWriteFile(draft_->path() + "/" + kMarker, MarkerText(format, files_));
  CheckIsFree(path_);  // others may have written there meanwhile
  std::error_code error;
  std::string earlier;
  if (fs::exists(path_, error)) {
    earlier = TemporaryBeside(path_);
    fs::rename(path_, earlier, error);
  }
  if (!error) fs::rename(draft_->path(), path_, error);
  if (error) {
    const std::string why = error.message();
    if (!earlier.empty() && !fs::exists(path_, error)) fs::rename(earlier, path_, error);
    ThrowInput(path_ + ": cannot be written: " + why);
  }
  if (!earlier.empty()) fs::remove_all(earlier, error);
}

}  // namespace alidade
