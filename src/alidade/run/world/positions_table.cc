#include "alidade/run/world/positions_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>

#include "alidade/base/error.h"
#include "alidade/io/stamp_unit.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr double kUsualPositions = 5;  // per second

enum Column { kTime, kX, kY, kZ, kColumns };

struct PositionColumns {
  std::array<int, kColumns> at = {0, 1, 2, 3};  // -1: there is none
  bool geographic = false;
  std::optional<StampUnit> time;
};

std::string LowerOf(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::vector<std::string> FieldsOf(std::string_view line) {
  char separator = ' ';
  for (const char mark : {';', '\t', ','}) {
    if (line.find(mark) != std::string_view::npos) {
      separator = mark;
      break;
    }
  }
  std::vector<std::string> fields;
  for (size_t begin = 0; begin <= line.size();) {
    const size_t end = std::min(line.find(separator, begin), line.size());
    std::string field(line.substr(begin, end - begin));
    std::erase_if(field, [](unsigned char c) { return std::isspace(c) || c == '"' || c == '#'; });
    if (separator != ' ' || !field.empty()) fields.push_back(field);
    begin = end + 1;
  }
  return fields;
}

std::optional<StampUnit> UnitIn(const std::string& name) {
  const auto ends = [&](const char* ending) {
    const std::string_view end(ending);
    return name.size() >= end.size() &&
           name.compare(name.size() - end.size(), end.size(), end) == 0;
  };
  if (ends("[ns]") || ends("(ns)") || ends("_ns")) return StampUnit::kNanoseconds;
  if (ends("[us]") || ends("(us)") || ends("_us")) return StampUnit::kMicroseconds;
  if (ends("[ms]") || ends("(ms)") || ends("_ms")) return StampUnit::kMilliseconds;
  if (ends("[s]") || ends("(s)") || ends("_s") || ends("seconds")) return StampUnit::kSeconds;
  return std::nullopt;
}

// The name without its unit.
std::string BareName(const std::string& field) {
  return LowerOf(field).substr(0, field.find_first_of("[("));
}

bool IsOneOf(const std::string& name, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* other) { return name == other; });
}

// nullopt: the fields are not names of columns.
std::optional<PositionColumns> ColumnsNamed(const std::vector<std::string>& fields,
                                            const std::string& file) {
  PositionColumns columns;
  columns.at.fill(-1);
  std::array<int, kColumns> geographic;
  geographic.fill(-1);
  const auto take = [](int& column, size_t i) {
    if (column < 0) column = static_cast<int>(i);
  };
  for (size_t i = 0; i < fields.size(); ++i) {
    const std::string name = BareName(fields[i]);
    if (name == "t" || name.find("time") != std::string::npos ||
        name.find("stamp") != std::string::npos || IsOneOf(name, {"seconds", "sec"})) {
      if (columns.at[kTime] < 0) columns.time = UnitIn(LowerOf(fields[i]));
      take(columns.at[kTime], i);
    }
    if (IsOneOf(name, {"x", "tx", "px", "p_x", "e", "east", "easting", "p_rs_r_x"}))
      take(columns.at[kX], i);
    if (IsOneOf(name, {"y", "ty", "py", "p_y", "n", "north", "northing", "p_rs_r_y"}))
      take(columns.at[kY], i);
    if (IsOneOf(name, {"z", "tz", "pz", "p_z", "u", "up", "p_rs_r_z"})) take(columns.at[kZ], i);
    if (IsOneOf(name, {"lat", "latitude"})) take(geographic[kX], i);
    if (IsOneOf(name, {"lon", "lng", "long", "longitude"})) take(geographic[kY], i);
    if (IsOneOf(name, {"alt", "altitude", "height", "ele", "elevation", "h"}))
      take(geographic[kZ], i);
  }
  geographic[kTime] = columns.at[kTime];
  if (geographic[kX] >= 0 || geographic[kY] >= 0) {
    columns.at = geographic;
    columns.geographic = true;
  }
  const auto named =
      std::count_if(columns.at.begin(), columns.at.end(), [](int i) { return i >= 0; });
  if (named == kColumns) return columns;
  if (named < 2) return std::nullopt;  // prose
  constexpr const char* kPlain[] = {"time", "x", "y", "z"};
  constexpr const char* kGeographic[] = {"time", "latitude", "longitude", "altitude"};
  const auto missing = std::find(columns.at.begin(), columns.at.end(), -1) - columns.at.begin();
  ThrowInput(file + ": no column is named as the " +
             (columns.geographic ? kGeographic : kPlain)[missing] +
             ": name the columns t,x,y,z (meters) or t,lat,lon,alt");
}

// The line of names before the numbers; empty: there is none. Numbers begin at `first`.
std::string NamesOf(std::string_view text, const std::vector<TextLine>& lines, size_t& first) {
  first = 0;
  if (lines.empty()) return {};
  const std::vector<std::string> fields = FieldsOf(lines[0].text);
  if (!fields.empty() && !ParseNumber(fields[0])) {
    first = 1;
    return std::string(lines[0].text);
  }
  const std::string_view before =
      text.substr(0, static_cast<size_t>(lines[0].text.data() - text.data()));
  const size_t mark = before.rfind('#');
  if (mark == std::string_view::npos) return {};
  return std::string(before.substr(mark, before.find('\n', mark) - mark));
}

// Earth-centered coordinates on WGS 84, meters.
Eigen::Vector3d EcefOf(const GeoPlace& place) {
  constexpr double kRadius = 6378137, kFlattening = 1 / 298.257223563;
  constexpr double kE2 = kFlattening * (2 - kFlattening);
  const double lat = place.latitude * std::numbers::pi / 180,
               lon = place.longitude * std::numbers::pi / 180;
  const double N = kRadius / std::sqrt(1 - kE2 * std::sin(lat) * std::sin(lat));
  return {(N + place.altitude) * std::cos(lat) * std::cos(lon),
          (N + place.altitude) * std::cos(lat) * std::sin(lon),
          (N * (1 - kE2) + place.altitude) * std::sin(lat)};
}

StampUnit ProbablePositionUnit(const std::vector<double>& stamps) {
  std::vector<double> faster;  // ProbableUnit() expects steps of 1/30 s
  for (const double stamp : stamps)
    faster.push_back(stamps.front() + kUsualPositions / 30 * (stamp - stamps.front()));
  return ProbableUnit(faster, StampUnit::kSeconds);
}

}  // namespace

Eigen::Vector3d EnuOf(const GeoPlace& place, const GeoPlace& origin) {
  const double lat = origin.latitude * std::numbers::pi / 180,
               lon = origin.longitude * std::numbers::pi / 180;
  Eigen::Matrix3d R;
  R << -std::sin(lon), std::cos(lon), 0,  //
      -std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat),
      std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat);
  return R * (EcefOf(place) - EcefOf(origin));
}

bool IsImuTable(std::string_view text) {
  const std::vector<TextLine> lines = ContentLines(text);
  size_t first = 0;
  const std::string names = LowerOf(NamesOf(text, lines, first));
  const auto has = [&](const char* word) { return names.find(word) != std::string::npos; };
  if (has("gyr") || has("acc") || has("angular") || has("w_rs") || has("wx") || has("omega") ||
      has("turning"))
    return true;
  if (has("lat") || has("east") || has("p_rs") || has("tx") || has("z")) return false;
  return first < lines.size() && FieldsOf(lines[first].text).size() == 7;
}

PositionsTable ParsePositions(std::string_view text, const std::string& name) {
  CheckIsText(text, name);
  const std::vector<TextLine> lines = ContentLines(text);
  size_t first = 0;
  const std::string names = NamesOf(text, lines, first);
  if (first >= lines.size()) ThrowInput(name + " has no positions");
  PositionColumns columns;
  if (!names.empty()) columns = ColumnsNamed(FieldsOf(names), name).value_or(columns);
  const auto most = static_cast<size_t>(*std::max_element(columns.at.begin(), columns.at.end()));
  std::vector<double> times;
  std::vector<std::string> written;
  std::vector<Eigen::Vector3d> values;
  size_t odd = 0;
  for (size_t i = first; i < lines.size(); ++i) {
    const std::vector<std::string> fields = FieldsOf(lines[i].text);
    std::array<double, kColumns> value{};
    bool good = fields.size() > most;
    for (size_t c = 0; good && c < kColumns; ++c) {
      const auto number = ParseNumber(fields[static_cast<size_t>(columns.at[c])]);
      good = number && std::isfinite(*number);
      if (good) value[c] = *number;
    }
    if (good && columns.geographic) good = std::abs(value[kX]) <= 90 && std::abs(value[kY]) <= 360;
    if (!good) {
      ++odd;
      continue;
    }
    times.push_back(value[kTime]);
    written.push_back(fields[static_cast<size_t>(columns.at[kTime])]);
    values.emplace_back(value[kX], value[kY], value[kZ]);
  }
  if (values.empty())
    ThrowInput(name + " has no positions: a line is time x y z, or has names of columns above");
  PositionsTable table;
  const StampUnit unit = columns.time ? *columns.time : ProbablePositionUnit(times);
  if (!columns.time) table.told = name + ": times are read as " + NameOf(unit);
  if (odd > 0)
    table.told += (table.told.empty() ? name + ": " : "; ") + std::to_string(odd) +
                  (odd == 1 ? " line is no position" : " lines are no positions");
  if (columns.geographic)
    table.origin = GeoPlace{values.front().x(), values.front().y(), values.front().z()};
  for (size_t i = 0; i < values.size(); ++i) {
    const double time = ParseNumber(StampInSeconds(written[i], unit)).value_or(times[i]);
    const Eigen::Vector3d& v = values[i];
    table.positions.push_back(
        {time, table.origin ? EnuOf({v.x(), v.y(), v.z()}, *table.origin) : v});
  }
  std::stable_sort(table.positions.begin(), table.positions.end(),
                   [](const TimedPosition& a, const TimedPosition& b) { return a.time < b.time; });
  return table;
}

}  // namespace alidade
