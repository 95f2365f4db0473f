// What `alidade run` does with recordings, cameras and folders that are not as they should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "alidade/io/files/image_file.h"
#include "support/rendered.h"

namespace alidade::bad_input_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AnyOf;
using testing::HasSubstr;

constexpr int kFrames = 30;

class BadInput : public testing::Test {
 protected:
  // A rendered recording with depth, in TUM layout, to break.
  std::string Recording() {
    return CopyOf(Rendered({"room", "--frames", std::to_string(kFrames), "--seed", "5"}), folder_);
  }
  ProgramResult Run(const std::string& source, std::vector<std::string> options = {}) {
    std::vector<std::string> arguments = {"run", source, "--out", out_};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return RunAlidade(arguments);
  }
  json Stats() const { return json::parse(ReadText(out_ + "/stats.json"), nullptr, false); }

  // One line on stderr that says `words`, nothing written.
  void ExpectRefused(const ProgramResult& result, int status, const std::string& words) const {
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    EXPECT_FALSE(fs::exists(out_ + "/trajectory.txt"));
  }
  // The run goes on without `dropped` frames, and says so.
  void ExpectSkipped(const ProgramResult& result, int dropped, const std::string& warning) const {
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr(warning));
    const json stats = Stats();
    ASSERT_TRUE(stats.is_object());
    EXPECT_EQ(stats["frames"], kFrames);
    EXPECT_EQ(stats["dropped_frames"], dropped);
    EXPECT_EQ(stats["tracked"], kFrames - dropped);
    EXPECT_THAT(stats["warnings"].dump(), HasSubstr(warning));
    EXPECT_EQ(DataLines(out_ + "/trajectory.txt").size(), static_cast<size_t>(kFrames - dropped));
  }
  // The image file of a frame.
  static std::string ImageOf(const std::string& recording, int frame) {
    const std::string line = DataLines(recording + "/rgb.txt").at(static_cast<size_t>(frame));
    return recording + "/" + line.substr(line.find(' ') + 1);
  }
  // Lets `change` rewrite the lines of rgb.txt that name images.
  template <typename Change>
  static void ChangeImageList(const std::string& recording, const Change& change) {
    std::vector<std::string> lines = DataLines(recording + "/rgb.txt");
    change(lines);
    WriteLines(recording + "/rgb.txt", lines);
  }
  // Rewrites a key of camera.yaml; an empty value takes the line out.
  static void SetCameraKey(const std::string& recording, const std::string& key,
                           const std::string& value) {
    std::vector<std::string> lines;
    bool found = false;
    for (const std::string& line : ReadLines(recording + "/camera.yaml")) {
      if (line.compare(0, key.size() + 1, key + ":") != 0) {
        lines.push_back(line);
        continue;
      }
      found = true;
      if (!value.empty()) lines.push_back(key + ": " + value);
    }
    EXPECT_TRUE(found) << key;
    WriteLines(recording + "/camera.yaml", lines);
  }

  TempFolder folder_;
  std::string out_ = folder_ / "out";
};

TEST_F(BadInput, NoSuchPath) { ExpectRefused(Run(folder_ / "nowhere"), 3, "nowhere"); }

TEST_F(BadInput, EmptyFolder) { ExpectRefused(Run(folder_.Folder("empty")), 3, "empty"); }

TEST_F(BadInput, FolderOfUnknownKind) {
  folder_.Write("letters/dear_john.txt", "It is over.");
  ExpectRefused(Run(folder_ / "letters"), 3, "letters");
}

TEST_F(BadInput, TruncatedImageInTheMiddleIsSkipped) {
  const std::string recording = Recording();
  const std::string image = ImageOf(recording, 15);
  fs::resize_file(image, fs::file_size(image) / 2);
  ExpectSkipped(Run(recording), 1, fs::path(image).filename().string());
}

TEST_F(BadInput, ZeroByteImageInTheMiddleIsSkipped) {
  const std::string recording = Recording();
  const std::string image = ImageOf(recording, 15);
  fs::resize_file(image, 0);
  ExpectSkipped(Run(recording), 1, fs::path(image).filename().string());
}

TEST_F(BadInput, MissingImageIsSkipped) {
  const std::string recording = Recording();
  const std::string image = ImageOf(recording, 15);
  fs::remove(image);
  ExpectSkipped(Run(recording), 1, fs::path(image).filename().string());
}

TEST_F(BadInput, ImageOfAnotherSizeIsSkipped) {
  const std::string recording = Recording();
  const std::string image = ImageOf(recording, 15);
  WriteImage(image, cv::Mat(100, 200, CV_8UC1, cv::Scalar(128)));
  ExpectSkipped(Run(recording), 1, "200x100");
}

TEST_F(BadInput, FramesWithoutDepthAreTrackedAllTheSame) {
  const std::string recording = Recording();
  std::vector<std::string> kept;
  int number = 0;
  for (const std::string& line : ReadLines(recording + "/depth.txt")) {
    const bool comment = line.empty() || line[0] == '#';
    if (!comment && number == 7)
      fs::resize_file(recording + "/" + line.substr(line.find(' ') + 1), 0);
    if (comment || number++ % 3 != 2) kept.push_back(line);
  }
  WriteLines(recording + "/depth.txt", kept);
  EXPECT_EQ(Run(recording).status, 0);
  const json stats = Stats();
  EXPECT_EQ(stats["tracked"], kFrames);
  EXPECT_FALSE(stats["warnings"].empty());
}

TEST_F(BadInput, UnsortedTimeStampsAreSorted) {
  const std::string recording = Recording();
  ChangeImageList(recording,
                  [](std::vector<std::string>& lines) { std::swap(lines[10], lines[20]); });
  ExpectSkipped(Run(recording), 0, "time stamps");
  double last = 0;
  for (const std::string& line : DataLines(out_ + "/trajectory.txt")) {
    const double time = std::strtod(line.c_str(), nullptr);
    EXPECT_GE(time, last);
    last = time;
  }
}

TEST_F(BadInput, RepeatedTimeStampIsSkipped) {
  const std::string recording = Recording();
  ChangeImageList(recording, [](std::vector<std::string>& lines) {
    lines[11] = lines[10].substr(0, lines[10].find(' ')) + lines[11].substr(lines[11].find(' '));
  });
  ExpectSkipped(Run(recording), 1, "time stamp");
}

TEST_F(BadInput, TimeStampThatIsNoNumberIsSkipped) {
  const std::string recording = Recording();
  ChangeImageList(recording, [](std::vector<std::string>& lines) {
    lines[11] = "nan" + lines[11].substr(lines[11].find(' '));
  });
  ExpectSkipped(Run(recording), 1, "rgb.txt:12");
}

TEST_F(BadInput, CameraFileThatMissesAKey) {
  const std::string recording = Recording();
  SetCameraKey(recording, "fx", "");
  ExpectRefused(Run(recording), 3, "fx");
}

TEST_F(BadInput, CameraFileWithNegativeFocalLength) {
  const std::string recording = Recording();
  SetCameraKey(recording, "fx", "-500");
  ExpectRefused(Run(recording), 3, "fx");
}

TEST_F(BadInput, CameraFileWithNan) {
  const std::string recording = Recording();
  SetCameraKey(recording, "cy", ".nan");
  ExpectRefused(Run(recording), 3, "cy");
}

TEST_F(BadInput, CameraFileOfAnotherImageSize) {
  const std::string recording = Recording();
  SetCameraKey(recording, "width", "320");
  ExpectRefused(Run(recording), 3, "320x");
}

TEST_F(BadInput, OutputThatCannotBeMade) {
  const std::string recording = Recording();
  const std::string file = folder_.Write("file", "not a folder");
  for (const std::string& out : {file, file + "/out", std::string("/proc/alidade/out")}) {
    const ProgramResult result = RunAlidade({"run", recording, "--out", out});
    ExpectRefused(result, 3, out);
  }
  EXPECT_EQ(ReadText(file), "not a folder");
}

TEST_F(BadInput, OutputFolderOfSomeoneElseIsLeftAlone) {
  folder_.Write("out/thesis.tex", "chapter 1");
  ExpectRefused(Run(Recording()), 3, out_);
  EXPECT_EQ(ReadText(out_ + "/thesis.tex"), "chapter 1");
}

TEST_F(BadInput, FullDisk) {
  const std::string disk = folder_.Folder("disk");
  // Room for the folder and little else.
  if (mount("none", disk.c_str(), "tmpfs", 0, "size=8k") != 0) {
    GTEST_SKIP() << "needs the right to mount a small tmpfs";
  }
  const ProgramResult result = RunAlidade({"run", Recording(), "--out", disk + "/out", "--quiet"});
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr(disk));
  EXPECT_EQ(LineCount(result.err), 1) << result.err;
  // Nothing half-written stays: what is there is a complete file under its own name.
  for (const auto& entry : fs::recursive_directory_iterator(disk)) {
    if (entry.is_directory()) continue;
    const std::string name = entry.path().filename().string();
    EXPECT_THAT(name,
                AnyOf("trajectory.txt", "trajectory_live.txt", "keyframes.txt", "stats.json"));
  }
  umount(disk.c_str());
}

TEST_F(BadInput, FirstPastTheEnd) {
  ExpectRefused(Run(Recording(), {"--first", "1000"}), 3, "1000");
}

TEST_F(BadInput, UnknownOptionNamesTheNearest) {
  ExpectRefused(Run(Recording(), {"--frist", "5"}), 2, "did you mean '--first'");
}

TEST_F(BadInput, UnknownSettingNamesTheNearest) {
  ExpectRefused(Run(Recording(), {"--set", "tracker.extractor.featurs=500"}), 2,
                "tracker.extractor.features");
}

TEST_F(BadInput, SettingOfTheWrongKind) {
  ExpectRefused(Run(Recording(), {"--set", "tracker.extractor.features=many"}), 2, "many");
}

// Rewrites every image of a recording.
template <typename Change>
void ChangeImages(const std::string& recording, const Change& change) {
  for (const auto& entry : fs::directory_iterator(recording + "/rgb")) {
    const std::string path = entry.path().string();
    WriteImage(path, change(ReadImageGray(path)));
  }
}

TEST_F(BadInput, BlackFramesAllAlong) {
  const std::string recording = Recording();
  ChangeImages(recording, [](const cv::Mat& image) { return cv::Mat(image * 0); });
  for (const char* sensor : {"rgbd", "mono"}) {
    const ProgramResult result = Run(recording, {"--sensor", sensor, "--quiet"});
    EXPECT_EQ(result.status, 4);
    EXPECT_THAT(result.err, HasSubstr("nothing could be mapped: "));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    EXPECT_EQ(Stats()["tracked"], 0);
  }
}

TEST_F(BadInput, BlurredFramesAllAlong) {
  const std::string recording = Recording();
  ChangeImages(recording, [](const cv::Mat& image) {
    cv::Mat blurred;
    cv::GaussianBlur(image, blurred, {}, 40);
    return blurred;
  });
  const ProgramResult result = Run(recording, {"--quiet"});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("nothing could be mapped: "));
}

TEST_F(BadInput, InterruptedInTheMiddleKeepsTheResultsSoFar) {
  // Five frames a second: six seconds in all, of which one or two are let pass.
  const ProgramResult result =
      RunAlidade({"run", Recording(), "--out", out_, "--rate", "5"}, [&](pid_t process) {
        while (!fs::exists(out_)) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        std::this_thread::sleep_for(std::chrono::seconds(2));
        kill(process, SIGINT);
      });
  EXPECT_EQ(result.status, 130) << result.err;
  const json stats = Stats();
  ASSERT_TRUE(stats.is_object());
  EXPECT_GT(stats["frames"], 0);
  EXPECT_LT(stats["frames"], kFrames);
  EXPECT_EQ(DataLines(out_ + "/trajectory.txt").size(), stats["tracked"].get<size_t>());
}

}  // namespace
}  // namespace alidade::bad_input_test
