#include "alidade/base/log.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/ids.h"

namespace alidade::log_test {
namespace {

TEST(LogWarning, GoesToTheListenerOrStderr) {
  std::vector<std::string> heard;
  SetWarningListener([&](const std::string& message) { heard.push_back(message); });
  LogWarning("frame 7 is empty");
  SetWarningListener(nullptr);
  testing::internal::CaptureStderr();
  LogWarning("frame 8 is empty");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: frame 8 is empty\n");
  EXPECT_EQ(heard, std::vector<std::string>{"frame 7 is empty"});
}

TEST(Error, CarriesTheExitStatus) {
  EXPECT_EQ(static_cast<int>(ErrorKind::kUsage), 2);
  EXPECT_EQ(static_cast<int>(ErrorKind::kInput), 3);
  EXPECT_EQ(static_cast<int>(ErrorKind::kNothingMapped), 4);
  try {
    ThrowInput("no such folder");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    EXPECT_STREQ(error.what(), "no such folder");
  }
}

TEST(Id, IsNothingUntilGiven) {
  EXPECT_FALSE(KeyFrameId().valid());
  EXPECT_TRUE(KeyFrameId{0}.valid());
  EXPECT_LT(LandmarkId{3}, LandmarkId{4});
  EXPECT_EQ(LandmarkId{3}, LandmarkId{3});
}

}  // namespace
}  // namespace alidade::log_test
