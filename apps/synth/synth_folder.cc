#include "synth/synth_folder.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr char kSynthDraft[] = "synth", kSynthLock[] = "synth.lock";

// Empty except for files of a running `alidade synth`.
bool HoldsNothing(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name != kSynthLock && name.rfind(std::string(kSynthDraft) + ".tmp", 0) != 0) return false;
  }
  if (error) ThrowInput("cannot read the folder " + folder.string() + ": " + error.message());
  return true;
}

void RemoveFile(const fs::path& path) {
  std::error_code error;
  if (!fs::remove(path, error) && error)
    ThrowInput("cannot remove " + path.string() + ": " + error.message());
}

// Removes images named by a time or a number, and EuRoC's other files; then the folder if it is
// empty.
void RemovePictures(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(fs::symlink_status(folder, error))) return;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    const std::string name = path.filename().string(), stem = path.stem().string();
    const bool picture = path.extension() == ".png" && !stem.empty() &&
                         stem.find_first_not_of("0123456789.") == std::string::npos;
    if (entry.is_directory(error)) {
      RemovePictures(path);
    } else if (picture || name == "data.csv" || name == "sensor.yaml") {
      RemoveFile(path);
    }
  }
  fs::remove(folder, error);
}

// Moves the content into an existing folder, or renames it; lists are moved last.
void MoveTree(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::is_directory(from) || !fs::exists(fs::symlink_status(to, error))) {
    fs::rename(from, to, error);
    if (error) ThrowInput("cannot write " + to.string() + ": " + error.message());
    return;
  }
  std::vector<fs::path> parts;
  for (const auto& entry : fs::directory_iterator(from)) parts.push_back(entry.path());
  std::stable_partition(parts.begin(), parts.end(),
                        [](const fs::path& path) { return fs::is_directory(path); });
  for (const fs::path& part : parts) MoveTree(part, to / part.filename());
}

}  // namespace

SynthFolder::SynthFolder(const std::string& path) : path_(path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_directory(status))
    ThrowInput(path + " is a file, not a folder");
  if (fs::exists(status) && !fs::exists(path + "/" + kSynthMarker) && !HoldsNothing(path)) {
    ThrowInput(path +
               " is not empty and was not written by `alidade synth`: choose another folder, or "
               "empty this one");
  }
  fs::create_directories(path, error);
  if (error) ThrowInput("cannot create the folder " + path + ": " + error.message());
  lock_.emplace(path + "/" + kSynthLock, path + ": ");
  for (const std::string& left : StaleTemporaries(path + "/" + kSynthDraft))
    fs::remove_all(left, error);
  draft_.emplace(path + "/" + kSynthDraft);
}

void SynthFolder::Place() {
  // Lists are removed first: without them no reader recognizes the folder as a recording. The
  // marker remains until it is replaced, so that an interrupted recording is still recognized as
  // ours.
  for (const char* name : {"rgb.txt", "depth.txt", "mask.txt", "groundtruth.txt", "camera.yaml",
                           "times.txt", "poses.txt", "calib.txt", "imu.csv", "motion.csv"})
    RemoveFile(path_ + "/" + name);
  for (const char* name : {"rgb", "depth", "mask", "mav0", "image_0", "image_1"})
    RemovePictures(path_ + "/" + name);
  MoveTree(draft(), path_);
  draft_.reset();
}

}  // namespace alidade
