// Positions of a receiver of satellite navigation (GNSS) or of a survey, written as a table of
// text.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace alidade {

struct TimedPosition {
  double time = 0;    // seconds, on the clock of the table
  Eigen::Vector3d p;  // meters: as in the table, or east, north, up from the origin
};

// A place on the ellipsoid WGS 84.
struct GeoPlace {
  double latitude = 0, longitude = 0;  // degrees
  double altitude = 0;                 // meters above the ellipsoid, or as in the table
};

struct PositionsTable {
  std::vector<TimedPosition> positions;  // by time
  std::optional<GeoPlace> origin;        // of east, north, up; nullopt: the table has x, y, z
  std::string told;  // what was assumed or left out, as a sentence; empty: nothing
};

// One line per position, separated by commas, semicolons, tabs or blanks. A first line (or a
// comment before the numbers) with names says which column is which: time, and x, y, z (or east,
// north, up) in meters or latitude, longitude (degrees) and altitude (meters). Without names: time
// x y z; more columns are ignored, so that TUM trajectories are read. Times in s, ms, µs or ns: as
// named
// ("[ns]", "_ms"), or the probable unit. The origin of east, north, up is the first position.
// Throws Error (input) naming the file if a column is missing, or it has no positions.
PositionsTable ParsePositions(std::string_view text, const std::string& name);

// East, north, up of a place, meters: by the tangent plane at `origin`.
Eigen::Vector3d EnuOf(const GeoPlace& place, const GeoPlace& origin);

// Whether a table is of inertial readings rather than positions: by the names of its columns, or 7
// columns without names.
bool IsImuTable(std::string_view text);

}  // namespace alidade
