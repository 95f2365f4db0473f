#include "alidade/io/files/datasets/stamped_list.h"

#include <cmath>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/print.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"

namespace alidade {

namespace {

// "33333.3 s", "1.2e+09 s".
std::string Seconds(double seconds) {
  char text[32];
  PrintTo(text, sizeof(text), "%.3g s", seconds);
  return text;
}

// The list's times are in another unit than its format says.
void SayUnit(const std::string& name, std::span<const double> stamps, StampUnit declared,
             StampUnit unit) {
  const double step = MedianStep(stamps).value_or(0);
  LogWarning(name + ": the time stamps are read as " + NameOf(unit) + ", one image every " +
             Seconds(step / PerSecond(unit)) + "; as " + NameOf(declared) + " it would be every " +
             Seconds(step / PerSecond(declared)));
}

}  // namespace

std::vector<StampedName> ReadStampedList(const std::string& path, StampUnit unit, bool with_names,
                                         FindUnit find) {
  return ParseStampedList(ReadFile(path), path, unit, with_names, find);
}

std::vector<StampedName> ParseStampedList(std::string_view text, const std::string& name,
                                          StampUnit unit, bool with_names, FindUnit find) {
  CheckIsText(text, name);
  std::vector<StampedName> list;
  std::vector<double> written;
  for (const TextLine& line : ContentLines(text)) {
    StampedName item;
    const size_t end = line.text.find_first_of(" \t,");
    item.stamp = line.text.substr(0, end);
    // The name is everything after the stamp, because names may contain spaces.
    const size_t begin =
        end == std::string_view::npos ? end : line.text.find_first_not_of(" \t,", end);
    if (begin != std::string_view::npos) item.name = line.text.substr(begin);
    const std::string where = name + ":" + std::to_string(line.number) + ": ";
    const auto time = ParseNumber(item.stamp);
    if (!time || !std::isfinite(*time)) {
      item.problem = where + "`" + item.stamp + "` is not a time stamp";
    } else if (with_names && item.name.empty()) {
      item.problem = where + "the file name after the time stamp is missing";
    }
    if (item.problem.empty()) written.push_back(*time);
    list.push_back(std::move(item));
  }
  if (list.empty()) ThrowInput(name + " lists nothing");
  const StampUnit in = find == FindUnit::kYes ? ProbableUnit(written, unit) : unit;
  if (in != unit) SayUnit(name, written, unit, in);
  for (StampedName& item : list) {
    if (!item.problem.empty()) continue;
    item.stamp = StampInSeconds(item.stamp, in);
    item.time = ParseNumber(item.stamp).value_or(0);
  }
  return list;
}

}  // namespace alidade
