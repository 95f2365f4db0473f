#include "alidade/run/sources/saved_map.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"

namespace alidade {

std::string SavedMapPath(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return path;
  return (std::filesystem::path(path) / "map.alidade").string();
}

SavedMap ReadSavedMap(const std::string& path) {
  const std::string file = SavedMapPath(path);
  const auto named = [&file](const auto& read) {
    try {
      return read();
    } catch (const Error& error) {
      ThrowInput(file + ": " + error.what());
    }
  };
  const std::string bytes = ReadFile(
      file, kMostMapBytes, [&](std::string_view start) { named([&] { CheckMapStart(start); }); });
  return named([&] { return DecodeMap(bytes); });
}

std::vector<MapPart> PartsOf(const MapSnapshot& map) {
  std::map<MapId, MapPart> by_id;
  for (KeyFrameId id : map.KeyFrames()) by_id[map.MapOf(id)].keyframes.push_back(id);
  for (LandmarkId id : map.Landmarks()) {
    by_id[map.MapOf(map.Find(id)->reference)].landmarks.push_back(id);
  }
  std::vector<MapPart> parts;
  parts.reserve(by_id.size());
  for (auto& [id, part] : by_id) parts.push_back(std::move(part));
  std::stable_sort(parts.begin(), parts.end(), [](const MapPart& a, const MapPart& b) {
    return a.keyframes.size() > b.keyframes.size();
  });
  return parts;
}

}  // namespace alidade
