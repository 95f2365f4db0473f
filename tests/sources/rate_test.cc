// How fast frames are played.
#include <gtest/gtest.h>

#include "alidade/base/error.h"
#include "alidade/run/setup/options.h"

namespace alidade {
namespace {

Rate::Kind KindOf(const char* rate, bool threaded, bool live) {
  RunOptions options;
  if (rate != nullptr) options.rate = rate;
  return RateFrom(options, threaded, live).kind;
}

TEST(PlaybackRate, IsThatOfTheTimeStampsWhereStagesAreThreaded) {
  EXPECT_EQ(KindOf(nullptr, true, false), Rate::Kind::kRealtime);
  EXPECT_EQ(KindOf(nullptr, false, false), Rate::Kind::kMax);
  EXPECT_EQ(KindOf("realtime", false, false), Rate::Kind::kRealtime);
}

// A clock of the camera that runs 20 ppm fast would delay images by 1.7 s after a day.
TEST(PlaybackRate, OfLiveImagesNeverWaitsForTheirTimeStamps) {
  EXPECT_EQ(KindOf(nullptr, true, true), Rate::Kind::kMax);
  EXPECT_EQ(KindOf("realtime", true, true), Rate::Kind::kMax);
  EXPECT_EQ(KindOf("5", true, true), Rate::Kind::kFixed);  // as asked
}

TEST(PlaybackRate, RefusesOthers) {
  for (const char* rate : {"fast", "0", "-3", "nan"})
    EXPECT_THROW(KindOf(rate, true, false), Error) << rate;
}

}  // namespace
}  // namespace alidade
