#include "alidade/inertial/imu_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "alidade/base/random.h"

namespace alidade::imu_stream_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A hand that sways: all axes move.
ImuSample Swaying(double t) {
  return {t,
          {std::sin(2 * t), 0.7 * std::cos(3 * t), 0.5 * std::sin(t + 1)},
          {0.5 * std::sin(4 * t), 9.81 + 0.3 * std::cos(5 * t), 1.5 * std::cos(2 * t)}};
}

std::vector<ImuSample> Swaying(double begin, double end, double rate = 200) {
  std::vector<ImuSample> readings;
  for (int i = 0; begin + i / rate < end; ++i) readings.push_back(Swaying(begin + i / rate));
  return readings;
}

// The readings in handfuls, as a driver gives them with the images.
std::vector<ImuSample> Feed(ImuStream& stream, const std::vector<ImuSample>& readings,
                            size_t handful = 7) {
  std::vector<ImuSample> out;
  for (size_t i = 0; i < readings.size(); i += handful) {
    const auto end = readings.begin() + static_cast<long>(std::min(i + handful, readings.size()));
    for (const ImuSample& sample : stream.Add({readings.begin() + static_cast<long>(i), end}))
      out.push_back(sample);
  }
  return out;
}

TEST(ImuStream, LeavesGoodReadingsAsTheyAre) {
  const auto readings = Swaying(5, 15);
  ImuStream stream;
  const auto out = Feed(stream, readings);
  ASSERT_EQ(out.size(), readings.size());
  for (size_t i = 0; i < out.size(); ++i) {
    EXPECT_EQ(out[i].time, readings[i].time);
    EXPECT_EQ(out[i].angular_rate, readings[i].angular_rate);
  }
  EXPECT_THAT(stream.News(), IsEmpty());
  EXPECT_EQ(stream.broken(), "");
  EXPECT_NEAR(stream.rate(), 200, 1e-6);
}

TEST(ImuStream, SortsAndLeavesOutWhatCannotBe) {
  auto readings = Swaying(0, 1);
  std::swap(readings[8], readings[10]);
  readings[20].time = readings[19].time;
  readings[30].specific_force.y() = kNan;
  readings[40].angular_rate.x() = 3e5;
  readings[50].time = readings[45].time + 1e-4;  // another handful has been used
  ImuStream stream;
  const auto out = Feed(stream, readings, 10);
  EXPECT_EQ(out.size(), readings.size() - 5);  // 10 came with the handful after 8's place
  for (size_t i = 1; i < out.size(); ++i) EXPECT_GT(out[i].time, out[i - 1].time);
  for (const ImuSample& sample : out) {
    EXPECT_TRUE(sample.angular_rate.isApprox(Swaying(sample.time).angular_rate));
    EXPECT_TRUE(sample.specific_force.isApprox(Swaying(sample.time).specific_force));
  }
  const auto news = stream.News();
  EXPECT_THAT(news,
              ElementsAre(HasSubstr("2 inertial readings cannot be"),
                          HasSubstr("1 inertial reading has the time stamp of the one before"),
                          HasSubstr("not in order"), HasSubstr("2 inertial readings came too")));
  EXPECT_THAT(stream.News(), IsEmpty());
  EXPECT_EQ(stream.broken(), "");
}

TEST(ImuStream, TellsGapsAndSaturationAndGoesOn) {
  auto readings = Swaying(0, 2);
  for (const ImuSample& sample : Swaying(2.4, 5)) readings.push_back(sample);
  for (size_t i = 300; i < 306; ++i) readings[i].angular_rate.z() = -8.73;
  ImuStream stream;
  EXPECT_EQ(Feed(stream, readings).size(), readings.size());
  EXPECT_THAT(stream.News(), ElementsAre(HasSubstr("1 gap of 0.4 s"),
                                         HasSubstr("gyroscope is saturated at 8.73 rad/s in 6")));
  EXPECT_EQ(stream.broken(), "");
}

TEST(ImuStream, GoesOnWhereTheClockWasSetBack) {
  ImuStream stream;
  Feed(stream, Swaying(100, 102));
  EXPECT_EQ(Feed(stream, Swaying(3, 5)).size(), 400u);
  EXPECT_THAT(stream.News(), ElementsAre(HasSubstr("set back")));
}

// Stamps are times of arrival: every 35 ms seven readings, 3 µs apart.
TEST(ImuStream, SpacesBurstsEvenly) {
  for (const size_t handful : {size_t{7}, size_t{100000}}) {
    auto readings = Swaying(0, 20);
    for (size_t i = 0; i < readings.size(); ++i) {
      const double arrival = 0.035 * (1 + std::floor(static_cast<double>(i) / 7));
      readings[i].time = arrival + 3e-6 * static_cast<double>(i % 7);
    }
    ImuStream stream;
    const auto out = Feed(stream, readings, handful);
    ASSERT_EQ(out.size(), readings.size());
    EXPECT_THAT(stream.News(), ElementsAre(HasSubstr("bursts")));
    // After four seconds, when the loop has settled: the stamp is the true time and a constant,
    // which is a delay of 20 ms in the mean.
    for (size_t i = 800; i < out.size(); ++i)
      EXPECT_NEAR(out[i].time - 0.005 * static_cast<double>(i), 0.02, 0.002) << i;
    for (size_t i = 1; i < out.size(); ++i) EXPECT_GT(out[i].time, out[i - 1].time);
  }
}

TEST(ImuStream, JitterOfAThirdOfThePeriodIsNoBurst) {
  auto readings = Swaying(0, 5);
  Random random(3);
  for (ImuSample& sample : readings) sample.time += random.Uniform(-0.0017, 0.0017);
  ImuStream stream;
  const auto out = Feed(stream, readings);
  EXPECT_THAT(stream.News(), IsEmpty());
}

TEST(ImuStream, NamesWhatIsBroken) {
  const auto broken = [](auto&& spoil) {
    auto readings = Swaying(0, 8);
    for (ImuSample& sample : readings) spoil(sample);
    ImuStream stream;
    Feed(stream, readings);
    return stream.broken();
  };
  EXPECT_THAT(broken([](ImuSample& s) { s.angular_rate.y() = 0.02; }),
              HasSubstr("gyroscope's y axis is dead"));
  EXPECT_THAT(broken([](ImuSample& s) { s.specific_force.z() = 0; }),
              HasSubstr("accelerometer's z axis is dead"));
  EXPECT_THAT(broken([](ImuSample& s) {
                s.angular_rate = {0, 0, 0};
                s.specific_force.x() *= 20;
              }),
              HasSubstr("gyroscope's x axis is dead"));
  EXPECT_THAT(broken([](ImuSample& s) { s.specific_force.y() -= 9.81; }),
              HasSubstr("lack gravity"));
  EXPECT_THAT(broken([](ImuSample& s) { s.specific_force /= 9.81; }), HasSubstr("in g"));
  EXPECT_THAT(broken([](ImuSample& s) { s.angular_rate *= 180 / 3.14159; }), HasSubstr("deg/s"));
  // At rest a coarse sensor gives one value for long.
  EXPECT_EQ(broken([](ImuSample& s) {
              s.angular_rate = {0, 0.001, 0};
              s.specific_force = {0.1, 9.8, 0};
            }),
            "");
}

TEST(OnOneClock, InterpolatesTheAccelerations) {
  std::vector<ImuSample> gyroscope, accelerometer;
  for (int i = 0; i < 400; ++i) gyroscope.push_back({0.005 * i, {1.0 * i, 0, 0}, {}});
  for (int i = 0; i < 100; ++i) {
    const double t = 0.1013 + 0.016 * i;
    accelerometer.push_back({t, {}, {2 * t, 9, -t}});  // linear: interpolation is exact
  }
  const auto both = OnOneClock(gyroscope, accelerometer);
  ASSERT_GT(both.size(), 300u);
  EXPECT_GE(both.front().time, 0.1013);
  EXPECT_LE(both.back().time, 0.1013 + 0.016 * 99);
  for (const ImuSample& sample : both) {
    EXPECT_NEAR(sample.angular_rate.x(), sample.time / 0.005, 1e-9);
    EXPECT_TRUE(
        sample.specific_force.isApprox(Eigen::Vector3d(2 * sample.time, 9, -sample.time), 1e-9));
  }
  // Not across a gap.
  accelerometer.erase(accelerometer.begin() + 20, accelerometer.begin() + 60);
  EXPECT_LT(OnOneClock(gyroscope, accelerometer).size(), both.size() - 80);
}

}  // namespace
}  // namespace alidade::imu_stream_test
