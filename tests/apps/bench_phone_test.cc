// `alidade bench phone`: that its tables say what was run. How fast that was is for
// docs/benchmarks/speed.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "support/program.h"

namespace alidade::bench_phone_test {
namespace {

using nlohmann::json;

const json* TableNamed(const json& section, const std::string& words) {
  for (const json& table : section["tables"])
    if (table["name"].get<std::string>().find(words) != std::string::npos) return &table;
  return nullptr;
}

TEST(BenchPhone, HasTheTablesOfThePaperWithErrorAndCoverageBesideThem) {
  const TempFolder folder;
  const std::string out = folder / "phone.json";
  const ProgramResult result =
      RunAlidade({"bench", "phone", "synth:desk?frames=40&width=480&height=360", "--out", out});
  ASSERT_EQ(result.status, 0) << result.err;
  const json all = json::parse(ReadText(out), nullptr, false);
  ASSERT_EQ(all["benches"].size(), 2u);

  const json* parts = TableNamed(all["benches"][0], "median ms of each part");
  ASSERT_NE(parts, nullptr);
  const std::vector<std::string> columns = (*parts)["columns"];
  const auto column = [&](const std::string& name) {
    return static_cast<size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
  };
  // Four steps of parameters and two schedules of two of them at least; WASM where it was built.
  const std::vector<std::string> labels = (*parts)["labels"];
  EXPECT_GE(labels.size(), 6u);
  EXPECT_EQ(labels[0], "full size, 1000 features");
  const bool wasm = std::any_of(labels.begin(), labels.end(), [](const std::string& label) {
    return label.rfind("WASM", 0) == 0;
  });
  EXPECT_NE(wasm, (*parts)["note"].get<std::string>().find("left out") != std::string::npos);
  for (size_t i = 0; i < labels.size(); ++i) {
    const json& row = (*parts)["rows"][i];
    for (const char* name : {"extract", "track", "frame", "mean"})
      EXPECT_GT(row[column(name)].get<double>(), 0) << labels[i];
    const bool live = labels[i].find("live") != std::string::npos;
    if (live) continue;  // what a busy machine leaves out is not the program's to say
    EXPECT_GE(row[column("frame")].get<double>(), row[column("extract")].get<double>())
        << labels[i];
    EXPECT_LT(row[column("ATE cm")].get<double>(), 5) << labels[i];
    EXPECT_GT(row[column("cover %")].get<double>(), 80) << labels[i];
    EXPECT_GE(row[column("keyframes")].get<double>(), 2) << labels[i];
  }
  // Loops on more threads change no pose: the error is the same to the last digit.
  for (size_t i = 0; i < labels.size(); ++i) {
    if (labels[i].find("loops on") == std::string::npos) continue;
    const size_t serial = labels[i].rfind("full", 0) == 0 ? 0 : 3;
    EXPECT_EQ((*parts)["rows"][i][column("ATE cm")], (*parts)["rows"][serial][column("ATE cm")]);
  }

  const json* whole = TableNamed(all["benches"][0], "Whole frame");
  ASSERT_NE(whole, nullptr);
  EXPECT_EQ((*whole)["rows"][0][4], 1134);
  EXPECT_EQ((*whole)["rows"][1][4], 513);
  EXPECT_EQ((*whole)["rows"][2][4], 175);
  EXPECT_EQ((*whole)["rows"][0][1], 1);

  std::string ransac;
  for (const json& row : all["benches"][1]["rows"]) ransac += row["name"].get<std::string>() + "\n";
  EXPECT_NE(ransac.find("RANSAC of H and F, serial"), std::string::npos) << ransac;
}

TEST(BenchPhone, RefusesWhatIsNoRecording) {
  const ProgramResult result = RunAlidade({"bench", "phone", "no-such-folder"});
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(LineCount(result.err), 1) << result.err;
}

}  // namespace
}  // namespace alidade::bench_phone_test
