// One map of a result and its alignment.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alidade/run/calibration/inertial_windows.h"
#include "alidade/run/georeference/georeference.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/run/world/position_fit.h"

namespace alidade {

struct AlignedMap {
  MapPart part;
  MapId id;
  std::string file;       // of its trajectory
  size_t number = 0;      // of that file: trajectory.txt is 0, trajectory.1.txt is 1
  Trajectory trajectory;  // in the map's world, in order of time
  Eigen::Matrix3d R_written_map = Eigen::Matrix3d::Identity();  // WrittenTurn()
  std::string why_not;  // why it is not aligned; empty: it is
  Sim3 T_new_map;
  MapWorld world;                 // what is known of the new world
  std::vector<std::string> told;  // what was found, as lines for users
  nlohmann::ordered_json found;   // the same for stats.json
  PositionFit positions;          // if it was aligned with positions
};

// The maps of a result that have a trajectory, that of trajectory.txt first.
std::vector<AlignedMap> MapsToAlign(const SavedMap& saved, const std::string& folder);

// Fill in why_not, or the rest.
void AlignWithReadings(const SavedMap& saved, const std::vector<ImuSample>& samples,
                       const ImuModel& model, AlignedMap& map);
void AlignWithPositions(const SavedMap& saved, const PositionsTable& table,
                        const GeoreferenceSettings& settings, AlignedMap& map);

}  // namespace alidade
