// `alidade compare`: several runs on one page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"

namespace alidade::compare_command_test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string Printed(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

// Cells of the two runs.
std::string Cells(const std::string& deep, const std::string& single) {
  return "<td class=\"run0\" data-run=\"deep\">" + deep +
         "</td><td class=\"run1\" data-run=\"single\">" + single + "</td>";
}

double Rmse(const std::string& result, const std::string& align) {
  const ProgramResult ate = RunAlidade(
      {"evaluate", "ate", result + "/groundtruth.txt", result, "--align", align, "--json"});
  EXPECT_EQ(ate.status, 0) << ate.err;
  return nlohmann::json::parse(ate.out)["rmse"].get<double>();
}

class CompareCommand : public testing::Test {
 protected:
  // Two rendered runs, made once: one with a depth camera, one with a single camera.
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    const std::string source = "synth:desk?frames=60&width=320&height=240";
    ASSERT_EQ(RunAlidade({"run", source, "--sensor", "rgbd", "--out", *folder_ / "deep"}).status,
              0);
    ASSERT_EQ(RunAlidade({"run", source, "--sensor", "mono", "--out", *folder_ / "single"}).status,
              0);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static ProgramResult Compare(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "compare");
    return RunAlidade(arguments);
  }
  static TempFolder* folder_;
  const std::string deep_ = *folder_ / "deep", single_ = *folder_ / "single";
};
TempFolder* CompareCommand::folder_ = nullptr;

TEST_F(CompareCommand, PageNamesBothAndNeedsNothingElse) {
  const std::string out = *folder_ / "both.html";
  const ProgramResult result = Compare({deep_, single_ + "/", "--out", out});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string page = ReadText(out);
  EXPECT_THAT(page, HasSubstr("</span>deep</th>"));
  EXPECT_THAT(page, HasSubstr("</span>single</th>"));
  for (const char* outside :
       {"http:", "https:", "src=", "href=", "@import", "url(", "<script", "nan", "inf<"}) {
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  }
  // Paths from above and from the side, the truth with them; errors over time.
  for (const char* drawn : {"class=\"curve run0\"", "class=\"curve run1\"", "class=\"truth\"",
                            "distance to the ground truth over time", "paths from the side"}) {
    EXPECT_THAT(page, HasSubstr(drawn));
  }
}

TEST_F(CompareCommand, ErrorsAreThoseOfEvaluate) {
  const std::string out = *folder_ / "errors.html";
  ASSERT_EQ(Compare({deep_, single_, "--out", out}).status, 0);
  EXPECT_THAT(ReadText(out),
              HasSubstr("ATE RMSE</th>" + Cells(Printed("%.6f m", Rmse(deep_, "se3")),
                                                Printed("%.6f m", Rmse(single_, "sim3")))));
}

TEST_F(CompareCommand, WithoutTruthPathsAreLaidOnTheFirst) {
  for (const char* name : {"deep", "single"}) {
    const std::string copy = *folder_ / (std::string("bare/") + name);
    std::filesystem::create_directories(copy);
    for (const char* file : {"stats.json", "trajectory.txt"})
      std::filesystem::copy((*folder_ / name) + "/" + file, copy + "/" + file);
  }
  const std::string out = *folder_ / "bare.html";
  ASSERT_EQ(Compare({*folder_ / "bare/deep", *folder_ / "bare/single", "--out", out}).status, 0);
  const std::string page = ReadText(out);
  EXPECT_THAT(page, HasSubstr("class=\"curve run1\""));
  EXPECT_THAT(page, HasSubstr("ATE RMSE</th>" + Cells("–", "–")));
  EXPECT_THAT(page, Not(HasSubstr("class=\"truth\"")));
}

// In the room's own coordinates: they say nothing about the desk's.
TEST_F(CompareCommand, DifferentPlacesAreDrawnSideBySide) {
  const std::string room = *folder_ / "room";
  ASSERT_EQ(RunAlidade({"run", "synth:room?frames=20&width=320&height=240", "--sensor", "rgbd",
                        "--out", room})
                .status,
            0);
  const std::string out = *folder_ / "places.html";
  ASSERT_EQ(Compare({deep_, room, single_, "--out", out}).status, 0);
  const std::string page = ReadText(out);
  EXPECT_THAT(page, HasSubstr("different places"));
  std::vector<std::string> figures;
  for (size_t at = page.find("<figure>"); at != std::string::npos;
       at = page.find("<figure>", at + 1))
    figures.push_back(page.substr(at, page.find("</figure>", at) - at));
  ASSERT_EQ(figures.size(), 4u);  // two places, from above and from the side
  for (size_t i = 0; i < figures.size(); ++i) {
    const bool of_desk = i % 2 == 0;
    EXPECT_EQ(figures[i].find("class=\"curve run0\"") != std::string::npos, of_desk);
    EXPECT_EQ(figures[i].find("class=\"curve run1\"") != std::string::npos, !of_desk);
    EXPECT_EQ(figures[i].find("class=\"curve run2\"") != std::string::npos, of_desk);
    EXPECT_THAT(figures[i], HasSubstr("class=\"truth\""));
  }
}

TEST_F(CompareCommand, RunsInWhichNothingWasMappedAreShownToo) {
  folder_->Write("dark/stats.json", R"({"frames": 5, "tracked": 0, "span": [0, 1], "ms": 3})");
  const std::string out = *folder_ / "dark.html";
  ASSERT_EQ(Compare({*folder_ / "dark", deep_, "--out", out}).status, 0);
  EXPECT_THAT(ReadText(out), HasSubstr("dark: nothing was mapped"));
}

TEST_F(CompareCommand, WhatCannotBeComparedIsOneLine) {
  struct Case {
    std::vector<std::string> arguments;
    int status;
    std::string words;
  };
  folder_->Write("empty/notes.txt", "no run");
  folder_->Write("other/stats.json", R"({"players": 11})");
  const std::string out = *folder_ / "no.html";
  const std::vector<Case> cases = {
      {{deep_, "--out", out}, 2, "two results"},
      {{deep_, *folder_ / "empty", "--out", out}, 3, "no stats.json in " + (*folder_ / "empty")},
      {{deep_, *folder_ / "other", "--out", out}, 3, "other/stats.json was not written by"},
      {{deep_, *folder_ / "nowhere", "--out", out}, 3, "nowhere"},
      {{deep_, single_, "--out", *folder_ / "no/such/page.html"}, 3, "no/such/page.html"},
      {{deep_, single_, "--out", *folder_ / "empty"}, 3, "empty"}};
  for (const Case& bad : cases) {
    const ProgramResult result = Compare(bad.arguments);
    EXPECT_EQ(result.status, bad.status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(bad.words));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST_F(CompareCommand, ReportOfARenderedRunTellsItsErrors) {
  const std::string report = ReadText(deep_ + "/report.html");
  EXPECT_THAT(report, HasSubstr("From the side"));
  EXPECT_THAT(report, HasSubstr(Printed("%.6f m", Rmse(deep_, "se3"))));
  EXPECT_THAT(report, HasSubstr("distance to the ground truth over time"));
}

}  // namespace
}  // namespace alidade::compare_command_test
