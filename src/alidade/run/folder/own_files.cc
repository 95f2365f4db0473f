#include "alidade/run/folder/own_files.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"
#include "alidade/run/folder/folder_lock.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 16> kFiles = {
    "trajectory.txt", "trajectory_live.txt", "keyframes.txt", "groundtruth.txt", "map.alidade",
    "landmarks.ply",  "semidense.ply",       "semidense.png", "report.html",     kStatsFile,
    "run.stream",     "camera.yaml",         "mesh.ply",      "mesh.glb",        "map.pgm",
    "map.yaml"};

// Images with a list: NAME/STAMP.png and NAME.txt, or NAME.1.txt, … for further maps.
struct PictureKind {
  std::string name;
  std::string_view header;  // first line of the list
  bool numbered;
};
const PictureKind kDepth{"depth", kDepthListHeader, true};
const PictureKind kMasks{"mask", kMaskListHeader, false};

bool StartsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

// Files of further maps, such as trajectory.1.txt.
bool IsNumbered(const std::string& name, const std::string& what, const std::string& ending) {
  if (!StartsWith(name, what + ".")) return false;
  const std::string rest = name.substr(what.size() + 1);
  const size_t digits = rest.find_first_not_of("0123456789");
  return digits != 0 && digits != std::string::npos && rest.substr(digits) == ending;
}

bool HasNameOfList(const std::string& name, const PictureKind& kind) {
  return name == kind.name + ".txt" || (kind.numbered && IsNumbered(name, kind.name, ".txt"));
}

bool HasNameOfFile(const std::string& name) {
  return std::find(kFiles.begin(), kFiles.end(), name) != kFiles.end() ||
         IsNumbered(name, "trajectory", ".txt") || IsNumbered(name, "keyframes", ".txt") ||
         IsNumbered(name, "semidense", ".ply");
}

bool Begins(const fs::path& path, std::string_view start) {
  return IsFile(path.string()) && StartsWith(ReadFile(path.string()), start);
}

bool IsList(const fs::path& path, const PictureKind& kind) {
  return HasNameOfList(path.filename().string(), kind) && Begins(path, kind.header);
}

// For results of older versions, which have no list: such a file may be the user's own, for
// `compare` or --camera.
bool WasLikelyOurs(const fs::path& path, const EarlierResult& result) {
  const std::string name = path.filename().string();
  if (name == "groundtruth.txt") return StartsWith(result.owner.source, "synth:");
  if (name == "camera.yaml") return Begins(path, "# Found by alidade");
  return true;
}

// The images whose stamps are in the list.
void AddPictures(const fs::path& list, const fs::path& pictures, std::vector<fs::path>& own) {
  const std::string text = ReadFile(list.string());
  std::set<std::string> stamps;
  for (const TextLine& line : ContentLines(text))
    stamps.emplace(line.text.substr(0, line.text.find_first_of(" \t")));
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(pictures, error)) {
    const std::string name = entry.path().filename().string();
    const size_t ending = name.rfind(".png");
    if (ending == std::string::npos || stamps.count(name.substr(0, ending)) == 0) continue;
    const std::string rest = name.substr(ending);
    if (rest == ".png" || StartsWith(rest, ".png.tmp")) own.push_back(entry.path());
  }
}

// "map.alidade" for "map.alidade.tmp123-0"; empty: not a temporary of one of our files.
std::string PlaceOfTemporary(const std::string& name) {
  const size_t at = name.rfind(".tmp");
  if (at == std::string::npos) return {};
  const std::string numbers = name.substr(at + 4), place = name.substr(0, at);
  const size_t dash = numbers.find('-');
  if (dash == 0 || dash == std::string::npos || dash + 1 == numbers.size() ||
      numbers.find_first_not_of("0123456789-") != std::string::npos)
    return {};
  const bool ours = HasNameOfFile(place) || HasNameOfList(place, kDepth) ||
                    HasNameOfList(place, kMasks) || place == kMasks.name || place == kRunPlace;
  return ours ? place : "";
}

}  // namespace

std::string NumberedFile(const std::string& name, size_t number, const std::string& ending) {
  return number == 0 ? name + ending : name + "." + std::to_string(number) + ending;
}

std::string DepthPictureFile(const std::string& stamp) {
  return kDepth.name + "/" + stamp + ".png";
}

std::string MaskPictureFile(const std::string& stamp) { return kMasks.name + "/" + stamp + ".png"; }

std::vector<fs::path> OwnFilesIn(const fs::path& folder, const EarlierResult& result) {
  std::vector<fs::path> own;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    const std::string name = path.filename().string();
    const auto& files = result.files;
    if (files ? std::find(files->begin(), files->end(), name) == files->end()
              : !WasLikelyOurs(path, result))
      continue;
    const bool depth = IsList(path, kDepth), masks = IsList(path, kMasks);
    if (depth || masks)
      AddPictures(path, folder / (depth ? kDepth : kMasks).name, own);
    else if (!HasNameOfFile(name))
      continue;
    own.push_back(path);
  }
  return own;
}

void CheckIsNoResult(const std::string& path) {
  const fs::path folder = fs::absolute(path).parent_path();
  const auto result = ReadEarlierResult((folder / kStatsFile).string());
  if (!result) return;
  for (const fs::path& own : OwnFilesIn(folder, *result)) {
    std::error_code error;
    if (fs::equivalent(own, path, error))
      ThrowUsage(path + " belongs to the results of " + result->owner.InWords() +
                 ": choose another file");
  }
}

void AddToResult(const std::string& folder, const std::vector<std::string>& names,
                 const std::function<void()>& write) {
  using nlohmann::ordered_json;
  const FolderLock lock((fs::path(folder) / kRunLock).string(), folder);
  const std::string stats_path = (fs::path(folder) / kStatsFile).string();
  ordered_json stats = ordered_json::parse(ReadFile(stats_path), nullptr, false);
  const bool listed = stats.is_object() && stats.contains("folder") &&
                      stats["folder"].is_object() && stats["folder"].contains("files") &&
                      stats["folder"]["files"].is_array();
  for (const std::string& name : names) {
    const std::string path = (fs::path(folder) / name).string();
    const auto& files = listed ? stats["folder"]["files"] : ordered_json();
    if (IsThere(path) && std::find(files.begin(), files.end(), ordered_json(name)) == files.end())
      ThrowUsage(path + " was not written by alidade: choose other files with --out");
  }
  write();
  if (!listed) return;  // of an older version
  ordered_json& files = stats["folder"]["files"];
  for (const std::string& name : names) {
    if (std::find(files.begin(), files.end(), ordered_json(name)) == files.end())
      files.push_back(name);
  }
  AtomicWriteFile(stats_path,
                  stats.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

std::vector<fs::path> LeftoversIn(const fs::path& folder) {
  std::set<std::string> places;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    places.insert(PlaceOfTemporary(entry.path().filename().string()));
  places.erase("");
  std::vector<fs::path> left;
  for (const std::string& place : places) {
    for (const std::string& path : StaleTemporaries((folder / place).string()))
      left.emplace_back(path);
  }
  return left;
}

bool HoldsNoResult(const fs::path& folder, std::error_code& error) {
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name != kRunLock && name != kRunDone && PlaceOfTemporary(name).empty()) return false;
  }
  return true;
}

}  // namespace alidade
