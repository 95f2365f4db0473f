#include "bench/section_output.h"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "alidade/base/timing.h"
#include "alidade/io/files/file.h"

namespace alidade::bench {

using nlohmann::ordered_json;

void PrintSection(const Section& section) {
  const Summary u = Summarise(section.u_milliseconds);
  if (u.count > 0) {
    std::printf("\n%s (U = %.2f ms, median of %d)\n", section.name.c_str(), u.median, u.count);
  } else {
    std::printf("\n%s\n", section.name.c_str());
  }
  if (!section.rows.empty())
    std::printf("  %-44s %10s %8s %10s %7s\n", "", "median ms", "U", "p95 ms", "times");
  for (const Row& row : section.rows) {
    const Summary s = Summarise(row.milliseconds);
    char ratio[32] = "-";  // where no frame of OpenCV's was timed in turns
    if (u.count > 0) std::snprintf(ratio, sizeof ratio, "%.3f", s.median / u.median);
    std::printf("  %-44s %10.3f %8s %10.3f %7d  %s\n", row.name.c_str(), s.median, ratio, s.p95,
                s.count, row.note.c_str());
  }
  for (const Table& table : section.tables) {
    std::printf("\n  %s\n", table.name.c_str());
    const bool labels = !table.labels.empty();
    const int width = labels ? 9 : 16, digits = labels ? 2 : 3;
    size_t longest = 24;
    for (const std::string& label : table.labels) longest = std::max(longest, label.size());
    const int label_width = static_cast<int>(longest);
    if (labels) std::printf("  %-*s", label_width, "");
    std::vector<int> widths;
    for (const std::string& column : table.columns) {
      widths.push_back(std::max(width, static_cast<int>(column.size())));
      std::printf("  %*s", widths.back(), column.c_str());
    }
    for (size_t i = 0; i < table.rows.size(); ++i) {
      std::printf("\n");
      if (labels) std::printf("  %-*s", label_width, table.labels[i].c_str());
      for (size_t column = 0; column < widths.size(); ++column) {
        const double value = table.rows[i][column];
        if (value == value) {
          std::printf("  %*.*f", widths[column], digits, value);
        } else {
          std::printf("  %*s", widths[column], "-");
        }
      }
    }
    std::printf("\n  %s\n", table.note.c_str());
  }
}

ordered_json SectionJson(const Section& section) {
  const Summary u = Summarise(section.u_milliseconds);
  ordered_json rows = ordered_json::array();
  for (const Row& row : section.rows) {
    const Summary s = Summarise(row.milliseconds);
    rows.push_back({{"name", row.name},
                    {"median_ms", s.median},
                    {"p95_ms", s.p95},
                    {"median_u", u.count > 0 ? ordered_json(s.median / u.median) : ordered_json()},
                    {"count", s.count},
                    {"note", row.note}});
  }
  ordered_json made = {
      {"name", section.name}, {"u_ms", u.median}, {"u_count", u.count}, {"rows", rows}};
  for (const Table& table : section.tables) {
    made["tables"].push_back({{"name", table.name},
                              {"columns", table.columns},
                              {"rows", table.rows},
                              {"note", table.note}});
    if (!table.labels.empty()) made["tables"].back()["labels"] = table.labels;
  }
  return made;
}

void WriteSections(const std::string& path, ordered_json all, ordered_json sections) {
  if (path.empty()) return;
  all["benches"] = std::move(sections);
  AtomicWriteFile(path, all.dump(2) + "\n");
}

}  // namespace alidade::bench
