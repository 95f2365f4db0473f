// ROS recordings given to the program: results are those of the folder with the same pictures.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "alidade/io/files/image_file.h"
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

void SortByTime(std::vector<WrittenMessage>& messages) {
  std::stable_sort(
      messages.begin(), messages.end(),
      [](const WrittenMessage& a, const WrittenMessage& b) { return a.log_time < b.log_time; });
}

std::vector<WrittenMessage> MessagesOf(const std::string& folder) {
  std::vector<WrittenMessage> messages;
  AddList(folder, "rgb.txt", "/camera/image_raw/compressed", "png", messages);
  AddList(folder, "depth.txt", "/camera/depth/image_raw/compressedDepth",
          "16UC1; compressedDepth png", messages);
  SortByTime(messages);
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

// A lens with distortion, told by CameraInfo alone, by a file alone, and by a file against a
// CameraInfo of something else: one trajectory. Bags have depth in millimetres, of which the
// message says nothing.
TEST(RosRun, ACameraOfCameraInfoIsThatOfAFile) {
  const TempFolder folder;
  const std::string room = Rendered({"room", "--frames", "40", "--seed", "5", "--distortion"});
  InfoFields info;
  info.width = 640;
  info.height = 480;
  info.K = {525, 0, 319.5, 0, 525, 239.5, 0, 0, 1};
  info.D = {-0.22, 0.09, 0.0006, -0.0004, 0};
  std::string words =
      "model: pinhole\nwidth: 640\nheight: 480\nfx: 525\nfy: 525\ncx: 319.5\ncy: 239.5\n"
      "distortion: [-0.22, 0.09, 0.0006, -0.0004, 0]\ndepth_factor: 1000\n";
  const std::string camera = folder.Write("camera.yaml", words);
  InfoFields other = info;
  other.K[0] = other.K[4] = 480;

  // With a calibration beside each picture, or none.
  const auto recording = [&](const std::string& name, const InfoFields* told) {
    std::vector<WrittenMessage> messages;
    AddList(room, "rgb.txt", "/camera/image_raw/compressed", "png", messages);
    for (const std::string& line : DataLines(room + "/depth.txt")) {
      std::istringstream stamp_and_file(line);
      std::string stamp, file;
      stamp_and_file >> stamp >> file;
      cv::Mat millimetres;
      ReadDepth(room + "/" + file).convertTo(millimetres, CV_16U, 1.0 / 5);
      messages.push_back(
          {"/camera/depth/image_raw", "sensor_msgs/Image", Nanoseconds(stamp),
           ImageMessage({true}, Nanoseconds(stamp), "camera", "16UC1", millimetres)});
      if (told)
        messages.push_back({"/camera/camera_info", "sensor_msgs/CameraInfo", Nanoseconds(stamp),
                            InfoMessage({true}, Nanoseconds(stamp), *told)});
    }
    SortByTime(messages);
    return folder.Write(name, McapBytes({"none"}, false).Of(messages));
  };
  const std::string told = recording("told.mcap", &info),
                    untold = recording("untold.mcap", nullptr),
                    wrong = recording("wrong.mcap", &other);
  for (const char* sensor : {"mono", "rgbd"}) {
    SCOPED_TRACE(sensor);
    const auto trajectory = [&](const std::string& bag, std::vector<std::string> options) {
      const std::string out = folder / (bag.substr(bag.rfind('/') + 1) + sensor);
      options.insert(options.begin(), {"run", bag, "--sensor", sensor, "--out", out, "--quiet"});
      const ProgramResult result = RunAlidade(options);
      EXPECT_EQ(result.status, 0) << result.err;
      return ReadText(out + "/trajectory.txt");
    };
    const std::string by_info = trajectory(told, {});
    EXPECT_GT(LineCount(by_info), 30);
    EXPECT_EQ(trajectory(untold, {"--camera", camera}), by_info);
    EXPECT_EQ(trajectory(wrong, {"--camera", camera}), by_info);
    EXPECT_NE(trajectory(wrong, {}), by_info);
  }
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
