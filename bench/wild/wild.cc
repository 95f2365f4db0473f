#include "bench/wild/wild.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>

#include "alidade/run/setup/options.h"
#include "bench/measure/result_file.h"
#include "bench/wild/run.h"
#include "program/terminal.h"

namespace alidade::bench {
namespace {

struct WildRow {
  WildCase of;
  std::vector<WildRun> runs;
};

std::string Text(const char* format, double value) {
  if (!std::isfinite(value)) return "–";
  char text[40];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

std::string Number(int value) { return value < 0 ? "–" : std::to_string(value); }

// The same of every run, side by side.
std::string Each(const WildRow& row, const std::function<std::string(const WildRun&)>& of) {
  std::string text;
  for (const WildRun& run : row.runs) text += (text.empty() ? "" : " ") + of(run);
  return text;
}

void PrintWildHead() {
  std::printf(
      "| case | start | coverage %% | maps | false poses | ATE cm | ATE %% of path | scale drift | "
      "most without a pose |\n|---|---|---|---|---|---|---|---|---|\n");
}

void PrintWild(const WildRow& row) {
  const auto each = [&](const std::function<std::string(const WildRun&)>& of) {
    std::printf(" %s |", Each(row, of).c_str());
  };
  std::printf("| %s |", row.of.name.c_str());
  each([](const WildRun& run) { return Number(run.start); });
  // Where there should be no map: the tracked frames.
  each([&](const WildRun& run) {
    if (row.of.map) return Text("%.0f", 100 * run.coverage);
    return "(" + std::to_string(run.tracked) + " of " + std::to_string(run.frames) + ")";
  });
  each([](const WildRun& run) { return std::to_string(run.maps); });
  each([](const WildRun& run) {
    return std::to_string(run.false_poses) + (run.false_maps > 0 ? "!" : "");
  });
  each([](const WildRun& run) { return Text("%.1f", run.ate_cm); });
  each([](const WildRun& run) { return Text("%.2f", run.ate_percent); });
  each([](const WildRun& run) { return Text("%.2f", run.scale_drift); });
  std::vector<std::string> reasons;
  for (const WildRun& run : row.runs) {
    if (!run.reason.empty() &&
        std::find(reasons.begin(), reasons.end(), run.reason) == reasons.end())
      reasons.push_back(run.reason);
  }
  std::string why;
  for (const std::string& reason : reasons) why += (why.empty() ? "" : "; ") + reason;
  std::printf(" %s |\n", why.c_str());
  std::fflush(stdout);
}

struct WildTotals {
  int runs = 0, false_poses = 0, false_maps = 0, several_maps = 0, without = 0;
  std::vector<double> coverage;
};

WildTotals Sum(const std::vector<WildRow>& rows) {
  WildTotals sum;
  for (const WildRow& row : rows) {
    for (const WildRun& run : row.runs) {
      ++sum.runs;
      sum.false_poses += run.false_poses;
      sum.false_maps += run.false_maps;
      if (!row.of.map) continue;
      sum.several_maps += run.maps > 1;
      sum.without += run.maps == 0;
      if (std::isfinite(run.coverage)) sum.coverage.push_back(run.coverage);
    }
  }
  return sum;
}

void PrintWild(const WildTotals& sum) {
  std::printf(
      "\n%d runs: %d false poses, %d false maps, %d without the map there should be, %d in "
      "more than one map",
      sum.runs, sum.false_poses, sum.false_maps, sum.without, sum.several_maps);
  if (!sum.coverage.empty()) {
    std::vector<double> sorted = sum.coverage;
    std::sort(sorted.begin(), sorted.end());
    std::printf("; coverage %.1f %% in the median, %.1f %% at least",
                100 * sorted[sorted.size() / 2], 100 * sorted.front());
  }
  std::printf("\n");
}

Section WildSection(const std::vector<WildRow>& rows) {
  Table table{"wild",
              {{"map_expected"},
               {"usable"},
               {"start"},
               {"tracked"},
               {"coverage", "%"},
               {"maps"},
               {"false_poses"},
               {"false_maps"},
               {"ate_rmse", "cm"},
               {"ate_of_path", "%"},
               {"scale_drift"},
               {"frame", "ms"}}};
  const auto number = [](int value) { return static_cast<double>(value); };
  for (const WildRow& row : rows) {
    for (const WildRun& run : row.runs) {
      Case of{row.of.name, "mono", row.of.profile, row.of.source};
      of.frames = run.frames;
      of.seed = static_cast<int>(run.seed);
      table.lines.push_back(
          {std::move(of),
           {row.of.map ? 1.0 : 0.0, number(run.usable), number(run.start), number(run.tracked),
            100 * run.coverage, number(run.maps), number(run.false_poses), number(run.false_maps),
            run.ate_cm, run.ate_percent, run.scale_drift, run.milliseconds},
           run.reason});
    }
  }
  return {"wild", {}, {}, {std::move(table)}};
}

}  // namespace

int BenchWild(const WildOptions& options) {
  const std::vector<WildCase> cases = WildCases(options.cases);
  Terminal terminal(false);
  std::vector<WildRow> rows;
  PrintWildHead();
  for (const WildCase& each : cases) {
    rows.push_back({each, {}});
    WildCase& of = rows.back().of;
    if (!options.profile.empty()) of.profile = options.profile;
    RunOptions run;
    run.profile = of.profile;
    run.settings = options.settings;
    const SlamSettings settings = SettingsFrom(run).slam;
    for (int seed = 1; seed <= options.seeds; ++seed) {
      const auto progress = [&](int frames) {
        if (frames % 10 != 1) return;
        terminal.SetProgress("case " + std::to_string(rows.size()) + " of " +
                             std::to_string(cases.size()) + ", " + of.name + ", seed " +
                             std::to_string(seed) + " of " + std::to_string(options.seeds) +
                             ": frame " + std::to_string(frames));
      };
      rows.back().runs.push_back(
          RunWild(of, static_cast<uint64_t>(seed), options.frames, settings, progress));
    }
    terminal.SetProgress("");
    PrintWild(rows.back());
  }
  const WildTotals sum = Sum(rows);
  PrintWild(sum);
  WriteResult(options.out, "wild", {WildSection(rows)});
  return options.check && sum.false_poses + sum.false_maps > 0 ? 1 : 0;
}

}  // namespace alidade::bench
