// Inertial readings of ROS recordings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "alidade/io/files/open_source.h"
#include "alidade/io/wrappers.h"
#include "bags/small_recording.h"
#include "support/expect_error.h"

namespace alidade::imu_topics_test {
namespace {

using testing::HasSubstr;

struct Reading {
  Eigen::Vector3d rate, force;
};

// Of `t` seconds after the first image.
Reading ReadingAt(double t) { return {{0.3, -0.2 + t, 0.1 * t}, {0.4 - t, 9.7, 0.5 + 2 * t}}; }

// sensor_msgs/Imu: orientation, angular velocity and linear acceleration, each with a covariance.
std::string ImuMessage(Dialect dialect, int64_t stamp, const std::string& frame,
                       const Reading& reading, double first_covariance = 0) {
  MessageBytes bytes(dialect.cdr, dialect.big_endian);
  bytes.Header(stamp, frame);
  for (const double q : {0.0, 0.0, 0.0, 1.0}) bytes.F64(q);
  bytes.F64(-1);
  for (int i = 1; i < 9; ++i) bytes.F64(0);
  for (int i = 0; i < 3; ++i) bytes.F64(reading.rate[i]);
  for (int i = 0; i < 9; ++i) bytes.F64(0.01);
  for (int i = 0; i < 3; ++i) bytes.F64(reading.force[i]);
  bytes.F64(first_covariance);
  for (int i = 1; i < 9; ++i) bytes.F64(0);
  return bytes.Done();
}

struct Link {
  std::string parent, child;
  Eigen::Vector3d t;
  double yaw;  // about z, radians
};

std::string TransformsMessage(Dialect dialect, const std::vector<Link>& links) {
  MessageBytes bytes(dialect.cdr, dialect.big_endian);
  bytes.U32(static_cast<uint32_t>(links.size()));
  for (const Link& link : links) {
    bytes.Header(kStart, link.parent).Text(link.child);
    for (int i = 0; i < 3; ++i) bytes.F64(link.t[i]);
    bytes.F64(0).F64(0).F64(std::sin(link.yaw / 2)).F64(std::cos(link.yaw / 2));
  }
  return bytes.Done();
}

// The small recording without its unreadable /imu.
std::vector<WrittenMessage> Pictures(Dialect dialect) {
  std::vector<WrittenMessage> messages;
  for (WrittenMessage& message : SmallRecording(dialect)) {
    if (message.topic != "/imu") messages.push_back(std::move(message));
  }
  return messages;
}

// Readings of `seconds` around the images, `rate` per second. `make` may leave a quantity out.
template <typename Make>
void AddReadings(std::vector<WrittenMessage>& messages, const std::string& topic, double rate,
                 const Make& make) {
  for (int i = 0; i < static_cast<int>(1.5 * rate); ++i) {
    const double t = -0.5 + i / rate;
    const int64_t stamp = kStart + std::llround(t * 1e9);
    messages.push_back({topic, "sensor_msgs/Imu", stamp + 2'000'000, make(t, stamp)});
  }
}

void ExpectReadings(FrameSource& source, double rate) {
  double before = -kImuAround - 1 / rate;
  for (int i = 0; i < kSmallFrames; ++i) {
    const auto frame = source.Next();
    ASSERT_TRUE(frame);
    ASSERT_FALSE(frame->imu.empty());
    for (const ImuSample& sample : frame->imu) {
      const double t = sample.time - 1e-9 * static_cast<double>(kStart);
      EXPECT_NEAR(t - before, 1 / rate, 1.001 / rate);
      before = t;
      EXPECT_LT((sample.angular_rate - ReadingAt(t).rate).norm(), 1e-5);
      EXPECT_LT((sample.specific_force - ReadingAt(t).force).norm(), 1e-5);
    }
    EXPECT_GE(frame->imu.back().time, frame->time + kImuAround - 1.1 / rate);
  }
}

std::string WriteBag(const TempFolder& folder, Dialect dialect, bool mcap,
                     const std::vector<WrittenMessage>& messages) {
  if (mcap) return folder.Write("walk.mcap", McapBytes({"zstd"}, !dialect.cdr).Of(messages));
  if (!dialect.cdr) return folder.Write("walk.bag", BagBytes({"lz4"}).Of(messages));
  WriteDatabase(folder / "walk.db3", messages);
  return folder / "walk.db3";
}

TEST(ImuTopics, AreReadFromEveryContainer) {
  for (const auto& [dialect, mcap] : {std::pair{Dialect{false}, false},
                                      {Dialect{true}, false},
                                      {Dialect{true}, true},
                                      {Dialect{false}, true},
                                      {Dialect{true, true}, true}}) {
    const TempFolder folder;
    auto messages = Pictures(dialect);
    AddReadings(messages, "/imu", 100, [&, d = dialect](double t, int64_t stamp) {
      return ImuMessage(d, stamp, "imu", ReadingAt(t));
    });
    const auto source = OpenSource(WriteBag(folder, dialect, mcap, messages));
    ASSERT_TRUE(source->Info().imu);
    EXPECT_FALSE(source->Info().imu->rotation_known);
    EXPECT_NEAR(source->Info().imu->rate, 100, 0.01);
    EXPECT_THAT(source->Info().told, HasSubstr("inertial readings /imu (100 Hz)"));
    ExpectReadings(*source, 100);
  }
}

// As RealSense's driver: two topics at two rates; the other quantity is 0.
TEST(ImuTopics, PublishedApartArePutOnOneClock) {
  for (const bool by_covariance : {false, true}) {
    const TempFolder folder;
    auto messages = Pictures({true});
    AddReadings(messages, "/camera/gyro/sample", 200, [&](double t, int64_t stamp) {
      Reading reading = ReadingAt(t);
      reading.force = by_covariance ? Eigen::Vector3d(1, 2, 3) : Eigen::Vector3d(0, 0, 0);
      return ImuMessage({true}, stamp, "gyro", reading, by_covariance ? -1 : 0);
    });
    AddReadings(messages, "/camera/accel/sample", 63, [&](double t, int64_t stamp) {
      return ImuMessage({true}, stamp, "accel", {{0, 0, 0}, ReadingAt(t).force});
    });
    const std::string bag = WriteBag(folder, {true}, true, messages);
    const auto source = OpenSource(bag);
    ASSERT_TRUE(source->Info().imu);
    EXPECT_THAT(source->Info().told, HasSubstr("/camera/gyro/sample and /camera/accel/sample"));
    ExpectReadings(*source, 200);
    const auto one = OpenSource(bag + "?imu=/camera/gyro/sample");
    EXPECT_FALSE(one->Info().imu);
    EXPECT_THAT(one->Info().told, HasSubstr("no accelerometer beside it"));
    EXPECT_TRUE(OpenSource(bag + "?imu=/camera/gyro/sample,/camera/accel/sample")->Info().imu);
  }
}

TEST(ImuTopics, ArePlacedByStaticTransforms) {
  const Dialect dialect{true};
  const TempFolder folder;
  auto messages = Pictures(dialect);
  AddReadings(messages, "/imu", 100, [&](double t, int64_t stamp) {
    return ImuMessage(dialect, stamp, "imu", ReadingAt(t));
  });
  messages.insert(messages.begin(),
                  {"/tf_static", "tf2_msgs/TFMessage", kStart,
                   TransformsMessage(dialect, {{"base", "camera", {1, 2, 3}, 0.5},
                                               {"base", "imu", {1, 2.5, 3}, 0.2},
                                               {"camera", "lamp", {9, 9, 9}, 0}})});
  const auto source = OpenSource(WriteBag(folder, dialect, true, messages));
  ASSERT_TRUE(source->Info().imu);
  const ImuModel& imu = *source->Info().imu;
  ASSERT_TRUE(imu.rotation_known && imu.translation_known);
  // By hand: camera -> imu is Rz(-0.5) (0, 0.5, 0), and Rz(0.2 - 0.5).
  const Eigen::Vector3d t(0.5 * std::sin(0.5), 0.5 * std::cos(0.5), 0);
  EXPECT_TRUE(imu.T_camera_imu.t.isApprox(t, 1e-9));
  EXPECT_NEAR(imu.T_camera_imu.R(1, 0), std::sin(-0.3), 1e-9);
  EXPECT_NEAR(imu.T_camera_imu.R(2, 2), 1, 1e-9);
}

TEST(ImuTopics, AreChosenLikeImageTopics) {
  const Dialect dialect{false};
  const TempFolder folder;
  auto messages = SmallRecording(dialect);  // with an /imu that cannot be read
  AddReadings(messages, "/robot/imu", 50, [&](double t, int64_t stamp) {
    return ImuMessage(dialect, stamp, "imu", ReadingAt(t));
  });
  AddReadings(messages, "/camera/imu", 25, [&](double t, int64_t stamp) {
    Reading reading = ReadingAt(t);  // in deg/s and g
    reading.rate *= 180 / std::numbers::pi;
    reading.force /= 9.80665;
    return ImuMessage(dialect, stamp, "imu", reading);
  });
  const std::string bag = WriteBag(folder, dialect, false, messages);
  const auto source = OpenSource(bag);
  EXPECT_THAT(source->Info().told, HasSubstr("inertial readings /camera/imu (25 Hz)"));
  ExpectReadings(*source, 25);
  EXPECT_THAT(OpenSource(bag + "?imu=/robot/imu")->Info().told, HasSubstr("/robot/imu (50 Hz)"));
  EXPECT_FALSE(OpenSource(bag + "?imu=")->Info().imu);
  EXPECT_FALSE(OpenSource(bag, {.imu = "off"})->Info().imu);
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { OpenSource(bag + "?imu=/imu2"); }),
              HasSubstr("/camera/imu, /imu"));
  EXPECT_FALSE(OpenSource(bag + "?imu=/imu")->Info().imu);
}

}  // namespace
}  // namespace alidade::imu_topics_test
