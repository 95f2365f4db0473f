#include "alidade/run/folder/place_files.h"

#include <algorithm>
#include <set>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/run/folder/earlier_result.h"
#include "alidade/run/folder/own_files.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr char kReplaced[] = "replaced.json";  // in kRunDone: stats.json of the earlier run

bool Exists(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

bool IsAmong(const fs::path& path, const std::vector<std::string>& files) {
  return std::any_of(files.begin(), files.end(), [&](const std::string& file) {
    std::error_code error;
    return fs::equivalent(path, file, error);
  });
}

void Move(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) ThrowInput("cannot write " + to.string() + ": " + error.message());
}

std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder, error)) entries.push_back(entry.path());
  return entries;
}

// Merges a folder of images into an existing one.
void MoveInto(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::is_directory(from, error) || !Exists(to)) return Move(from, to);
  for (const fs::path& picture : EntriesOf(from)) Move(picture, to / picture.filename());
  fs::remove(from, error);
}

void RemoveOwnFiles(const fs::path& folder, const EarlierResult& result,
                    const std::vector<std::string>& inputs) {
  std::set<fs::path> emptied;
  for (const fs::path& path : OwnFilesIn(folder, result)) {
    if (IsAmong(path, inputs)) continue;
    std::error_code error;
    if (!fs::remove(path, error) && error)
      ThrowInput("cannot remove " + path.string() + ": " + error.message());
    if (path.parent_path() != folder) emptied.insert(path.parent_path());
  }
  std::error_code error;
  for (const fs::path& path : emptied) fs::remove(path, error);  // succeeds only if it is empty
}

// Images are omitted together with their list.
void LeaveOut(const fs::path& draft, const std::string& name) {
  const std::string list = fs::is_directory(draft / name) ? name + "." : "";
  std::error_code error;
  fs::remove_all(draft / name, error);
  for (const fs::path& path : EntriesOf(draft)) {
    const std::string other = path.filename().string();
    if (!list.empty() && other.rfind(list, 0) == 0 && path.extension() == ".txt")
      fs::remove(path, error);
  }
}

}  // namespace

void LeaveFilesOfOthers(const fs::path& draft, const fs::path& folder,
                        const std::vector<std::string>& inputs) {
  const auto earlier = ReadEarlierResult((folder / kStatsFile).string());
  std::set<fs::path> own;
  if (earlier) {
    for (const fs::path& path : OwnFilesIn(folder, *earlier)) own.insert(path);
  }
  const auto is_others = [&](const fs::path& path) {
    return Exists(path) && own.count(path) == 0 && !IsAmong(path, inputs);
  };
  for (const fs::path& path : EntriesOf(draft)) {
    const std::string name = path.filename().string();
    fs::path in_the_way = folder / name;
    std::error_code error;
    if (fs::is_directory(path, error) && fs::is_directory(in_the_way, error)) {
      const std::vector<fs::path> pictures = EntriesOf(path);
      const auto others = std::find_if(pictures.begin(), pictures.end(), [&](const fs::path& p) {
        return is_others(folder / name / p.filename());
      });
      if (others == pictures.end()) continue;
      in_the_way /= others->filename();
    } else if (!is_others(in_the_way)) {
      continue;
    }
    LogWarning(in_the_way.string() + " is not from an earlier run and is kept: the new " + name +
               " is not written");
    LeaveOut(draft, name);
  }
}

void PlaceFiles(const fs::path& draft, const fs::path& folder,
                const std::vector<std::string>& inputs) {
  FinishPlacing(folder, inputs);  // completes a move that was interrupted
  Move(draft, folder / kRunDone);
  FinishPlacing(folder, inputs);
}

void FinishPlacing(const fs::path& folder, const std::vector<std::string>& inputs) {
  const fs::path done = folder / kRunDone, stats = folder / kStatsFile, replaced = done / kReplaced;
  if (!Exists(done)) return;
  std::error_code error;
  if (Exists(done / kStatsFile)) {
    if (Exists(stats)) Move(stats, replaced);
    // While this file exists, none of the new files has been moved.
    if (const auto earlier = ReadEarlierResult(replaced.string()))
      RemoveOwnFiles(folder, *earlier, inputs);
    fs::remove(replaced, error);
    for (const fs::path& path : EntriesOf(done)) {
      if (path.filename() != kStatsFile) MoveInto(path, folder / path.filename());
    }
    Move(done / kStatsFile, stats);
  }
  fs::remove(done, error);  // succeeds only if it is empty
}

}  // namespace alidade
