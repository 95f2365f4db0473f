// Settings no run can mean, which took all memory or came to a failed assertion of OpenCV.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/program.h"

namespace alidade::settings_limits_test {
namespace {

using testing::HasSubstr;

TEST(SettingsLimits, NumbersBeyondUseAreUsageErrorsThatNameTheSetting) {
  for (const std::string name : {"features", "cell", "iterations"}) {
    const std::string setting = name == "iterations" ? "expert.start.iterations"
                                : name == "cell"     ? "expert.tracker.extractor.cell"
                                                     : "tracker.extractor." + name;
    const ProgramResult result =
        RunAlidade({"run", "synth:room?frames=2", "--set", setting + "=2147483647"});
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_THAT(result.err, HasSubstr(name + " must be from "));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
  }
}

}  // namespace
}  // namespace alidade::settings_limits_test
