// Inertial readings written as a table of text: EuRoC's data.csv, exports of phones and loggers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "alidade/inertial/imu.h"
#include "alidade/io/stamp_unit.h"

namespace alidade {

struct ImuTable {
  std::vector<ImuSample> samples;  // as in the file's order, not cleaned; those with all 7 numbers
  // The units that were not stated, as a sentence for users: "imu.csv: times are read as
  // milliseconds, …". Empty: all were stated.
  std::string told;
};

// One line per reading: time, angular rate x y z, specific force x y z, separated by commas,
// semicolons, tabs or blanks. A first line (or a comment before the numbers) with names, in any
// order and with other columns between, says which column is which; without it the order is as
// above. Units are those in the names ("[ns]", "(deg/s)", "_ms"). Otherwise: `stamps`, if it is
// that of the format; the probable unit of times (200 readings per second, more or less),
// and g and deg/s by SeemInG() and SeemInDegrees(). Lines that are no readings are counted
// in `told`. Throws Error (input) naming the file, and the line, when columns are missing or no
// line is a reading.
ImuTable ParseImuTable(std::string_view text, const std::string& name,
                       std::optional<StampUnit> stamps = {});

}  // namespace alidade
