// `alidade settings`, and the page made from it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "support/program.h"

namespace alidade::settings_command_test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

json Listed(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "settings");
  arguments.push_back("--json");
  const ProgramResult result = RunAlidade(arguments);
  EXPECT_EQ(result.status, 0) << result.err;
  return json::parse(result.out, nullptr, false);
}

TEST(SettingsCommand, ListsAtMost60PublicSettingsAndAtMost250InAll) {
  const json listed = Listed({}), all = Listed({"--all"});
  EXPECT_LE(listed.size(), 60u);
  EXPECT_GT(all.size(), listed.size());
  EXPECT_LE(all.size(), 250u);
  for (const json& setting : all) {
    const std::string name = setting["name"], meaning = setting["meaning"];
    EXPECT_EQ(setting["public"], !name.starts_with("expert.")) << name;
    EXPECT_FALSE(meaning.empty()) << name;
    EXPECT_EQ(meaning.back(), '.') << name;
  }
}

TEST(SettingsCommand, ShowsAGroupOrOneWithItsUnitAndRange) {
  const ProgramResult one = RunAlidade({"settings", "tracker.min_tracked"});
  EXPECT_EQ(one.status, 0);
  EXPECT_EQ(LineCount(one.out), 2);  // name, value and range; meaning
  EXPECT_THAT(one.out, AllOf(HasSubstr("20"), HasSubstr("at least 6 inliers"), HasSubstr("lost")));
  const ProgramResult group = RunAlidade({"settings", "loop"});
  EXPECT_THAT(group.out, AllOf(HasSubstr("loop.min_found"), HasSubstr("expert.loop.max_turn"),
                               Not(HasSubstr("tracker"))));
}

TEST(SettingsCommand, TakesAtMost100ColumnsForAllButListsOfClasses) {
  std::istringstream lines(RunAlidade({"settings", "--all"}).out);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("_classes") != std::string::npos) continue;
    EXPECT_LE(line.size(), 100u) << line;
  }
}

TEST(SettingsCommand, ShowsValuesInForce) {
  EXPECT_EQ(Listed({"image_width", "--profile", "phone"})[0]["value"], "400");
  const json one = Listed({"loop.min_found", "--set", "loop.min_found=50"});
  EXPECT_EQ(one[0]["value"], "50");
  EXPECT_EQ(one[0]["default"], "45");
  EXPECT_EQ(Listed({"--set", "loop.min_found=50", "--set", "seed=2", "loop.min_found"}), one);
}

TEST(SettingsCommand, AnUnknownNameIsAUsageErrorThatSuggestsOne) {
  const ProgramResult result = RunAlidade({"settings", "loop.min_fond"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("did you mean 'loop.min_found'"));
  EXPECT_THAT(RunAlidade({"settings", "tracker.unproven_frames"}).err,
              HasSubstr("it is now called 'tracker.unconfirmed_frames'"));
  EXPECT_THAT(RunAlidade({"settings", "places.rounds"}).err, HasSubstr("no longer exists"));
}

TEST(SettingsCommand, ThePageInTheDocumentationIsWhatItPrints) {
  const ProgramResult page = RunAlidade({"settings", "--markdown"});
  EXPECT_EQ(page.status, 0);
  EXPECT_TRUE(page.out == ReadText(ALIDADE_DOCS "/reference/settings.md"))
      << "regenerate it: scripts/docs";
}

}  // namespace
}  // namespace alidade::settings_command_test
