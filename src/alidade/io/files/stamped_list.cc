#include "alidade/io/files/stamped_list.h"

#include <cmath>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"
#include "alidade/io/trajectory.h"

namespace alidade {

std::vector<StampedName> ReadStampedList(const std::string& path, StampUnit unit, bool with_names) {
  return ParseStampedList(ReadFile(path), path, unit, with_names);
}

std::vector<StampedName> ParseStampedList(std::string_view text, const std::string& name,
                                          StampUnit unit, bool with_names) {
  CheckIsText(text, name);
  std::vector<StampedName> list;
  for (const TextLine& line : ContentLines(text)) {
    StampedName item;
    const size_t end = line.text.find_first_of(" \t,");
    item.stamp = line.text.substr(0, end);
    // The name is everything after the stamp, because names may contain spaces.
    const size_t begin =
        end == std::string_view::npos ? end : line.text.find_first_not_of(" \t,", end);
    if (begin != std::string_view::npos) item.name = line.text.substr(begin);
    const std::string where = name + ":" + std::to_string(line.number) + ": ";
    const std::string written = item.stamp;
    if (unit == StampUnit::kNanoseconds) item.stamp = StampFromNanoseconds(item.stamp);
    const auto time = ParseNumber(item.stamp);
    if (!time || !std::isfinite(*time)) {
      item.problem = where + "`" + written + "` is not a time stamp";
    } else if (with_names && item.name.empty()) {
      item.problem = where + "the file name after the time stamp is missing";
    }
    item.time = time.value_or(0);
    list.push_back(std::move(item));
  }
  if (list.empty()) ThrowInput(name + " lists nothing");
  return list;
}

}  // namespace alidade
