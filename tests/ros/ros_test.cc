// Bytes of ROS 2 messages and MCAP files, computed by hand. web/mcap/test reads complete files with
// third-party readers.
#include <gtest/gtest.h>

#include <cstring>

#include "alidade/ros/cdr.h"
#include "alidade/ros/crc32.h"
#include "alidade/ros/mcap_writer.h"
#include "alidade/ros/ros_messages.h"
#include "alidade/ros/ros_schemas.h"

namespace alidade::ros_test {
namespace {

TEST(Crc32, IsThatOfTheCatalogue) {
  EXPECT_EQ(Crc32("123456789"), 0xcbf43926u);  // the "check" value of CRC-32/ISO-HDLC
  EXPECT_EQ(Crc32("6789", Crc32("12345")), 0xcbf43926u);
  EXPECT_EQ(Crc32(""), 0u);
}

TEST(CdrWriter, PutsNumbersAtMultiplesOfTheirSize) {
  CdrWriter out;
  out.Add(uint8_t{7});
  out.Add(uint32_t{0x01020304});
  out.AddText("ab");
  out.Add(1.0);  // at 16: 8 bytes, 7 of text, 1 of padding
  const std::string expected("\0\1\0\0\7\0\0\0\4\3\2\1\3\0\0\0ab\0\0\0\0\0\0\0\0\xf0\x3f", 28);
  std::string found = out.Take();
  ASSERT_EQ(found.size(), 28u);
  EXPECT_EQ(found, expected);
}

TEST(RosTime, IsTheDecimalThatWasRead) {
  const auto time = [](double seconds) {
    const RosTime t = RosTime::FromSeconds(seconds);
    return std::to_string(t.sec) + "." + std::to_string(1000000000 + t.nanosec).substr(1);
  };
  EXPECT_EQ(time(1305031102.175304), "1305031102.175304000");
  EXPECT_EQ(time(0), "0.000000000");
  EXPECT_EQ(time(0.1), "0.100000000");
  EXPECT_EQ(time(12.123456789), "12.123456789");
  EXPECT_EQ(time(2.9999999999), "3.000000000");
  EXPECT_EQ(time(-1), "0.000000000");
  EXPECT_EQ(time(1e18), "2147483647.000000000");
  EXPECT_EQ(RosTime::FromSeconds(1305031102.175304).nanoseconds(), 1305031102175304000u);
}

TEST(RosSchemas, HoldEveryTypeTheyNameOnce) {
  const std::string schema = SchemaOf(RosType::kPath);
  for (const char* part : {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Pose",
                           "geometry_msgs/PoseStamped", "geometry_msgs/Quaternion"}) {
    const std::string line = "\nMSG: " + std::string(part) + "\n";
    const size_t found = schema.find(line);
    ASSERT_NE(found, std::string::npos) << part;
    EXPECT_EQ(schema.find(line, found + 1), std::string::npos) << part;
  }
  EXPECT_EQ(NameOf(RosType::kCloud), "sensor_msgs/msg/PointCloud2");
}

TEST(EncodeCloud, HasColoursAsThePointCloudLibraryPacksThem) {
  Cloud cloud;
  cloud.points = {{1, 2, 3}};
  cloud.colors = {{10, 20, 30}};
  const std::string bytes = EncodeCloud({{5, 6}, "map"}, cloud);
  const float p[] = {1, 2, 3};
  const std::string data = std::string(reinterpret_cast<const char*>(p), sizeof p) + "\x1e\x14\x0a";
  EXPECT_NE(bytes.find(data), std::string::npos);
}

struct Written {
  std::string bytes;
  McapWriter::Sink sink = [this](std::string_view more) { bytes += more; };
};

TEST(McapWriter, MakesAWholeFileOfNothing) {
  Written written;
  McapWriter writer(written.sink, "ros2", "test");
  writer.Close();
  const std::string magic("\x89MCAP0\r\n", 8);
  EXPECT_EQ(written.bytes.substr(0, 8), magic);
  EXPECT_EQ(written.bytes.substr(written.bytes.size() - 8), magic);
}

TEST(McapWriter, HandsChunksOnAsTheyFill) {
  Written written;
  int packed = 0;
  McapWriter writer(written.sink, "ros2", "test",
                    {"zstd",
                     [&](std::string_view plain) {
                       ++packed;
                       return std::string(plain.substr(0, 10));
                     }},
                    1000);
  const uint16_t channel =
      writer.AddChannel(writer.AddSchema("a/msg/A", "ros2msg", ""), "/a", "cdr", {});
  const size_t before = written.bytes.size();
  for (uint64_t time = 0; time < 99; ++time) writer.Write(channel, time, std::string(100, 'x'));
  EXPECT_EQ(packed, 12);  // 8 messages of 131 bytes each
  EXPECT_GT(written.bytes.size(), before + 12 * 10);
  writer.Close();
  EXPECT_EQ(packed, 13);
}

}  // namespace
}  // namespace alidade::ros_test
