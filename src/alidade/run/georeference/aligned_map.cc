#include "alidade/run/georeference/aligned_map.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "alidade/base/degrees.h"
#include "alidade/base/median.h"
#include "alidade/base/print.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/map/view.h"
#include "alidade/run/world/moved_map.h"
#include "alidade/run/world/trajectory_file_for.h"

namespace alidade {
namespace {

using nlohmann::ordered_json;

constexpr double kLeaning = 0.09;  // radians: two verticals contradict each other

template <typename... Values>
std::string Line(const char* format, Values... values) {
  char text[240];
  PrintTo(text, sizeof(text), format, values...);
  return text;
}

// "trajectory.2.txt" -> 2
size_t NumberOf(const std::string& file) {
  const std::string stem = std::filesystem::path(file).stem().string();
  const size_t dot = stem.rfind('.');
  return dot == std::string::npos ? 0 : static_cast<size_t>(std::stoul(stem.substr(dot + 1)));
}

ordered_json Numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
ordered_json SigmaOrNull(double sigma) {
  return sigma > 0 ? ordered_json(sigma) : ordered_json(nullptr);
}

// Of what the keyframes see, in map units.
double DistanceSeen(const SavedMap& saved, const MapPart& part) {
  std::vector<double> depths;
  for (KeyFrameId id : part.keyframes) {
    const auto depth = MedianDepth(saved.map, *saved.map.Find(id));
    if (depth && *depth > 0) depths.push_back(*depth);
  }
  return depths.empty() ? 1 : UpperMedian(depths);
}

std::string ClockInWords(double offset, double sigma) {
  return sigma > 0
             ? Line("clock          time_offset %.4f s, known to %.1f ms", offset, 1e3 * sigma)
             : Line("clock          time_offset %.4f s, as given", offset);
}

}  // namespace

std::vector<AlignedMap> MapsToAlign(const SavedMap& saved, const std::string& folder) {
  std::vector<AlignedMap> maps;
  for (MapPart& part : PartsOf(saved.map)) {
    AlignedMap map;
    map.id = saved.map.MapOf(part.keyframes.front());
    map.file = TrajectoryFileFor(saved, part, folder);
    if (map.file.empty()) continue;
    map.number = NumberOf(map.file);
    map.R_written_map = WrittenTurnIn(saved, part, folder);
    const Se3 turn{map.R_written_map, Eigen::Vector3d::Zero()};
    for (const StampedPose& pose : ReadTrajectory(map.file)) {
      map.trajectory.push_back(pose);
      map.trajectory.back().T_world_camera = turn.Inverse() * pose.T_world_camera * turn;
    }
    std::stable_sort(map.trajectory.begin(), map.trajectory.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
    map.part = std::move(part);
    maps.push_back(std::move(map));
  }
  std::stable_sort(maps.begin(), maps.end(),
                   [](const AlignedMap& a, const AlignedMap& b) { return a.number < b.number; });
  return maps;
}

void AlignWithReadings(const SavedMap& saved, const std::vector<ImuSample>& samples,
                       const ImuModel& model, AlignedMap& map) {
  WindowSettings windows;
  windows.meters = saved.sensor != "mono";
  windows.distance = DistanceSeen(saved, map.part);
  const InertialFinding found = FindInertial(map.trajectory, samples, model, windows);
  map.why_not = found.why_not;
  if (!found.why_not.empty()) return;
  map.T_new_map.s = windows.meters ? 1 : found.scale;
  map.T_new_map.R = Upright(found.down, /*y_down=*/false);
  map.world = {map.id, true, windows.meters ? 0 : found.scale_sigma, -Eigen::Vector3d::UnitZ(),
               found.down_sigma};
  if (!windows.meters)
    map.told.push_back(Line("scale          %.5g m per map unit, known to %.2f %%", found.scale,
                            100 * found.scale_sigma));
  map.told.push_back(
      Line("gravity        known to %.2f degrees; z is up", kDegrees * found.down_sigma));
  map.told.push_back(ClockInWords(found.model.time_offset, found.time_offset_sigma));
  map.told.push_back(Line("windows        %d of %d of about %.0f s were used", found.solved,
                          found.windows, windows.seconds));
  map.found = {{"scale", map.T_new_map.s},
               {"scale_sigma", SigmaOrNull(map.world.scale_sigma)},
               {"gravity_sigma", found.down_sigma},
               {"time_offset", found.model.time_offset},
               {"time_offset_sigma", SigmaOrNull(found.time_offset_sigma)},
               {"gyro_bias", Numbers(found.bias.gyro)},
               {"accel_bias", Numbers(found.bias.accel)},
               {"noise_factor", found.noise_factor},
               {"windows", found.windows},
               {"windows_used", found.solved}};
}

void AlignWithPositions(const SavedMap& saved, const PositionsTable& table,
                        const GeoreferenceSettings& settings, AlignedMap& map) {
  PositionFitSettings how;
  how.time_offset = settings.time_offset;
  how.antenna = settings.antenna;
  how.meters = saved.sensor != "mono";
  const MapWorld known = WorldOf(saved, map.part);
  if (known.KnowsDown()) {
    how.down = known.down;
    if (known.down_sigma > 0) how.down_sigma = known.down_sigma;
  }
  map.positions = FitPositions(map.trajectory, table.positions, how);
  const PositionFit& fit = map.positions;
  map.why_not = fit.why_not;
  if (!fit.why_not.empty()) return;
  map.T_new_map = fit.T_positions_world;
  map.world = {map.id, true, fit.scale_sigma, -Eigen::Vector3d::UnitZ(), fit.tilt_sigma};
  if (!how.meters)
    map.told.push_back(Line("scale          %.5g m per map unit, known to %.2f %%", map.T_new_map.s,
                            100 * fit.scale_sigma));
  map.told.push_back(Line("rotation       known to %.2f degrees%s", kDegrees * fit.rotation_sigma,
                          fit.by_gravity ? ", with the map's gravity" : ""));
  map.told.push_back(ClockInWords(fit.time_offset, fit.time_offset_sigma));
  const int outliers = fit.matched - fit.used_count();
  map.told.push_back(Line("positions      %d used, %d left out as outliers, %zu at other times",
                          fit.used_count(), outliers,
                          table.positions.size() - static_cast<size_t>(fit.matched)));
  map.told.push_back(Line("residuals      median %.3f m, 95 %% below %.3f m, worst %.3f m",
                          fit.Quantile(0.5), fit.Quantile(0.95), fit.Quantile(1)));
  if (how.down && !fit.by_gravity) {
    const Eigen::Vector3d down = fit.T_positions_world.R * *how.down;
    const double leaning = std::acos(std::clamp(-down.z(), -1.0, 1.0));
    if (leaning > kLeaning + 3 * (fit.tilt_sigma + how.down_sigma)) {
      map.told.push_back(
          Line("gravity        of the map is %.1f degrees from -z of the positions: "
               "their z seems not to be up. That of the map is kept",
               kDegrees * leaning));
      map.world.down = down.normalized();
      map.world.down_sigma = how.down_sigma;
    }
  }
  const Sim3& T = map.T_new_map;
  ordered_json rows = ordered_json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({T.R(r, 0), T.R(r, 1), T.R(r, 2)});
  map.found = {{"scale", T.s},
               {"scale_sigma", SigmaOrNull(fit.scale_sigma)},
               {"rotation", rows},
               {"rotation_sigma", fit.rotation_sigma},
               {"translation", Numbers(T.t)},
               {"time_offset", fit.time_offset},
               {"time_offset_sigma", SigmaOrNull(fit.time_offset_sigma)},
               {"used", fit.used_count()},
               {"outliers", outliers},
               {"residual_median", fit.Quantile(0.5)},
               {"residual_p95", fit.Quantile(0.95)},
               {"residual_max", fit.Quantile(1)}};
}

}  // namespace alidade
