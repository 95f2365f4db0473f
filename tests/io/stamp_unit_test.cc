#include "alidade/io/stamp_unit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alidade/io/files/datasets/stamped_list.h"
#include "support/expect_error.h"

namespace alidade::stamp_unit_test {
namespace {

using testing::HasSubstr;

// Stamps of a camera with `period` seconds whose clock shows `begin` seconds at first.
std::vector<double> Stamps(double period, double begin, StampUnit unit) {
  std::vector<double> stamps;
  for (int i = 0; i < 20; ++i) stamps.push_back((begin + i * period) * PerSecond(unit));
  return stamps;
}

TEST(StampUnit, IsFoundForEveryRateAndClock) {
  for (const StampUnit unit : {StampUnit::kSeconds, StampUnit::kMilliseconds,
                               StampUnit::kMicroseconds, StampUnit::kNanoseconds}) {
    for (const double rate : {5.0, 10.0, 30.0, 90.0}) {
      for (const double begin : {0.0, 5000.0, 1.7e9}) {
        EXPECT_EQ(ProbableUnit(Stamps(1 / rate, begin, unit), StampUnit::kSeconds), unit)
            << NameOf(unit) << " " << rate << " Hz from " << begin;
        EXPECT_EQ(ProbableUnit(Stamps(1 / rate, begin, unit), StampUnit::kNanoseconds), unit)
            << NameOf(unit) << " " << rate << " Hz from " << begin;
      }
    }
  }
}

TEST(StampUnit, SlowAndFastRecordingsKeepTheUnitOfTheirFormat) {
  for (const double period : {1 / 1000.0, 0.5, 2.0, 5.0}) {
    EXPECT_EQ(ProbableUnit(Stamps(period, 0, StampUnit::kSeconds), StampUnit::kSeconds),
              StampUnit::kSeconds)
        << period;
  }
  EXPECT_EQ(ProbableUnit({}, StampUnit::kNanoseconds), StampUnit::kNanoseconds);
  const double one[] = {7};
  EXPECT_EQ(ProbableUnit(one, StampUnit::kSeconds), StampUnit::kSeconds);
}

TEST(StampUnit, TextIsConvertedDigitByDigit) {
  EXPECT_EQ(StampInSeconds("1403715273262142976", StampUnit::kNanoseconds), "1403715273.262142976");
  EXPECT_EQ(StampInSeconds("5", StampUnit::kNanoseconds), "0.000000005");
  EXPECT_EQ(StampInSeconds("1000000000", StampUnit::kNanoseconds), "1.000000000");
  EXPECT_EQ(StampInSeconds("20500.25", StampUnit::kMilliseconds), "20.50025");
  EXPECT_EQ(StampInSeconds("-33", StampUnit::kMilliseconds), "-0.033");
  EXPECT_EQ(StampInSeconds("1.5e9", StampUnit::kNanoseconds), "1.500000000");
  EXPECT_EQ(StampInSeconds("1.5e0", StampUnit::kSeconds), "1.5e0");
  EXPECT_EQ(StampInSeconds("nan", StampUnit::kNanoseconds), "nan");
}

TEST(StampUnit, OfAListIsToldWhenItIsNotThatOfTheFormat) {
  WarningCatcher warnings;
  const auto list = ParseStampedList("1403636579000000000 a.png\n1403636579033000000 b.png\n",
                                     "rgb.txt", StampUnit::kSeconds, true, FindUnit::kYes);
  EXPECT_EQ(list.at(1).stamp, "1403636579.033000000");
  EXPECT_NEAR(list.at(1).time - list.at(0).time, 0.033, 1e-6);
  EXPECT_THAT(warnings.text(), HasSubstr("rgb.txt: the time stamps are read as nanoseconds, one "
                                         "image every 0.033 s"));
  WarningCatcher quiet;
  EXPECT_EQ(ParseStampedList("0.5 a.png\n0.6 b.png\n", "rgb.txt", StampUnit::kSeconds, true,
                             FindUnit::kYes)
                .at(1)
                .stamp,
            "0.6");
  EXPECT_EQ(quiet.text(), "");
}

}  // namespace
}  // namespace alidade::stamp_unit_test
