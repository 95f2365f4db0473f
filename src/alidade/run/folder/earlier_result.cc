#include "alidade/run/folder/earlier_result.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/synth_source.h"

namespace alidade {
namespace {

using nlohmann::json;

// The file may have been written by anybody: types are checked.
double NumberOf(const json& object, const char* name) {
  return object.contains(name) && object[name].is_number() ? object[name].get<double>() : 0;
}

std::string WordOf(const json& object, const char* name) {
  return object.contains(name) && object[name].is_string() ? object[name].get<std::string>() : "";
}

// The form it has after a round trip through JSON: a path may have any encoding.
std::string AsText(const std::string& path) {
  return json::parse(json(path).dump(-1, ' ', false, json::error_handler_t::replace))
      .get<std::string>();
}

std::string PlaceOfSource(const std::string& source) {
  const std::string path = PathOfSource(source);
  if (path.empty()) return IsSynthSource(source) ? AsText(source) : "";
  std::error_code error;
  const std::string canonical = std::filesystem::weakly_canonical(path, error).string();
  return AsText((error ? path : canonical) + source.substr(path.size()));
}

}  // namespace

ResultOwner OwnerOf(const std::string& source, bool localize) {
  return {localize ? "localize" : "run", source, PlaceOfSource(source)};
}

std::optional<EarlierResult> ReadEarlierResult(const std::string& stats_path) {
  if (!IsFile(stats_path)) return std::nullopt;
  const json stats = json::parse(ReadFile(stats_path), nullptr, /*allow_exceptions=*/false);
  if (!stats.is_object() || !stats.contains("version") || !stats.contains("source") ||
      !stats.contains("coverage"))
    return std::nullopt;
  EarlierResult result;
  result.owner.source = WordOf(stats, "source");
  result.frames = NumberOf(stats, "frames") + NumberOf(stats, "late_frames");
  result.tracked = NumberOf(stats, "tracked");
  const json folder = stats.contains("folder") ? stats["folder"] : json();
  if (!folder.is_object()) {  // written by an older version
    result.owner.place = PlaceOfSource(result.owner.source);
    return result;
  }
  result.owner.command = WordOf(folder, "command");
  result.owner.place = WordOf(folder, "source");
  result.complete = folder.value("complete", json()) == true;
  result.files.emplace();
  for (const json& name : folder.value("files", json::array())) {
    if (name.is_string()) result.files->push_back(name.get<std::string>());
  }
  return result;
}

bool IsOf(const EarlierResult& result, const ResultOwner& owner) {
  return result.owner.command == owner.command && !owner.place.empty() &&
         result.owner.place == owner.place;
}

bool IsTakenFrom(const std::optional<EarlierResult>& result, const ResultOwner& owner) {
  return result && result->tracked > 0 && !IsOf(*result, owner);
}

bool MayReplace(const EarlierResult& earlier, const EarlierResult& now) {
  if (earlier.tracked == 0) return true;
  if (now.tracked == 0 || (earlier.complete && !now.complete)) return false;
  return now.frames >= earlier.frames;
}

std::string FreeFolder(const std::string& folder, const ResultOwner& owner) {
  std::string free = folder;
  std::optional<EarlierResult> taken;
  for (int i = 2;; ++i) {
    const auto there = ReadEarlierResult(free + "/stats.json");
    if (!IsTakenFrom(there, owner)) break;
    if (!taken) taken = there;
    free = folder + "-" + std::to_string(i);
  }
  if (taken) {
    LogWarning(folder + " contains the results of " + taken->owner.InWords() + "; the results of " +
               owner.InWords() + " go to " + free);
  }
  return free;
}

}  // namespace alidade
