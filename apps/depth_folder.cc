#include "depth_folder.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files/datasets/stamped_list.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/text.h"
#include "alidade/run/folder/output_folder.h"

namespace alidade {
namespace {

constexpr double kDepthPerUnit = 5000;
constexpr int kMostMaps = 100000;  // no run leaves more: a file of a higher number is not ours

using json = nlohmann::ordered_json;

// stats.json as far as it can be read; null else.
json ReadStats(const std::string& path) {
  if (!IsFile(path)) return nullptr;
  return json::parse(ReadFile(path), nullptr, /*allow_exceptions=*/false);
}

std::optional<Sensor> SensorOf(const json& stats) {
  for (const Sensor sensor : {Sensor::kMono, Sensor::kStereo, Sensor::kRgbd}) {
    if (stats.is_object() && stats.value("sensor", json()) == NameOf(sensor)) return sensor;
  }
  return std::nullopt;
}

bool WasAskedForDepth(const json& stats) {
  const json settings = stats.is_object() ? stats.value("settings", json()) : json();
  const json enabled = settings.is_object() ? settings.value("semidense.enabled", json()) : json();
  return enabled == 1 || enabled == true;  // settings are written as 0 and 1
}

// Numbers of the maps that have a list; any may have no depth, the first too.
std::vector<int> ListedMaps(const std::string& folder) {
  std::vector<int> maps;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    int map = 0;
    if (name != "depth.txt" && std::sscanf(name.c_str(), "depth.%d.txt", &map) != 1) continue;
    if (map >= 0 && map <= kMostMaps && name == NumberedFile("depth", static_cast<size_t>(map)))
      maps.push_back(map);
  }
  std::sort(maps.begin(), maps.end());
  return maps;
}

}  // namespace

DepthFolder ReadDepthFolder(const std::string& folder) {
  const std::vector<int> maps = ListedMaps(folder);
  const json stats = ReadStats(folder + "/stats.json");
  if (maps.empty() && !WasAskedForDepth(stats))
    ThrowInput(folder + " contains no depth.txt: it is not a result of `alidade run --semidense`");
  DepthFolder result;
  result.sensor = SensorOf(stats);
  for (const int map : maps) {
    const std::string list = folder + "/" + NumberedFile("depth", static_cast<size_t>(map));
    if (ContentLines(ReadFile(list)).empty()) continue;
    for (StampedName& line : ReadStampedList(list, StampUnit::kSeconds, true)) {
      if (!line.problem.empty()) ThrowInput(line.problem);
      result.files.push_back({line.time, std::move(line.stamp), folder + "/" + line.name, map});
    }
  }
  std::stable_sort(result.files.begin(), result.files.end(),
                   [](const DepthFile& a, const DepthFile& b) { return a.time < b.time; });
  return result;
}

cv::Mat ReadKeyframeDepth(const std::string& path) {
  const cv::Mat stored = ReadDepth(path);
  if (stored.type() != CV_16UC1) ThrowInput(path + " is not a depth image with 16 bits");
  cv::Mat depth;
  stored.convertTo(depth, CV_32F, 1 / kDepthPerUnit);
  return depth;
}

}  // namespace alidade
