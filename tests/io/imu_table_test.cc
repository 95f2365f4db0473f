#include "alidade/io/imu_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/expect_error.h"

namespace alidade::imu_table_test {
namespace {

using testing::HasSubstr;
using testing::Not;

// A reading of the motion below, i / 100 s after 1.4e9 s.
ImuSample Reading(int i) {
  const double t = 0.01 * i;
  return {1.4e9 + t, {0.3 * std::sin(t), -0.2, 0.1 * t}, {0.4, 9.7, 0.5 * std::cos(t)}};
}

std::string Table(const std::string& header, const std::function<std::string(int)>& line) {
  std::string text = header;
  for (int i = 0; i < 300; ++i) text += line(i) + "\n";
  return text;
}

std::string Number(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.12g", value);
  return text;
}

// 7 numbers in the usual order, in other units.
std::string Line(int i, const std::string& gap, const std::string& time, double per_rad,
                 double per_mss) {
  const ImuSample r = Reading(i);
  std::string line = time;
  for (int a = 0; a < 3; ++a) line += gap + Number(per_rad * r.angular_rate[a]);
  for (int a = 0; a < 3; ++a) line += gap + Number(per_mss * r.specific_force[a]);
  return line;
}

// Integers of 10 ms steps, in the unit with `zeros` more digits than centiseconds.
std::string Stamp(int i, int zeros) {
  return std::to_string(140000000000LL + i) + std::string(static_cast<size_t>(zeros), '0');
}

void ExpectReadings(const ImuTable& table, double tolerance = 1e-9) {
  ASSERT_EQ(table.samples.size(), 300u);
  for (int i = 0; i < 300; ++i) {
    const ImuSample& sample = table.samples[static_cast<size_t>(i)];
    EXPECT_NEAR(sample.time, Reading(i).time, 1e-6);
    EXPECT_LT((sample.angular_rate - Reading(i).angular_rate).norm(), tolerance);
    EXPECT_LT((sample.specific_force - Reading(i).specific_force).norm(), tolerance);
  }
}

constexpr double kDegrees = 180 / 3.14159265358979;

TEST(ImuTable, RecognizesUnitsBySizeAndSaysSo) {
  const auto plain = [](int zeros, double per_rad, double per_mss, const std::string& gap = ",") {
    return ParseImuTable(
        Table("", [&](int i) { return Line(i, gap, Stamp(i, zeros), per_rad, per_mss); }),
        "imu.csv");
  };
  ExpectReadings(plain(1, 1, 1));
  EXPECT_EQ(plain(1, 1, 1).told,
            "imu.csv: times are read as milliseconds, angular rates as rad/s, accelerations as "
            "m/s²");
  ExpectReadings(plain(7, kDegrees, 1 / 9.80665, ";"));
  EXPECT_EQ(plain(7, kDegrees, 1 / 9.80665, "\t").told,
            "imu.csv: times are read as nanoseconds, angular rates as deg/s, accelerations as g");
  EXPECT_THAT(plain(4, 1, 1, " ").told, HasSubstr("times are read as microseconds"));
}

TEST(ImuTable, TakesColumnsAndUnitsByTheirNames) {
  // A phone at rest in deg/s is slow, and only the name tells.
  const auto named = [](const std::string& header) {
    return ParseImuTable(Table(header,
                               [](int i) {
                                 const ImuSample r = Reading(i);
                                 std::string line = "7";
                                 for (int a = 0; a < 3; ++a)
                                   line += " , " + Number(r.specific_force[a] / 9.80665);
                                 line += ",\"" + Stamp(i, 1) + "\",1,2,3";
                                 for (int a = 2; a >= 0; --a)
                                   line += "," + Number(kDegrees / 100 * r.angular_rate[a]);
                                 return line;
                               }),
                         "log.txt");
  };
  ImuTable table = named(
      "id,Accelerometer x (g),accelerometer Y (g),Accelerometer z (g),time_ms,mag_x,mag_y,mag_z,"
      "Gyroscope z (deg/s),gyroscope y (deg/s),gyroscope x (deg/s)\n");
  EXPECT_EQ(table.told, "");
  for (ImuSample& sample : table.samples) sample.angular_rate *= 100;
  ExpectReadings(table);
  table = named("# id, ax [g], ay, az, t [ms], mx, my, mz, gz [deg/s], gy, gx\n");
  EXPECT_EQ(table.told, "");
  for (ImuSample& sample : table.samples) sample.angular_rate *= 100;
  ExpectReadings(table);
}

TEST(ImuTable, ReadsWhatThePhonePageWrites) {
  const ImuTable table = ParseImuTable(
      Table("# seconds, acceleration with gravity x y z m/s^2, turning about x y z deg/s (W3C "
            "DeviceMotion: the device's own axes)\n",
            [](int i) {
              const ImuSample r = Reading(i);
              std::string line = Number(r.time);
              for (int a = 0; a < 3; ++a) line += "," + Number(r.specific_force[a]);
              for (int a = 0; a < 3; ++a) line += "," + Number(kDegrees * r.angular_rate[a]);
              return line;
            }),
      "motion.csv");
  EXPECT_EQ(table.told, "");
  ASSERT_EQ(table.samples.size(), 300u);
  EXPECT_TRUE(table.samples[50].angular_rate.isApprox(Reading(50).angular_rate, 1e-6));
  EXPECT_TRUE(table.samples[50].specific_force.isApprox(Reading(50).specific_force, 1e-6));
}

TEST(ImuTable, NamesWhatCannotBeRead) {
  const auto message = [](const std::string& text) {
    return MessageOf(ErrorKind::kInput, [&] { ParseImuTable(text, "imu.csv"); });
  };
  EXPECT_THAT(message(""), HasSubstr("imu.csv has no readings"));
  EXPECT_THAT(message("t,wx,wy,wz,ax,ay,az\n"), HasSubstr("no readings"));
  EXPECT_THAT(message("t,wx,wy,wz,ax,ay\n1,2,3,4,5,6\n"), HasSubstr("acceleration z"));
  EXPECT_THAT(message("t,wx,wy,wz,ax,ay,az,gyro_x\n1,2,3,4,5,6,7,8\n"),
              HasSubstr("`wx` and `gyro_x`"));
  EXPECT_THAT(message("1,2,3\n4,5,6\n"), HasSubstr("imu.csv:1: a reading is 7 numbers"));
  // A damaged line is left out and counted.
  const ImuTable table = ParseImuTable(
      "t [s],wx [rad/s],wy,wz,ax [m/s^2],ay,az\n1,0,0,0,0,9.8,0\n1.01,0,0,0,0,9\n1.02,0,0,x,0,9.8,0"
      "\n1.03,nan,0,0,0,9.8,0\n",
      "imu.csv");
  EXPECT_EQ(table.samples.size(), 2u);
  EXPECT_EQ(table.told, "imu.csv: 2 lines are no readings (the first is 3)");
}

}  // namespace
}  // namespace alidade::imu_table_test
