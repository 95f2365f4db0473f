#include "bench/measure/print.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "alidade/base/timing.h"

namespace alidade::bench {
namespace {

std::string LabelOf(const Case& of) {
  std::string label = of.name;
  if (!of.sensor.empty()) label += " " + of.sensor;
  if (!of.profile.empty() && of.profile != "desktop") label += " " + of.profile;
  if (of.seed > 0) label += " seed " + std::to_string(of.seed);
  return label;
}

void PrintTimings(const Section& section, const Summary& u) {
  std::printf("  %-44s %10s %8s %10s %7s\n", "", "median ms", "U", "p95 ms", "times");
  for (const Timing& timing : section.timings) {
    const Summary s = Summarise(timing.milliseconds);
    char ratio[32] = "-";  // where the reference was not timed in turns
    if (u.count > 0) std::snprintf(ratio, sizeof ratio, "%.3f", s.median / u.median);
    std::printf("  %-44s %10.3f %8s %10.3f %7d  %s\n", LabelOf(timing.of).c_str(), s.median, ratio,
                s.p95, s.count, timing.note.c_str());
  }
}

void PrintTable(const Table& table) {
  std::printf("\n  %s\n", table.name.c_str());
  size_t longest = 24;
  for (const Line& line : table.lines) longest = std::max(longest, LabelOf(line.of).size());
  const int label_width = static_cast<int>(longest);
  std::printf("  %-*s", label_width, "");
  std::vector<int> widths;
  for (const Column& column : table.columns) {
    const std::string heading = column.metric + (column.unit.empty() ? "" : " " + column.unit);
    widths.push_back(std::max(9, static_cast<int>(heading.size())));
    std::printf("  %*s", widths.back(), heading.c_str());
  }
  for (const Line& line : table.lines) {
    std::printf("\n  %-*s", label_width, LabelOf(line.of).c_str());
    for (size_t column = 0; column < widths.size(); ++column) {
      const double value = line.values[column];
      if (std::isfinite(value)) {
        std::printf("  %*.2f", widths[column], value);
      } else {
        std::printf("  %*s", widths[column], "-");
      }
    }
    if (!line.note.empty()) std::printf("  %s", line.note.c_str());
  }
  std::printf("\n  %s\n", table.note.c_str());
}

}  // namespace

void PrintSection(const Section& section) {
  const Summary u = Summarise(section.u_milliseconds);
  if (u.count > 0) {
    std::printf("\n%s (U = %.2f ms, median of %d)\n", section.name.c_str(), u.median, u.count);
  } else {
    std::printf("\n%s\n", section.name.c_str());
  }
  if (!section.timings.empty()) PrintTimings(section, u);
  for (const Table& table : section.tables) PrintTable(table);
  std::fflush(stdout);
}

}  // namespace alidade::bench
