// One recording in every container gives the same frames: complete, truncated and damaged.
#include <gmock/gmock.h>

#include <algorithm>

#include "alidade/base/random.h"
#include "alidade/io/files/open_source.h"
#include "bags/small_recording.h"
#include "support/expect_error.h"

namespace alidade::containers_test {
namespace {

using testing::HasSubstr;

bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

class Containers : public testing::TestWithParam<Container> {
 protected:
  TempFolder folder_;
  WarningCatcher warnings_;
};

TEST_P(Containers, GiveTheSameFrames) {
  const auto source = OpenSource(GetParam().write(folder_));
  const SourceInfo info = source->Info();
  EXPECT_EQ(info.name, "walk");
  EXPECT_EQ(info.kind, "ros");
  EXPECT_EQ(info.sensor, Sensor::kRgbd);
  EXPECT_EQ(info.frames, kSmallFrames);
  EXPECT_EQ(info.camera.fx, 60);
  EXPECT_EQ(info.camera.cy, 24);
  EXPECT_EQ(info.camera.fps, 20);
  EXPECT_EQ(info.camera.depth_factor, 1000);
  EXPECT_FALSE(info.camera_guessed);
  EXPECT_THAT(info.told, HasSubstr("image /camera/rgb/image_raw/compressed"));
  EXPECT_THAT(info.told, HasSubstr("depth /camera/depth/image_raw"));
  for (int i = 0; i < kSmallFrames; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->problem, "");
    EXPECT_EQ(frame->number, i);
    EXPECT_EQ(frame->stamp, "1403715273." + std::to_string(262142976 + i * kGap));
    EXPECT_TRUE(Same(frame->image, TinyImage(i)));
    EXPECT_TRUE(Same(frame->depth, TinyDepth(i)));
  }
  EXPECT_FALSE(source->Next());
  ASSERT_TRUE(source->Seek(3));
  EXPECT_TRUE(Same(source->Next()->depth, TinyDepth(3)));
}

TEST_P(Containers, AreReadAsFarAsTheyGoWhenCutShort) {
  const std::string path = GetParam().write(folder_);
  if (path == folder_ / "walk") GTEST_SKIP() << "a folder";
  const std::string bytes = ReadBytes(path);
  int read = 0, refused = 0, told = 0;
  size_t most = 0;
  for (int tenth = 1; tenth < 10; ++tenth) {
    folder_.Write(path.substr(folder_.path().size() + 1),
                  bytes.substr(0, bytes.size() * static_cast<size_t>(tenth) / 10));
    try {
      const auto source = OpenSource(path);
      size_t good = 0;
      while (const auto frame = source->Next()) {
        told += !frame->problem.empty();
        if (!frame->problem.empty()) continue;
        ++good;
        EXPECT_TRUE(Same(frame->image, TinyImage(frame->number)));
      }
      EXPECT_GE(good, most) << "a longer part has fewer frames";
      most = good;
      ++read;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("walk"));
      ++refused;
    }
  }
  EXPECT_EQ(read + refused, 9);
  if (path.ends_with(".db3")) return;  // SQLite rejects a file with missing pages
  EXPECT_GT(read, 0);
  EXPECT_GT(most, 2u);
  if (told == 0) {  // otherwise the frames themselves report it
    EXPECT_THAT(warnings_.text(), HasSubstr("walk"));
  }
}

// Some bytes inverted: reading does not crash and returns no more frames than there were.
TEST_P(Containers, SurviveDamage) {
  const std::string path = GetParam().write(folder_);
  if (path == folder_ / "walk") GTEST_SKIP() << "a folder";
  const std::string bytes = ReadBytes(path);
  Random random(7);
  int opened = 0;
  for (int i = 0; i < 40; ++i) {
    std::string damaged = bytes;
    for (int n = 1 + static_cast<int>(random.Below(6)); n > 0; --n)
      damaged[random.Below(damaged.size())] = static_cast<char>(random.Below(256));
    folder_.Write(path.substr(folder_.path().size() + 1), damaged);
    try {
      const auto source = OpenSource(path);
      ++opened;
      int frames = 0;
      while (source->Next()) ++frames;
      EXPECT_LE(frames, kSmallFrames + 1);
    } catch (const Error& error) {
      EXPECT_GT(std::string(error.what()).size(), 8u);
    }
  }
  EXPECT_GT(opened, 0);
}

INSTANTIATE_TEST_SUITE_P(All, Containers, testing::ValuesIn(AllContainers()),
                         [](const auto& test) { return test.param.name; });

TEST(ContainerErrors, SayWhatIsWrongAndWhere) {
  const TempFolder folder;
  const auto message = [&](const std::string& name, const std::string& bytes) {
    const std::string path = folder.Write(name, bytes);
    return MessageOf(ErrorKind::kInput, [&] { OpenSource(path); });
  };
  EXPECT_THAT(message("a.bag", ""), HasSubstr("a.bag is empty"));
  EXPECT_THAT(message("b.bag", "something else"), HasSubstr("neither a ROS bag"));
  EXPECT_THAT(message("c.bag", "#ROSBAG V1.2\n..."), HasSubstr("rosbag migrate"));
  EXPECT_THAT(message("d.mcap", "\x89MCAP0\r\n"), HasSubstr("d.mcap"));
  EXPECT_THAT(message("e.db3", "SQLite format 3"), HasSubstr("e.db3"));
  const std::vector<WrittenMessage> no_pictures = {{"/imu", "sensor_msgs/Imu", 1, "x"}};
  EXPECT_THAT(message("f.bag", BagBytes({"none"}).Of(no_pictures)),
              HasSubstr("/imu (sensor_msgs/Imu, 1)"));
}

TEST(ContainerErrors, AFolderOfSeveralRecordingsIsRefused) {
  const TempFolder folder;
  folder.Write("both/a.mcap", "x");
  folder.Write("both/b.mcap", "x");
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { OpenSource(folder / "both"); }),
              HasSubstr("several recordings"));
}

// A chunk with inverted bytes loses its own frames and no others.
TEST(ContainerErrors, ADamagedChunkCostsItsFrames) {
  const TempFolder folder;
  const WarningCatcher warnings;
  std::string bytes = McapBytes({"zstd"}, false).Of(SmallRecording({true}));
  bytes[bytes.size() / 2] = static_cast<char>(~bytes[bytes.size() / 2]);
  const auto source = OpenSource(folder.Write("walk.mcap", bytes));
  int good = 0, bad = 0;
  while (const auto frame = source->Next()) {
    ++(frame->problem.empty() ? good : bad);
    if (!frame->problem.empty()) {
      EXPECT_THAT(frame->problem, HasSubstr("damaged"));
    }
  }
  EXPECT_EQ(good, 4);
  EXPECT_EQ(bad, 1);
}

}  // namespace
}  // namespace alidade::containers_test
