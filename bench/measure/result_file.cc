#include "bench/measure/result_file.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/file.h"
#include "bench/measure/commit.h"

namespace alidade::bench {
namespace {

using nlohmann::ordered_json;

std::string Today() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", &utc);
  return text;
}

std::string Processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos)
      return line.substr(colon + 2);
  }
  return "unknown";
}

ordered_json RowOf(const Case& of, const Column& column, double value, const std::string& note) {
  ordered_json row = {
      {"case", of.name}, {"sensor", of.sensor}, {"profile", of.profile}, {"metric", column.metric}};
  row["value"] = std::isfinite(value) ? ordered_json(value) : nullptr;
  row["unit"] = column.unit;
  row["frames"] = of.frames > 0 ? ordered_json(of.frames) : nullptr;
  if (of.seed > 0) row["seed"] = of.seed;
  if (!of.source.empty()) row["source"] = of.source;
  if (!of.variant.empty()) row["variant"] = of.variant;
  if (!note.empty()) row["note"] = note;
  return row;
}

// One line for each row, so that a diff shows which figures changed.
std::string LineByLine(const ordered_json& head, const ordered_json& rows) {
  std::string text = head.dump(1);
  text.erase(text.rfind('}') - 1);  // and the line break before it
  text += ",\n \"rows\": [";
  for (size_t i = 0; i < rows.size(); ++i) text += (i > 0 ? ",\n  " : "\n  ") + rows[i].dump();
  return text + "\n ]\n}\n";
}

void AddRows(const Section& section, ordered_json& rows) {
  const Summary u = Summarise(section.u_milliseconds);
  for (const Timing& timing : section.timings) {
    const Summary s = Summarise(timing.milliseconds);
    rows.push_back(RowOf(timing.of, {"median", "ms"}, s.median, timing.note));
    if (s.count > 1) rows.push_back(RowOf(timing.of, {"p95", "ms"}, s.p95, timing.note));
    if (u.count > 0)
      rows.push_back(RowOf(timing.of, {"median", "U"}, s.median / u.median, timing.note));
  }
  for (const Table& table : section.tables) {
    for (const Line& line : table.lines) {
      for (size_t i = 0; i < table.columns.size(); ++i)
        rows.push_back(RowOf(line.of, table.columns[i], line.values[i], line.note));
    }
  }
}

}  // namespace

void WriteResult(const std::string& path, const std::string& benchmark,
                 const std::vector<Section>& sections) {
  if (path.empty()) return;
  ordered_json rows = ordered_json::array();
  std::vector<double> u;
  for (const Section& section : sections) {
    AddRows(section, rows);
    u.insert(u.end(), section.u_milliseconds.begin(), section.u_milliseconds.end());
  }
  const ordered_json head = {
      {"benchmark", benchmark},
      {"commit", kCommit},
      {"date", Today()},
      {"machine", {{"cpu", Processor()}, {"cores", std::thread::hardware_concurrency()}}},
      {"threads", ThreadCount()},
      {"u_ms", u.empty() ? ordered_json() : ordered_json(Summarise(u).median)}};
  AtomicWriteFile(path, LineByLine(head, rows));
}

}  // namespace alidade::bench
