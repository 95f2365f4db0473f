// The results of a batch as a table, and their comparison with an earlier batch.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/run/batch/batch_state.h"

namespace alidade {

struct BatchRow {
  std::string name, source, sensor;
  std::string state = "waiting";  // ok, failed, interrupted, or waiting (not run so far)
  std::string message;            // why it failed
  // From the files of the run; empty: unknown.
  std::optional<double> frames, coverage;   // coverage: 0…1
  std::optional<double> ate, rpe, rpe_deg;  // meters; meters and degrees over one second
  std::optional<double> maps, keyframes;
  std::optional<double> ms, ms_p95;  // per frame
  std::optional<double> cpu_s, wall_s, peak_mb;
  bool ok() const { return state == "ok"; }
};

// Row of an item that was run; reads its folder. If the folder cannot be read, the row is a failed
// one.
BatchRow RowOf(const BatchFolder& folder, const BatchItem& item);

std::string BatchJson(const std::vector<BatchRow>& rows);
std::vector<BatchRow> ParseBatchJson(const std::string& text, const std::string& name);
std::string BatchMarkdown(const std::vector<BatchRow>& rows);
std::string BatchText(const std::vector<BatchRow>& rows);  // for a terminal

// From which increase on a figure counts as worse: relative to the earlier value, or in its unit.
struct WorseBy {
  double share = 0, amount = 0;  // the one that is not 0 applies; both 0: never
  bool on() const { return share > 0 || amount > 0; }
};
// Parses "10%", "5mm", "0.02m", "3ms", "2s", "100MB", "1°" or "off". `units`: the accepted units,
// each with its size in the unit of the figure. Throws Error (usage), beginning with `option`.
WorseBy ParseWorseBy(const std::string& option, const std::string& text,
                     const std::vector<std::pair<std::string, double>>& units);

struct WorseSettings {
  WorseBy ate{0.1, 0};  // runs are reproducible to the byte, so 10 % is a change of the method
  WorseBy rpe;          // translation
  WorseBy coverage{0, 0.01};  // one percentage point fewer frames
  WorseBy ms, cpu, memory;    // depend on the machine: off by default
};

// One line for each figure that got worse and each recording that fails but did not before: "desk:
// ATE 0.021 m, was 0.018 m (+17 %)". Recordings of one batch only are skipped, except those that
// had a result before and have none now.
std::vector<std::string> WorseThan(const std::vector<BatchRow>& earlier,
                                   const std::vector<BatchRow>& now, const WorseSettings& settings);

}  // namespace alidade
