#include "alidade/io/imu_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/inertial/imu_stream.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr double kMetersPerG = 9.80665;  // m/s² per g, by definition
constexpr double kUsualReadings = 200;   // per second

enum Column { kTime, kRateX, kRateY, kRateZ, kForceX, kForceY, kForceZ, kColumns };

// What the header, or the order, says.
struct Layout {
  std::array<int, kColumns> at = {0, 1, 2, 3, 4, 5, 6};
  std::optional<StampUnit> time;
  std::optional<bool> degrees, g;  // else rad/s, m/s²
};

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

bool Has(std::string_view text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string_view::npos; });
}

char SeparatorOf(std::string_view line) {
  for (const char separator : {';', '\t', ','}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return ' ';
}

// Empty fields count, except between blanks.
std::vector<std::string_view> Split(std::string_view line, char separator) {
  constexpr std::string_view kBlanks = " \t\r\"'";
  std::vector<std::string_view> fields;
  for (size_t begin = 0; begin <= line.size();) {
    const size_t end = std::min(line.find(separator, begin), line.size());
    std::string_view field = line.substr(begin, end - begin);
    const size_t first = field.find_first_not_of(kBlanks);
    field = first == std::string_view::npos
                ? std::string_view()
                : field.substr(first, field.find_last_not_of(kBlanks) - first + 1);
    if (separator != ' ' || !field.empty()) fields.push_back(field);
    begin = end + 1;
  }
  return fields;
}

// The name without its unit, and the unit: "w_RS_S_x [rad s^-1]" -> "w_rs_s_x", "rad s^-1".
std::pair<std::string, std::string> NameAndUnit(std::string_view field) {
  const size_t open = field.find_first_of("[(");
  std::string name = Lower(field.substr(0, open));
  std::string unit = open == std::string_view::npos ? std::string() : Lower(field.substr(open + 1));
  while (!name.empty() && (name.back() == ' ' || name.back() == '_')) name.pop_back();
  while (!name.empty() && (name.front() == ' ' || name.front() == '#' || name.front() == '%'))
    name.erase(name.begin());
  while (!unit.empty() && (unit.back() == ']' || unit.back() == ')' || unit.back() == ' '))
    unit.pop_back();
  return {name, unit};
}

std::optional<StampUnit> TimeUnitNamed(const std::string& unit) {
  const auto is = [&](std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(), [&](const char* w) { return unit == w; });
  };
  if (is({"ns", "nsec", "nanoseconds", "nanosec"})) return StampUnit::kNanoseconds;
  if (is({"us", "usec", "µs", "microseconds"})) return StampUnit::kMicroseconds;
  if (is({"ms", "msec", "milliseconds"})) return StampUnit::kMilliseconds;
  if (is({"s", "sec", "seconds"})) return StampUnit::kSeconds;
  return std::nullopt;
}

// The unit at the end of a name: "time_ns".
std::string EndOf(const std::string& name) {
  const size_t gap = name.find_last_of("_. ");
  return gap == std::string::npos ? name : name.substr(gap + 1);
}

void ReadForceUnit(const std::string& unit, Layout& layout) {
  if (Has(unit, {"m/s", "m s", "ms-2", "ms^-2", "mps2"})) {
    layout.g = false;
  } else if (unit == "g") {
    layout.g = true;
  }
}

void ReadRateUnit(const std::string& unit, Layout& layout) {
  if (Has(unit, {"deg", "°", "dps"})) {
    layout.degrees = true;
  } else if (Has(unit, {"rad"})) {
    layout.degrees = false;
  }
}

// Which quantity a name means: kTime, kRateX or kForceX (of any axis); nullopt: another one.
std::optional<Column> QuantityOf(const std::string& name) {
  if (Has(name, {"cov", "quat", "orient", "mag", "vector", "bias"})) return std::nullopt;
  if (Has(name, {"gyr", "omega", "angular", "rotation", "w_rs"})) return kRateX;
  if (name.size() <= 3 && (name[0] == 'w' || (name[0] == 'g' && name.size() == 2))) return kRateX;
  if (Has(name, {"acc", "a_rs", "force"})) return kForceX;
  if (name.size() <= 3 && name[0] == 'a') return kForceX;
  if (name == "t" || Has(name, {"time", "stamp", "second"})) return kTime;
  return std::nullopt;
}

// nullopt: the fields are not names of columns.
std::optional<Layout> LayoutNamed(const std::vector<std::string_view>& fields,
                                  const std::string& file) {
  Layout layout;
  layout.at.fill(-1);
  for (size_t i = 0; i < fields.size(); ++i) {
    const auto [name, unit] = NameAndUnit(fields[i]);
    if (name.empty()) continue;
    const std::optional<Column> quantity = QuantityOf(name);
    if (!quantity) continue;
    int column = *quantity;
    if (*quantity == kTime) {
      if (layout.at[kTime] >= 0) continue;  // the first one counts
      layout.time = TimeUnitNamed(unit.empty() ? EndOf(name) : unit);
    } else {
      const char axis = name.back();
      if (axis < 'x' || axis > 'z') continue;
      column += axis - 'x';
      if (*quantity == kRateX) ReadRateUnit(unit, layout);
      if (*quantity == kForceX) ReadForceUnit(unit, layout);
    }
    if (layout.at[static_cast<size_t>(column)] >= 0) {
      ThrowInput(file + ": the columns `" +
                 std::string(fields[static_cast<size_t>(layout.at[static_cast<size_t>(column)])]) +
                 "` and `" + std::string(fields[i]) + "` are of the same quantity");
    }
    layout.at[static_cast<size_t>(column)] = static_cast<int>(i);
  }
  const auto named =
      std::count_if(layout.at.begin(), layout.at.end(), [](int i) { return i >= 0; });
  if (named == kColumns) return layout;
  if (named < 4) return std::nullopt;  // prose
  constexpr const char* kNames[] = {"time",           "angular rate x", "angular rate y",
                                    "angular rate z", "acceleration x", "acceleration y",
                                    "acceleration z"};
  const auto missing = std::find(layout.at.begin(), layout.at.end(), -1) - layout.at.begin();
  ThrowInput(file + ": no column is named as the " + kNames[missing] +
             ": name the columns t,wx,wy,wz,ax,ay,az");
}

// A sentence in place of names: "# seconds, acceleration … m/s^2, turning about x y z deg/s".
Layout LayoutTold(const std::string& text) {
  Layout layout;
  const size_t rate = std::min({text.find("turn"), text.find("gyr"), text.find("angular"),
                                text.find("rotation"), text.find("rate")});
  const size_t force = text.find("acc");
  if (rate != std::string::npos && force < rate) layout.at = {0, 4, 5, 6, 1, 2, 3};
  if (rate == std::string::npos) return layout;
  if (Has(text, {"deg/s", "°/s"})) layout.degrees = true;
  if (Has(text, {"rad/s"})) layout.degrees = false;
  if (Has(text, {"m/s^2", "m/s2", "m/s²"})) layout.g = false;
  if (text.find("seconds") < std::min(rate, force)) layout.time = StampUnit::kSeconds;
  return layout;
}

// The comment or first line before the numbers; empty: there is none. Lines of numbers begin at
// `first`.
std::string HeaderOf(std::string_view text, const std::vector<TextLine>& lines, size_t& first) {
  first = 0;
  const std::vector<std::string_view> fields = Split(lines[0].text, SeparatorOf(lines[0].text));
  if (!fields.empty() && !ParseNumber(fields[0])) {
    first = 1;
    return std::string(lines[0].text);
  }
  // The last comment before it.
  std::string header;
  const std::string_view before =
      text.substr(0, static_cast<size_t>(lines[0].text.data() - text.data()));
  for (size_t begin = 0; begin < before.size();) {
    const size_t end = std::min(before.find('\n', begin), before.size());
    std::string_view line = before.substr(begin, end - begin);
    const size_t mark = line.find('#');
    if (mark != std::string_view::npos) header = line.substr(mark + 1);
    begin = end + 1;
  }
  while (!header.empty() && std::isspace(static_cast<unsigned char>(header.back())))
    header.pop_back();
  return header;
}

// Of times in steps of about 1 / kUsualReadings.
StampUnit ProbableImuUnit(const std::vector<double>& stamps) {
  // ProbableUnit() expects steps of 1/30 s.
  std::vector<double> slower;
  const double factor = kUsualReadings / 30;
  const double first = stamps.empty() ? 0 : stamps.front();
  for (const double stamp : stamps) slower.push_back(first + factor * (stamp - first));
  return ProbableUnit(slower, StampUnit::kSeconds);
}

void Tell(std::string& told, const std::string& what) { told += (told.empty() ? "" : ", ") + what; }

}  // namespace

ImuTable ParseImuTable(std::string_view text, const std::string& name,
                       std::optional<StampUnit> stamps) {
  CheckIsText(text, name);
  const std::vector<TextLine> lines = ContentLines(text);
  if (lines.empty()) ThrowInput(name + " has no readings");
  size_t first = 0;
  const std::string header = HeaderOf(text, lines, first);
  if (first == lines.size()) ThrowInput(name + " has no readings");
  const char separator = SeparatorOf(lines[first].text);
  Layout layout;
  if (!header.empty()) {
    const auto named = LayoutNamed(Split(header, SeparatorOf(header)), name);
    layout = named ? *named : LayoutTold(Lower(header));
  }
  const auto most = static_cast<size_t>(*std::max_element(layout.at.begin(), layout.at.end()));
  ImuTable table;
  std::vector<double> times;
  std::vector<std::string> written;
  size_t odd = 0, first_odd = 0;
  for (size_t i = first; i < lines.size(); ++i) {
    const std::vector<std::string_view> fields = Split(lines[i].text, separator);
    std::array<double, kColumns> value{};
    bool good = fields.size() > most;
    for (size_t c = 0; good && c < kColumns; ++c) {
      const auto number = ParseNumber(fields[static_cast<size_t>(layout.at[c])]);
      good = number.has_value();
      if (good) value[c] = *number;
    }
    if (!good || !std::isfinite(value[kTime])) {
      if (odd++ == 0) first_odd = static_cast<size_t>(lines[i].number);
      continue;
    }
    times.push_back(value[kTime]);
    written.emplace_back(fields[static_cast<size_t>(layout.at[kTime])]);
    table.samples.push_back({0,
                             {value[kRateX], value[kRateY], value[kRateZ]},
                             {value[kForceX], value[kForceY], value[kForceZ]}});
  }
  if (table.samples.empty()) {
    ThrowInput(name + ":" + std::to_string(first_odd) +
               ": a reading is 7 numbers: time, angular rate x y z, acceleration x y z");
  }
  std::string units;
  StampUnit unit = StampUnit::kSeconds;
  if (layout.time || stamps) {
    unit = layout.time ? *layout.time : *stamps;
  } else {
    unit = ProbableImuUnit(times);
    Tell(units, std::string("times are read as ") + NameOf(unit));
  }
  std::vector<double> rates, forces;
  for (const ImuSample& sample : table.samples) {
    if (sample.angular_rate.allFinite()) rates.push_back(sample.angular_rate.norm());
    if (sample.specific_force.allFinite()) forces.push_back(sample.specific_force.norm());
  }
  if (!layout.degrees) {
    layout.degrees = SeemInDegrees(rates);
    Tell(units, std::string("angular rates as ") + (*layout.degrees ? "deg/s" : "rad/s"));
  }
  if (!layout.g) {
    layout.g = SeemInG(forces);
    Tell(units, std::string("accelerations as ") + (*layout.g ? "g" : "m/s²"));
  }
  const double rate = *layout.degrees ? std::numbers::pi / 180 : 1,
               force = *layout.g ? kMetersPerG : 1;
  for (size_t i = 0; i < table.samples.size(); ++i) {
    ImuSample& sample = table.samples[i];
    sample.time = ParseNumber(StampInSeconds(written[i], unit)).value_or(times[i]);
    sample.angular_rate *= rate;
    sample.specific_force *= force;
  }
  if (!units.empty()) table.told = name + ": " + units;
  if (odd > 0) {
    table.told += (units.empty() ? name + ": " : "; ") + std::to_string(odd) +
                  (odd == 1 ? " line is no reading" : " lines are no readings") +
                  " (the first is " + std::to_string(first_odd) + ")";
  }
  return table;
}

}  // namespace alidade
