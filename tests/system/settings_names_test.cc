// Settings by name: printed values can be read back, and thresholds have limits.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "alidade/system/settings.h"
#include "support/expect_error.h"

namespace alidade::settings_names_test {
namespace {

using testing::HasSubstr;

TEST(SettingNames, WhatIsPrintedIsReadBackTheSame) {
  const SlamSettings settings;
  SlamSettings again;
  for (const auto& [name, value] : settings.All()) again.Set(name, value);
  EXPECT_EQ(again.All(), settings.All());
  again.Set("expert.dynamics.surfaces.forget", "0.123456789");  // more digits than a float has
  SlamSettings third;
  for (const auto& [name, value] : again.All()) third.Set(name, value);
  EXPECT_EQ(third.dynamics.surfaces.forget, again.dynamics.surfaces.forget);
}

TEST(SettingNames, ValuesArePrintedAsTheyAreWritten) {
  for (const auto& [name, value] : SlamSettings().All()) {
    if (name == "dynamics.moving_classes" || name == "dynamics.carried_classes") continue;
    EXPECT_LT(value.size(), 9u) << name << " " << value;  // 0.3, not 0.3000000119
  }
}

TEST(SettingNames, EveryNumberWithARangeIsHeldToIt) {
  int checked = 0;
  for (const SettingsPart& part : SlamSettings().Parts()) {
    for (const Setting& row : part.table) {
      if (row.words != nullptr || row.range.max > 1e9) continue;
      const bool number = row.type != SettingType::kBool && row.type != SettingType::kText;
      for (const char* beyond : {"1000000000", "-1000000000"}) {
        if (!number) continue;
        ++checked;
        SlamSettings settings;
        settings.Set(FullName(row), beyond);
        EXPECT_THAT(ComplaintAbout(settings), HasSubstr("setting " + FullName(row) + " must be "))
            << beyond;
      }
    }
  }
  EXPECT_GT(checked, 100);
}

// An old name sets the field of the new one and warns.
TEST(SettingNames, NamesOfTheLastVersionAreAcceptedWithAWarning) {
  WarningCatcher warnings;
  SlamSettings settings;
  settings.Set("tracker.unproven_frames", "3");
  EXPECT_EQ(settings.tracker.unconfirmed_frames, 3);
  EXPECT_THAT(warnings.text(), HasSubstr("now called expert.tracker.unconfirmed_frames"));
  settings.Set("loop.score_share", "0.3");
  EXPECT_EQ(settings.loop.score_share, 0.3);
  EXPECT_THAT(warnings.text(), HasSubstr("now called expert.loop.score_share"));
  settings.Set("early.most", "7");
  EXPECT_EQ(settings.early.max_frames, 7);
  EXPECT_THAT(warnings.text(), HasSubstr("now called early.max_frames"));
  const auto before = settings.All();
  settings.Set("dynamics.box.oval", "3");
  EXPECT_THAT(warnings.text(), HasSubstr("dynamics.box.oval no longer exists"));
  EXPECT_EQ(settings.All(), before);
}

TEST(SettingNames, CurrentNamesDoNotWarn) {
  WarningCatcher warnings;
  SlamSettings settings;
  for (const auto& [name, value] : settings.All()) settings.Set(name, value);
  EXPECT_EQ(warnings.text(), "");
}

TEST(SettingNames, AQuantityOfSeveralStagesIsSetInAllOfThem) {
  SlamSettings settings;
  settings.Set("expert.match_scale", "0.5");
  for (double scale : {settings.tracker.match_scale, settings.mapper.match_scale,
                       settings.loop.match_scale, settings.start.match_scale})
    EXPECT_EQ(scale, 0.5);
  settings.Set("expert.noise.mapping_sigma", "0.7");
  EXPECT_EQ(settings.mapper.noise.sigma_px, 0.7);
  EXPECT_EQ(settings.loop.noise.sigma_px, 0.7);
  EXPECT_EQ(settings.tracker.noise.sigma_px, 1);  // another quantity
}

// Rows that share a name must agree, or setting one would not be setting the same.
TEST(SettingNames, RowsOfOneNameHaveOneDefaultAndType) {
  SlamSettings settings;
  std::map<std::string, std::pair<std::string, SettingType>> known;
  for (const SettingsPart& part : settings.Parts()) {
    for (const Setting& row : part.table) {
      const std::pair now(FormatValue(row, part.settings), row.type);
      const auto [found, is_new] = known.insert({row.name, now});
      EXPECT_EQ(found->second, now) << row.name;
    }
  }
}

TEST(SettingNames, AnUnknownNameIsReportedWithTheNearestFullName) {
  SlamSettings settings;
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { settings.Set("loop.score_shar", "1"); }),
              HasSubstr("did you mean 'expert.loop.score_share'"));
}

TEST(SettingNames, WordsAndSwitchesAreParsed) {
  SlamSettings settings;
  settings.Set("dynamics.mode", "geometry");
  EXPECT_EQ(settings.dynamics.mode, DynamicsMode::kGeometry);
  settings.Set("loop.enabled", "false");
  EXPECT_FALSE(settings.loop.enabled);
  settings.Set("loop.enabled", "1");
  EXPECT_TRUE(settings.loop.enabled);
  MessageOf(ErrorKind::kUsage, [&] { settings.Set("loop.enabled", "2"); });
  MessageOf(ErrorKind::kUsage, [&] { settings.Set("dynamics.mode", "geometri"); });
}

}  // namespace
}  // namespace alidade::settings_names_test
