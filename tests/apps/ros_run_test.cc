// ROS recordings given to the program: results are those of the folder with the same pictures.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "bags/bag_bytes.h"
#include "bags/message_bytes.h"
#include "support/rendered.h"

namespace alidade::ros_run_test {
namespace {

using testing::HasSubstr;

std::string Room() { return Rendered({"room", "--frames", "60", "--seed", "5"}); }

int64_t Nanoseconds(const std::string& stamp) {
  const size_t point = stamp.find('.');
  std::string digits = stamp.substr(point + 1);
  digits.resize(9, '0');
  return std::stoll(stamp.substr(0, point)) * 1'000'000'000 + std::stoll(digits);
}

// The pictures of a list as they lie in their files.
void AddList(const std::string& folder, const std::string& list, const std::string& topic,
             const std::string& format, std::vector<WrittenMessage>& messages) {
  for (const std::string& line : DataLines(folder + "/" + list)) {
    std::istringstream words(line);
    std::string stamp, name;
    words >> stamp >> name;
    const bool depth = format.find("Depth") != std::string::npos;
    messages.push_back(
        {topic, "sensor_msgs/CompressedImage", Nanoseconds(stamp),
         CompressedMessage({true}, Nanoseconds(stamp), "camera", format,
                           (depth ? std::string(12, '\0') : "") + ReadText(folder + "/" + name))});
  }
}

std::vector<WrittenMessage> MessagesOf(const std::string& folder) {
  std::vector<WrittenMessage> messages;
  AddList(folder, "rgb.txt", "/camera/image_raw/compressed", "png", messages);
  AddList(folder, "depth.txt", "/camera/depth/image_raw/compressedDepth",
          "16UC1; compressedDepth png", messages);
  std::stable_sort(
      messages.begin(), messages.end(),
      [](const WrittenMessage& a, const WrittenMessage& b) { return a.log_time < b.log_time; });
  return messages;
}

TEST(RosRun, GivesTheTrajectoryOfTheFolderToTheLastByte) {
  const TempFolder folder;
  const std::string camera = Room() + "/camera.yaml";
  const std::string bag =
      folder.Write("walk.mcap", McapBytes({"zstd"}, false).Of(MessagesOf(Room())));
  const ProgramResult of_bag =
      RunAlidade({"run", bag, "--camera", camera, "--out", folder / "of_bag"});
  ASSERT_EQ(of_bag.status, 0) << of_bag.err;
  EXPECT_THAT(of_bag.out, HasSubstr("Topics: image /camera/image_raw/compressed"));
  EXPECT_THAT(of_bag.out, HasSubstr("depth /camera/depth/image_raw/compressedDepth"));
  const ProgramResult of_folder =
      RunAlidade({"run", Room(), "--camera", camera, "--quiet", "--out", folder / "of_folder"});
  ASSERT_EQ(of_folder.status, 0) << of_folder.err;
  const std::string trajectory = ReadText(folder / "of_folder/trajectory.txt");
  EXPECT_GT(LineCount(trajectory), 50);
  EXPECT_EQ(ReadText(folder / "of_bag/trajectory.txt"), trajectory);
}

TEST(RosRun, ErrorsAreOneLineWithTheRightStatus) {
  const TempFolder folder;
  const std::string bag =
      folder.Write("walk.mcap", McapBytes({"none"}, false).Of(MessagesOf(Room())));
  const ProgramResult topic = RunAlidade({"run", bag + "?image=/nowhere", "--out", folder / "a"});
  EXPECT_EQ(topic.status, 2);
  EXPECT_THAT(topic.err, HasSubstr("/camera/image_raw/compressed"));
  EXPECT_EQ(LineCount(topic.err), 1);
  const ProgramResult damaged =
      RunAlidade({"run", folder.Write("bad.bag", "#ROSBAG V2.0\n"), "--out", folder / "b"});
  EXPECT_EQ(damaged.status, 3);
  EXPECT_THAT(damaged.err, HasSubstr("bad.bag"));
}

}  // namespace
}  // namespace alidade::ros_run_test
