// Settings by name: printed values can be read back, and thresholds have limits.
#include <gtest/gtest.h>

#include <string>

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
  again.Set("dynamics.surfaces.forget", "0.123456789");  // more digits than a float has
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

// Of all settings named dynamics.PART.FIELD.
TEST(SettingNames, EveryThresholdOfDynamicsHasEndsAndIsNamedBeyondThem) {
  int thresholds = 0;
  for (const auto& [name, value] : SlamSettings().All()) {
    if (name.rfind("dynamics.", 0) != 0 || name.find('.', 9) == std::string::npos) continue;
    ++thresholds;
    for (const char* beyond : {"1000000000", "-1000000000"}) {
      SlamSettings settings;
      settings.Set(name, beyond);
      EXPECT_THAT(ComplaintAbout(settings), HasSubstr(name.substr(name.rfind('.') + 1)))
          << name << " " << beyond;
    }
  }
  EXPECT_GT(thresholds, 90);
}

}  // namespace
}  // namespace alidade::settings_names_test
