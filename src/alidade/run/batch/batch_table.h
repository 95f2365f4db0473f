// What came out of a batch, as a table; and whether it is worse than an earlier one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/run/batch/batch_state.h"

namespace alidade {

struct BatchRow {
  std::string name, source, sensor;
  std::string state = "waiting";  // ok, failed, interrupted, waiting (not run so far)
  std::string message;            // why it failed
  // Of the run's own files; empty: not known.
  std::optional<double> frames, coverage;   // coverage: 0…1
  std::optional<double> ate, rpe, rpe_deg;  // metres; metres and degrees over one second
  std::optional<double> maps, keyframes;
  std::optional<double> ms, ms_p95;  // per frame
  std::optional<double> cpu_s, wall_s, peak_mb;
  bool ok() const { return state == "ok"; }
};

// Of an item that is done, or was tried: reads its folder. A folder that cannot be read makes the
// row a failed one.
BatchRow RowOf(const BatchFolder& folder, const BatchItem& item);

std::string BatchJson(const std::vector<BatchRow>& rows);
std::vector<BatchRow> ParseBatchJson(const std::string& text, const std::string& name);
std::string BatchMarkdown(const std::vector<BatchRow>& rows);
std::string BatchText(const std::vector<BatchRow>& rows);  // for a terminal

// From how much more on a figure is worse: by a share of the earlier one, or in its unit.
struct WorseBy {
  double share = 0, amount = 0;  // the one that is not 0 holds; both 0: never
  bool on() const { return share > 0 || amount > 0; }
};
// "10%", "5mm", "0.02m", "3ms", "2s", "100MB", "1°"; "off". `units`: those that may be, each with
// what one is in the figure's own. Throws Error (usage), beginning with `option`.
WorseBy ParseWorseBy(const std::string& option, const std::string& text,
                     const std::vector<std::pair<std::string, double>>& units);

struct WorseSettings {
  WorseBy ate{0.1, 0};        // runs are the same bytes each time: a tenth is a change of method
  WorseBy rpe;                // translation
  WorseBy coverage{0, 0.01};  // less by a point (1 % of the frames)
  WorseBy ms, cpu, memory;    // depend on the machine: only when asked for
};

// A line for each figure that got worse, or recording that fails and did not: "desk: ATE 0.021 m,
// was 0.018 m (+17 %)". Recordings that only one of them has are passed over, unless nothing was
// made of one that had been.
std::vector<std::string> WorseThan(const std::vector<BatchRow>& earlier,
                                   const std::vector<BatchRow>& now, const WorseSettings& settings);

}  // namespace alidade
