#include "alidade/run/output_folder.h"

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

constexpr std::array<const char*, 12> kOurFiles = {
    "trajectory.txt", "trajectory_live.txt", "keyframes.txt", "groundtruth.txt",
    "map.alidade",    "landmarks.ply",       "semidense.ply", "semidense.png",
    "report.html",    "stats.json",          "run.stream",    "camera.yaml"};

// Pictures with a list: NAME/STAMP.png and NAME.txt, where maps have their own NAME.1.txt, …
struct PictureKind {
  std::string name;
  std::string_view header;  // first line of the list
  bool numbered;
};
const PictureKind kDepth{"depth", kDepthListHeader, true};
const PictureKind kMasks{"mask", kMaskListHeader, false};

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

bool IsList(const fs::path& path, const PictureKind& kind) {
  const std::string name = path.filename().string();
  if (StartsWith(name, kind.name + ".txt.tmp")) return true;
  if (name != kind.name + ".txt" && !(kind.numbered && IsNumbered(name, kind.name, ".txt")))
    return false;
  std::error_code error;
  return fs::is_regular_file(path, error) &&
         StartsWith(ReadFile(path.string()), std::string(kind.header));
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

// Pictures of the run in `folder`, and temporaries of such: those its lists name and, for a run
// that was killed before it wrote those of depth, those of its keyframes.
std::vector<fs::path> Pictures(const fs::path& folder, const PictureKind& kind) {
  const bool by_keyframe = kind.name == kDepth.name && MappedShape(StatsIn(folder));
  std::set<std::string> stamps;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool keyframes = name == "keyframes.txt" || IsNumbered(name, "keyframes", ".txt");
    if (IsList(entry.path(), kind) || (by_keyframe && keyframes)) AddStamps(entry.path(), stamps);
  }
  std::vector<fs::path> pictures;
  if (stamps.empty()) return pictures;
  for (const auto& entry : fs::directory_iterator(folder / kind.name, error)) {
    const std::string name = entry.path().filename().string();
    const size_t ending = name.rfind(".png");
    if (ending == std::string::npos || stamps.count(name.substr(0, ending)) == 0) continue;
    const std::string rest = name.substr(ending);
    if (rest == ".png" || StartsWith(rest, ".png.tmp")) pictures.push_back(entry.path());
  }
  return pictures;
}

// Folders of masks that a run which was killed has not finished.
std::vector<std::string> LeftDrafts(const fs::path& folder) {
  return StaleTemporaries((folder / kMasks.name).string());
}

// Nothing in it but what a run that was killed may leave before it has results.
bool HoldsNothing(const fs::path& folder, std::error_code& error) {
  std::set<std::string> drafts;
  for (const std::string& draft : LeftDrafts(folder))
    drafts.insert(fs::path(draft).filename().string());
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (drafts.count(entry.path().filename().string()) == 0) return false;
  }
  return true;
}

void RemoveOurFiles(const fs::path& folder, const fs::path& kept = {}) {
  std::vector<fs::path> ours;
  std::vector<fs::path> emptied;
  for (const PictureKind& kind : {kDepth, kMasks}) {
    const std::vector<fs::path> pictures = Pictures(folder, kind);
    if (!pictures.empty()) emptied.push_back(folder / kind.name);
    ours.insert(ours.end(), pictures.begin(), pictures.end());
  }
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code none;
    if (!kept.empty() && fs::equivalent(entry.path(), kept, none)) continue;
    if (IsOurs(entry.path().filename().string()) || IsList(entry.path(), kDepth) ||
        IsList(entry.path(), kMasks))
      ours.push_back(entry.path());
  }
  for (const fs::path& path : ours) {
    if (!fs::remove(path, error) && error) {
      ThrowInput("cannot remove " + path.string() + ": " + error.message());
    }
  }
  for (const fs::path& path : emptied) fs::remove(path, error);  // only when nothing is in it
  for (const std::string& draft : LeftDrafts(folder)) fs::remove_all(draft, error);
}

}  // namespace

std::string NumberedFile(const std::string& name, size_t number, const std::string& ending) {
  return number == 0 ? name + ending : name + "." + std::to_string(number) + ending;
}

std::string DepthPictureFile(const std::string& stamp) {
  return kDepth.name + "/" + stamp + ".png";
}

std::string MaskPictureFile(const std::string& stamp) { return kMasks.name + "/" + stamp + ".png"; }

OutputFolder::OutputFolder(const std::string& path, const std::string& kept)
    : path_(path), kept_(kept) {
  const std::string what = "--out " + path + ": ";
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) {
    if (!fs::is_directory(path, error)) ThrowInput(what + "there is a file of that name");
    const bool empty = HoldsNothing(path, error);
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
