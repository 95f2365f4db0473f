// `alidade info`: shows what a map contains.
#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "alidade/base/degrees.h"
#include "alidade/run/export/map_models.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/run/world/moved_map.h"
#include "commands.h"

namespace alidade {
namespace {

using json = nlohmann::ordered_json;  // in the order of docs/reference/map.md

struct InfoOptions {
  std::string map;  // path
  bool as_json = false;
};

json ObservationsOf(const MapSnapshot& map, const std::vector<LandmarkId>& landmarks) {
  std::vector<size_t> counts;
  size_t total = 0;
  for (LandmarkId id : landmarks) {
    counts.push_back(map.Find(id)->observations.size());
    total += counts.back();
  }
  if (counts.empty())
    return {{"total", 0}, {"mean", nullptr}, {"median", nullptr}, {"max", nullptr}};
  std::sort(counts.begin(), counts.end());
  return {{"total", total},
          {"mean", static_cast<double>(total) / static_cast<double>(counts.size())},
          {"median", counts[counts.size() / 2]},
          {"max", counts.back()}};
}

// What is known of its world; null: nothing.
json WorldJson(const MapWorld& world) {
  const auto sigma = [](double value) { return value > 0 ? json(value) : json(nullptr); };
  const Eigen::Vector3d& down = world.down;
  return {{"gravity", world.KnowsDown() ? json({down.x(), down.y(), down.z()}) : json(nullptr)},
          {"gravity_sigma", sigma(world.down_sigma)},
          {"scale_sigma", sigma(world.scale_sigma)}};
}

json PartInfo(const SavedMap& saved, const MapPart& part) {
  const Trajectory trajectory = TrajectoryOf(saved, part);
  Eigen::AlignedBox3d box;
  double length = 0;
  for (size_t i = 0; i < trajectory.size(); ++i) {
    box.extend(trajectory[i].T_world_camera.t);
    if (i > 0)
      length += (trajectory[i].T_world_camera.t - trajectory[i - 1].T_world_camera.t).norm();
  }
  const Eigen::Vector3d size = box.sizes();
  size_t loop_ends = 0;
  for (KeyFrameId id : part.keyframes) loop_ends += saved.map.Find(id)->loops.size();
  const MapWorld world = WorldOf(saved, part);
  json info = {{"keyframes", part.keyframes.size()},
               {"landmarks", part.landmarks.size()},
               {"observations", ObservationsOf(saved.map, part.landmarks)},
               {"time", {trajectory.front().time, trajectory.back().time}},
               {"loops", loop_ends / 2},
               {"path_length", length},
               {"extent", {size.x(), size.y(), size.z()}},
               {"meters", InMeters(saved, world.map)}};
  info.update(WorldJson(world));
  return info;
}

json InfoOf(const SavedMap& saved, const std::string& path) {
  const Camera& camera = saved.camera;
  json maps = json::array();
  for (const MapPart& part : PartsOf(saved.map)) maps.push_back(PartInfo(saved, part));
  json settings = json::object();
  for (const auto& [name, value] : saved.settings) settings[name] = value;
  return {{"version", saved.version},
          {"bytes", std::filesystem::file_size(path)},
          {"sensor", saved.sensor},
          {"camera",
           {{"width", camera.width},
            {"height", camera.height},
            {"fx", camera.fx},
            {"fy", camera.fy},
            {"cx", camera.cx},
            {"cy", camera.cy},
            {"distortion", camera.distortion},
            {"fps", camera.fps},
            {"depth_factor", camera.depth_factor},
            {"baseline", camera.baseline}}},
          {"keyframes", saved.map.keyframe_count()},
          {"landmarks", saved.map.landmark_count()},
          {"maps", maps},
          {"places", {{"nodes", saved.places.nodes.size()}, {"grown_at", saved.places.grown_at}}},
          {"settings", settings}};
}

void PrintWorld(const json& part) {
  if (!part["scale_sigma"].is_null()) {
    std::printf("  lengths       meters, known to %.1f %%\n",
                100 * part["scale_sigma"].get<double>());
  } else {
    std::printf("  lengths       %s\n", part["meters"].get<bool>() ? "meters" : "map units");
  }
  if (part["gravity"].is_null()) {
    std::printf("  gravity       unknown\n");
    return;
  }
  const auto down = part["gravity"].get<std::array<double, 3>>();
  std::printf("  gravity       %.4f %.4f %.4f", down[0], down[1], down[2]);
  if (!part["gravity_sigma"].is_null())
    std::printf(", known to %.2f degrees", kDegrees * part["gravity_sigma"].get<double>());
  std::printf("\n");
}

void PrintPart(const json& part) {
  const char* unit = part["meters"].get<bool>() ? "m" : "units";
  std::printf("  keyframes     %d, %.3f to %.3f s\n", part["keyframes"].get<int>(),
              part["time"][0].get<double>(), part["time"][1].get<double>());
  std::printf("  path          %.2f %s within %.2f x %.2f x %.2f %s\n",
              part["path_length"].get<double>(), unit, part["extent"][0].get<double>(),
              part["extent"][1].get<double>(), part["extent"][2].get<double>(), unit);
  PrintWorld(part);
  if (part["loops"] > 0) std::printf("  loops         %d\n", part["loops"].get<int>());
  const json& seen = part["observations"];
  if (seen["total"] == 0) {
    std::printf("  landmarks     none\n");
  } else {
    std::printf("  landmarks     %d, each seen by %.1f keyframes (median %d, at most %d)\n",
                part["landmarks"].get<int>(), seen["mean"].get<double>(), seen["median"].get<int>(),
                seen["max"].get<int>());
  }
}

void PrintInfo(const json& info, const std::string& path) {
  const json& camera = info["camera"];
  const std::string sensor = info["sensor"];
  std::printf("%s: %.1f MB, format version %d\n", path.c_str(), info["bytes"].get<double>() / 1e6,
              info["version"].get<int>());
  std::printf("sensor          %s\n", sensor.c_str());
  std::printf("camera          %dx%d, fx %.2f fy %.2f cx %.2f cy %.2f", camera["width"].get<int>(),
              camera["height"].get<int>(), camera["fx"].get<double>(), camera["fy"].get<double>(),
              camera["cx"].get<double>(), camera["cy"].get<double>());
  const auto distortion = camera["distortion"].get<std::array<double, 5>>();
  if (std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0; })) {
    std::printf(", distortion %g %g %g %g %g", distortion[0], distortion[1], distortion[2],
                distortion[3], distortion[4]);
  }
  if (camera["baseline"] > 0) std::printf(", baseline %g m", camera["baseline"].get<double>());
  std::printf("\n");
  const json& maps = info["maps"];
  std::printf("maps            %zu\n", maps.size());
  for (size_t i = 0; i < maps.size(); ++i) {
    if (maps.size() > 1) std::printf("map %zu\n", i);
    PrintPart(maps[i]);
  }
}

int InfoCommand(const InfoOptions& options) {
  const std::string path = SavedMapPath(options.map);
  const json info = InfoOf(ReadSavedMap(path), path);
  if (options.as_json) {
    std::printf("%s\n", info.dump(2).c_str());
  } else {
    PrintInfo(info, path);
  }
  return 0;
}

}  // namespace

void AddInfoCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("info", "Show what a map contains");
  const auto options = std::make_shared<InfoOptions>();
  command->add_option("MAP", options->map, "Map file or result folder of `alidade run`")
      ->required()
      ->type_name("PATH");
  command->add_flag("--json", options->as_json, "Print JSON instead of a table");
  command->footer(
      "\nExamples:\n"
      "  alidade info alidade-out/kitchen\n"
      "  alidade info map.alidade --json\n"
      "\nJSON: version, bytes, sensor, camera, keyframes, landmarks, maps, places,\nsettings.");
  command->callback([options, &action] { action = [options] { return InfoCommand(*options); }; });
}

}  // namespace alidade
