#include "alidade/run/folder/result_folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/sources/truth.h"

namespace alidade {
namespace {

using nlohmann::json;

// The file may have been written by anybody: types are checked.
std::optional<double> NumberIn(const json& object, const char* name) {
  if (!object.is_object() || !object.contains(name) || !object[name].is_number())
    return std::nullopt;
  return object[name].get<double>();
}

std::string WordIn(const json& object, const char* name) {
  return object.is_object() && object.contains(name) && object[name].is_string()
             ? object[name].get<std::string>()
             : "";
}

std::optional<std::array<double, 2>> PairIn(const json& list) {
  if (!list.is_array() || list.size() != 2 || !list[0].is_number() || !list[1].is_number())
    return std::nullopt;
  return std::array<double, 2>{list[0].get<double>(), list[1].get<double>()};
}

// Version 0.1 wrote the second name.
std::optional<double> RenamedNumberIn(const json& stats, const char* name, const char* before) {
  const std::optional<double> number = NumberIn(stats, name);
  return number ? number : NumberIn(stats, before);
}

MedianBar BarIn(const json& stats, const char* stage) {
  if (!stats.contains("ms") || !stats["ms"].is_object() || !stats["ms"].contains(stage)) return {};
  const json& ms = stats["ms"][stage];
  const auto median = NumberIn(ms, "median"), p95 = NumberIn(ms, "p95"), max = NumberIn(ms, "max");
  if (!median || !p95 || !max) return {};
  return {*median, *p95, *max};
}

std::optional<Camera> CameraIn(const json& stats) {
  if (!stats.contains("camera")) return std::nullopt;
  const json& told = stats["camera"];
  const auto width = NumberIn(told, "width"), height = NumberIn(told, "height");
  const auto fx = NumberIn(told, "fx"), fy = NumberIn(told, "fy");
  const auto cx = NumberIn(told, "cx"), cy = NumberIn(told, "cy");
  constexpr double kMostSide = 1e6;  // pixels
  if (!width || !height || !fx || !fy || !cx || !cy) return std::nullopt;
  if (!(*width > 0 && *width<kMostSide&& * height> 0 && *height < kMostSide)) return std::nullopt;
  Camera camera;
  camera.width = static_cast<int>(*width);
  camera.height = static_cast<int>(*height);
  camera.fx = *fx;
  camera.fy = *fy;
  camera.cx = *cx;
  camera.cy = *cy;
  if (told.contains("distortion") && told["distortion"].is_array()) {
    for (size_t i = 0; i < camera.distortion.size() && i < told["distortion"].size(); ++i) {
      const json& k = told["distortion"][i];
      if (k.is_number()) camera.distortion[i] = k.get<double>();
    }
  }
  return camera;
}

}  // namespace

ResultFolder ReadResultFolder(const std::string& path) {
  const std::string file = path + "/stats.json";
  if (!IsFolder(path)) ThrowInput(path + " is not a result folder of `alidade run`");
  if (!IsThere(file))
    ThrowInput("there is no stats.json in " + path +
               ": it is not a result folder of `alidade run`");
  const json stats = json::parse(ReadFile(file), nullptr, /*allow_exceptions=*/false);
  if (!stats.is_object() || !NumberIn(stats, "frames") || !NumberIn(stats, "tracked"))
    ThrowInput(file + " was not written by `alidade run`");
  ResultFolder result;
  result.path = path;
  result.camera = CameraIn(stats);
  result.source = WordIn(stats, "source");
  result.sensor = WordIn(stats, "sensor");
  result.frames = NumberIn(stats, "frames");
  result.tracked = NumberIn(stats, "tracked");
  result.coverage = NumberIn(stats, "coverage");
  result.initialized_at = RenamedNumberIn(stats, "initialized_at", "initialised_at");
  result.keyframes = NumberIn(stats, "keyframes");
  result.landmarks = NumberIn(stats, "landmarks");
  result.loops = NumberIn(stats, "loops");
  result.relocalizations = RenamedNumberIn(stats, "relocalizations", "relocalisations");
  result.maps = NumberIn(stats, "maps");
  result.cpu_s = NumberIn(stats, "cpu_s");
  result.peak_mb = NumberIn(stats, "peak_mb");
  for (const char* stage : kResultStages) result.milliseconds.push_back(BarIn(stats, stage));
  if (stats.contains("lost_spans") && stats["lost_spans"].is_array()) {
    for (const json& span : stats["lost_spans"]) {
      if (const auto pair = PairIn(span)) result.lost_spans.push_back(*pair);
    }
  }
  if (stats.contains("map_files") && stats["map_files"].is_array()) {
    for (const json& map : stats["map_files"]) {
      if (!map.is_object() || !map.contains("span")) continue;
      const auto pair = PairIn(map["span"]);
      if (pair) result.first_pose = std::min(result.first_pose.value_or((*pair)[0]), (*pair)[0]);
    }
  }
  const std::string trajectory = path + "/trajectory.txt";
  if (*result.tracked > 0) result.trajectory = ReadTrajectory(trajectory);
  const std::string truth = path + "/groundtruth.txt";
  // The working directory may have changed since the run.
  const json folder = stats.contains("folder") ? stats["folder"] : json();
  result.place = WordIn(folder, "source");
  result.truth = IsFile(truth) ? ReadTrajectory(truth)
                               : TruthBeside(result.place.empty() ? result.source : result.place);
  if (!result.trajectory.empty()) {
    result.span = {result.trajectory.front().time, result.trajectory.back().time};
    if (!result.first_pose) result.first_pose = result.span.first;
  }
  const auto span = stats.contains("span") ? PairIn(stats["span"]) : std::nullopt;
  if (span) result.span = {(*span)[0], (*span)[1]};
  return result;
}

}  // namespace alidade
