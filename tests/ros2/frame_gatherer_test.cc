#include "alidade/io/ros/live/frame_gatherer.h"

#include "alidade/io/ros/live/imu_joiner.h"

namespace alidade {
namespace {

constexpr int64_t kMillisecond = 1000000;  // nanoseconds

StampedBytes Of(int64_t milliseconds) {
  return {milliseconds * kMillisecond, std::to_string(milliseconds)};
}

TEST(FrameGatherer, TakesTheNewestImage) {
  FrameGatherer gatherer(std::nullopt, false);
  gatherer.AddImage(Of(0), 0);
  gatherer.AddImage(Of(30), 0.03);
  const auto frame = gatherer.Take(0.03);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.bytes, "30");
  EXPECT_FALSE(gatherer.Take(0.04));
}

TEST(FrameGatherer, TakesTheNewestImageThatHasItsPartner) {
  FrameGatherer gatherer(0.02, false);
  gatherer.AddImage(Of(0), 0);
  gatherer.AddPartner(Of(5));
  gatherer.AddImage(Of(33), 0.033);
  const auto frame = gatherer.Take(0.034);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.bytes, "0");
  ASSERT_TRUE(frame->partner);
  EXPECT_EQ(frame->partner->bytes, "5");
  EXPECT_FALSE(gatherer.Take(0.05));
  gatherer.AddPartner(Of(38));
  EXPECT_EQ(gatherer.Take(0.06)->partner->bytes, "38");
}

TEST(FrameGatherer, AnImageGoesWithoutAPartnerThatDoesNotCome) {
  FrameGatherer gatherer(0.02, false);
  gatherer.AddImage(Of(0), 0);
  EXPECT_FALSE(gatherer.Take(FrameGatherer::kLongestWait / 2));
  const auto frame = gatherer.Take(FrameGatherer::kLongestWait);
  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->partner);
}

TEST(FrameGatherer, ReadingsOfDroppedImagesGoToTheNext) {
  FrameGatherer gatherer(std::nullopt, true);
  for (int i = 0; i < 5; ++i)
    gatherer.AddImu({0.01 * i, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  gatherer.AddImage(Of(10), 0.01);
  gatherer.AddImage(Of(38), 0.038);
  auto frame = gatherer.Take(0.04);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.bytes, "38");
  EXPECT_EQ(frame->imu.size(), 5u);
  gatherer.AddImage(Of(60), 0.06);
  EXPECT_FALSE(gatherer.Take(0.06));  // readings up to its time have not come
  gatherer.AddImu({0.065, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  EXPECT_EQ(gatherer.Take(0.07)->imu.size(), 1u);
}

TEST(ImuJoiner, InterpolatesAccelerationsAtTheTimesOfTheGyroscope) {
  ImuJoiner joiner;
  const auto value = [](double time) { return Eigen::Vector3d(time, 2 * time, 1); };
  std::vector<ImuSample> joined;
  const auto take = [&] {
    for (const ImuSample& sample : joiner.Take()) joined.push_back(sample);
  };
  // 200 and 62.5 per second; the accelerometer's come 30 ms late.
  int forces = 0;
  for (int i = 0; i < 400; ++i) {
    joiner.AddRate(0.005 * i, value(-0.005 * i));
    while (0.016 * forces < 0.005 * i - 0.03) {
      joiner.AddForce(0.016 * forces, value(0.016 * forces));
      ++forces;
    }
    if (i % 3 == 0) take();
  }
  take();
  ASSERT_GT(joined.size(), 380u);
  EXPECT_NEAR(joined.front().time, 0, 1e-9);
  for (size_t i = 0; i < joined.size(); ++i) {
    EXPECT_NEAR(joined[i].time, 0.005 * static_cast<double>(i), 1e-9);
    EXPECT_TRUE(joined[i].angular_rate.isApprox(value(-joined[i].time)));
    EXPECT_TRUE(joined[i].specific_force.isApprox(value(joined[i].time)));
  }
}

TEST(ImuJoiner, OldReadingsAreDroppedAndASilentPartnerCostsNoMemory) {
  ImuJoiner joiner;
  for (int i = 0; i < 50000; ++i) joiner.AddRate(i, Eigen::Vector3d::Zero());
  joiner.AddRate(3, Eigen::Vector3d::Ones());
  joiner.AddForce(49990, Eigen::Vector3d::Zero());
  joiner.AddForce(49999, Eigen::Vector3d::Zero());
  EXPECT_EQ(joiner.Take().size(), 2u);  // the others are more than a tenth of a second away
}

}  // namespace
}  // namespace alidade
