// `alidade bench semidense`: that it measures what it says it measures; how long that takes is
// nobody's to assert.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"
#include "support/rendered.h"

namespace alidade::bench_semidense_test {
namespace {

using nlohmann::json;

class BenchSemiDense : public testing::Test {
 protected:
  json Bench(std::vector<std::string> words) {
    words.insert(words.begin(), {"bench", "semidense"});
    words.insert(words.end(), {"--out", out_});
    const ProgramResult result = RunAlidade(words);
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(ReadText(out_), nullptr, false);
  }
  // The figure of one row; the row must be there once.
  static double Figure(const json& table, const std::string& label, const std::string& column) {
    const auto index = [&](const char* list, const std::string& name) {
      const auto words = table[list].get<std::vector<std::string>>();
      EXPECT_EQ(std::count(words.begin(), words.end(), name), 1) << name;
      return static_cast<size_t>(std::find(words.begin(), words.end(), name) - words.begin());
    };
    return table["rows"][index("labels", label)][index("columns", column)].get<double>();
  }

  TempFolder folder_;
  std::string out_ = folder_ / "bench.json";
};

TEST_F(BenchSemiDense, GivesARowForEachStepAndEachNumberOfKeyframes) {
  const json all = Bench({"synth:desk?width=320&height=240&fps=20", "--frames", "30"});
  ASSERT_EQ(all["benches"].size(), 1u);
  const json& tables = all["benches"][0]["tables"];
  ASSERT_EQ(tables.size(), 2u);  // exact truth: no second set of pixels
  const json& steps = tables[0];
  for (const char* label :
       {"all steps, N = 7", "without fusion (2)", "without smoothing (3)", "without the check (4)",
        "N = 3", "N = 5", "N = 10", "phone profile", "RGB-D map", "RGB-D map, sensor's"}) {
    const double median = Figure(steps, label, "median %");
    EXPECT_GT(median, 0) << label;
    EXPECT_LT(median, 50) << label;
  }
  // What is known whatever the figures are: each step costs or removes something.
  const auto default_figure = [&](const char* column) {
    return Figure(steps, "all steps, N = 7", column);
  };
  EXPECT_GT(Figure(steps, "without the check (4)", "density %"), default_figure("density %"));
  EXPECT_GT(Figure(steps, "N = 10", "searches"), Figure(steps, "N = 3", "searches"));
  EXPECT_EQ(Figure(steps, "RGB-D map, sensor's", "searches"), 0);
  EXPECT_LE(default_figure("density %"), 100);
  EXPECT_GT(default_figure("pixels"), 0);
  EXPECT_GT(default_figure("MB"), 0.1);
  EXPECT_LT(default_figure("pixels"), 320 * 240);

  const json& live = tables[1];
  for (const char* label : {"round 1", "round 2", "round 3", "median"}) {
    EXPECT_GT(Figure(live, label, "ratio"), 0) << label;
    EXPECT_GE(Figure(live, label, "behind"), 0) << label;
  }
}

TEST_F(BenchSemiDense, SaysWhatItCannotDo) {
  const ProgramResult alone = RunAlidade({"bench", "features", "semidense"});
  EXPECT_EQ(alone.status, 2);
  EXPECT_EQ(LineCount(alone.err), 1) << alone.err;
  const ProgramResult nothing = RunAlidade({"bench", "semidense", folder_ / "nowhere"});
  EXPECT_EQ(nothing.status, 3);
  EXPECT_EQ(LineCount(nothing.err), 1) << nothing.err;
}

}  // namespace
}  // namespace alidade::bench_semidense_test
