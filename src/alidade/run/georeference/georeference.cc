#include "alidade/run/georeference/georeference.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "alidade/base/choice.h"
#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/imu_file.h"
#include "alidade/run/folder/result_folder.h"
#include "alidade/run/georeference/aligned_map.h"
#include "alidade/run/georeference/moved_result.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

bool IsOfReadings(const GeoreferenceSettings& settings) {
  if (settings.kind != "auto") return settings.kind == "imu";
  return IsImuTable(ReadFile(settings.to));
}

ImuModel KnownOfSensor(const GeoreferenceSettings& settings) {
  ImuModel model;
  if (settings.camera) {
    const std::optional<ImuModel> given = ReadImuModel(*settings.camera);
    if (!given) ThrowInput(*settings.camera + " has no block `imu`");
    model = *given;
  }
  if (settings.time_offset) {
    model.time_offset = *settings.time_offset;
    model.time_offset_known = true;
  }
  return model;
}

void CheckPlace(const std::string& result, const std::string& out) {
  std::error_code error;
  if (fs::equivalent(result, out, error))
    ThrowUsage("--out is the result itself; choose another folder");
}

}  // namespace

void GeoreferenceSettings::Check() const {
  Choice<bool>("--kind", kind, {{"auto", true}, {"imu", true}, {"positions", true}});
  if (!antenna.allFinite()) ThrowUsage("--antenna must be three numbers in meters");
  if (time_offset && !std::isfinite(*time_offset))
    ThrowUsage("--time-offset must be a number of seconds");
}

std::vector<std::string> Georeference(const std::string& result, const std::string& out,
                                      const GeoreferenceSettings& settings) {
  settings.Check();
  CheckPlace(result, out);
  ReadResultFolder(result);  // says what is wrong if it is none
  const SavedMap saved = ReadSavedMap(result);
  std::vector<AlignedMap> maps = MapsToAlign(saved, result);
  if (maps.empty()) ThrowInput(result + " has no map with a trajectory");
  std::vector<std::string> lines;
  const bool readings = IsOfReadings(settings);
  ordered_json about = {{"to", settings.to}, {"kind", readings ? "imu" : "positions"}};
  if (readings) {
    const ImuModel model = KnownOfSensor(settings);
    std::string told;
    const std::optional<ImuRecording> imu = ReadImuFile(settings.to, &told);
    if (!imu) ThrowInput(settings.to + ": the readings cannot be used (see the warning)");
    if (!told.empty()) lines.push_back(told);
    for (AlignedMap& map : maps) AlignWithReadings(saved, imu->samples, model, map);
  } else {
    const PositionsTable table = ParsePositions(ReadFile(settings.to), settings.to);
    if (!table.told.empty()) lines.push_back(table.told);
    for (AlignedMap& map : maps) AlignWithPositions(saved, table, settings, map);
    if (table.origin)
      about["origin"] = {{"latitude", table.origin->latitude},
                         {"longitude", table.origin->longitude},
                         {"altitude", table.origin->altitude}};
  }
  if (!maps.front().why_not.empty()) ThrowInput(settings.to + ": " + maps.front().why_not);
  ordered_json of_maps = ordered_json::array();
  std::vector<AlignedMap> aligned;
  std::vector<std::string> facts;
  const bool several = maps.size() > 1;
  for (AlignedMap& map : maps) {
    const std::string name = "map " + std::to_string(map.number);
    if (!map.why_not.empty()) {
      lines.push_back(name + " is left out: " + map.why_not);
      continue;
    }
    if (several) lines.push_back(name + ":");
    if (aligned.empty()) facts = map.told;
    lines.insert(lines.end(), map.told.begin(), map.told.end());
    of_maps.push_back(map.found);
    aligned.push_back(std::move(map));
  }
  about["maps"] = of_maps;
  WriteMovedResult(result, out, saved, aligned, about, facts);
  return lines;
}

}  // namespace alidade
