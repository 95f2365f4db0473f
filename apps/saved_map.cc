#include "saved_map.h"

#include <algorithm>
#include <filesystem>
#include <map>

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
  const std::string bytes = ReadFile(file);
  try {
    return DecodeMap(bytes);
  } catch (const Error& error) {
    ThrowInput(file + ": " + error.what());
  }
}

std::vector<MapPart> PartsOf(const MapSnapshot& map) {
  std::map<uint32_t, MapPart> by_id;
  for (KeyFrameId id : map.KeyFrames()) by_id[0].keyframes.push_back(id);
  for (LandmarkId id : map.Landmarks()) by_id[0].landmarks.push_back(id);
  std::vector<MapPart> parts;
  for (auto& [id, part] : by_id) parts.push_back(std::move(part));
  std::stable_sort(parts.begin(), parts.end(), [](const MapPart& a, const MapPart& b) {
    return a.keyframes.size() > b.keyframes.size();
  });
  return parts;
}

}  // namespace alidade
