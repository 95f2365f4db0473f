// Runs alidade-bench, and finds figures in what it wrote.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"

namespace alidade {

inline ProgramResult RunBench(const std::vector<std::string>& arguments) {
  return RunProgram(ALIDADE_BENCH_BINARY, arguments);
}

// The file of `alidade-bench WORDS… --out FILE`, which must succeed.
inline nlohmann::json BenchResult(std::vector<std::string> words) {
  const TempFolder folder;
  words.insert(words.end(), {"--out", folder / "bench.json"});
  const ProgramResult result = RunBench(words);
  EXPECT_EQ(result.status, 0) << result.err;
  return nlohmann::json::parse(ReadText(folder / "bench.json"), nullptr, false);
}

// What a row has to match: empty and 0 match all that have none of it.
struct Figure {
  std::string name, metric, sensor = "", unit = "";
  int seed = 0;
};

// The row of a figure; it must be there once. An empty unit matches any.
inline nlohmann::json RowOf(const nlohmann::json& result, const Figure& figure) {
  nlohmann::json found;
  for (const nlohmann::json& row : result["rows"]) {
    if (row["case"] != figure.name || row["metric"] != figure.metric ||
        row["sensor"] != figure.sensor || row.value("seed", 0) != figure.seed)
      continue;
    if (!figure.unit.empty() && row["unit"] != figure.unit) continue;
    EXPECT_TRUE(found.is_null()) << row;
    found = row;
  }
  EXPECT_FALSE(found.is_null()) << figure.name << ", " << figure.metric;
  return found;
}

// NaN where nothing could be measured.
inline double ValueOf(const nlohmann::json& result, const Figure& figure) {
  const nlohmann::json row = RowOf(result, figure);
  return row.is_object() && row["value"].is_number() ? row["value"].get<double>() : std::nan("");
}

}  // namespace alidade
