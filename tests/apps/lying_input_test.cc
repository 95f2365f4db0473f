// Recordings whose units, times, depths or pairs are not what they seem: read as they are meant, or
// told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/io/files/image_file.h"
#include "support/rendered.h"

namespace alidade::lying_input_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr int kFrames = 40;

class LyingInput : public testing::Test {
 protected:
  std::string Room() {
    return CopyOf(Rendered({"room", "--frames", std::to_string(kFrames), "--seed", "9"}), folder_);
  }
  std::string Pair() {
    return CopyOf(Rendered({"room", "--frames", std::to_string(kFrames), "--seed", "9", "--stereo",
                            "--format", "kitti"}),
                  folder_);
  }
  ProgramResult Run(const std::string& source, std::vector<std::string> options = {}) {
    std::vector<std::string> arguments = {"run", source, "--out", out_, "--overwrite"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return RunAlidade(arguments);
  }
  size_t Poses() const { return DataLines(out_ + "/trajectory.txt").size(); }
  // Root mean square error, meters; stamps must be those of the truth.
  double Error(const std::string& truth) const {
    const ProgramResult result =
        RunAlidade({"evaluate", "ate", truth, out_ + "/trajectory.txt", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out, nullptr, false).value("rmse", 1e9);
  }

  // Rewrites the stamps of a list: `stamp` is given the number of the line and the time in seconds.
  template <typename Stamp>
  static void ChangeStamps(const std::string& list, const Stamp& stamp) {
    std::vector<std::string> lines = DataLines(list);
    for (size_t i = 0; i < lines.size(); ++i) {
      const size_t space = lines[i].find(' ');
      const std::string name = space == std::string::npos ? "" : lines[i].substr(space);
      lines[i] = stamp(i, std::stod(lines[i])) + name;
    }
    WriteLines(list, lines);
  }

  // Rewrites the images of a folder, which `read` reads.
  template <typename Change>
  static void ChangeImages(const std::string& folder, cv::Mat (*read)(const std::string&),
                           const Change& change) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string path = entry.path().string();
      WriteImage(path, change(read(path)));
    }
  }

  TempFolder folder_;
  std::string out_ = folder_ / "out";
};

TEST_F(LyingInput, TumStampsInNanosecondsAreReadAsSuch) {
  const std::string room = Room();
  for (const char* list : {"/rgb.txt", "/depth.txt"}) {
    ChangeStamps(room + list, [](size_t, double time) {
      return std::to_string(1403636579000000000 + std::llround(time * 1e9));
    });
  }
  const ProgramResult result = Run(room);
  EXPECT_THAT(result.err, HasSubstr("read as nanoseconds"));
  EXPECT_EQ(Poses(), kFrames);
  EXPECT_THAT(DataLines(out_ + "/trajectory.txt").at(1), testing::StartsWith("1403636579.0"));
}

TEST_F(LyingInput, KittiTimesInMicrosecondsAreReadAsSuch) {
  const std::string pair = Pair();
  ChangeStamps(pair + "/times.txt",
               [](size_t, double time) { return std::to_string(std::llround(time * 1e6)); });
  EXPECT_THAT(Run(pair).err, HasSubstr("read as microseconds"));
  EXPECT_EQ(Poses(), kFrames);
  EXPECT_LT(std::stod(DataLines(out_ + "/trajectory.txt").back()), 5);
}

TEST_F(LyingInput, ASecondRecordingInOneListIsACut) {
  const std::string room = Room();
  std::vector<std::string> rgb = DataLines(room + "/rgb.txt"),
                           depth = DataLines(room + "/depth.txt");
  // The first recording begins at 100 s, the second one at 0 with the same images.
  for (std::vector<std::string>* lines : {&rgb, &depth}) {
    const std::vector<std::string> second = *lines;
    for (std::string& line : *lines)
      line = std::to_string(100 + std::stod(line)) + line.substr(line.find(' '));
    lines->insert(lines->end(), second.begin(), second.end());
  }
  WriteLines(room + "/rgb.txt", rgb);
  WriteLines(room + "/depth.txt", depth);
  const ProgramResult result = Run(room);
  EXPECT_THAT(result.err, HasSubstr("treated as a cut"));
  const std::vector<std::string> poses = DataLines(out_ + "/trajectory.txt");
  EXPECT_GE(poses.size(), 2u * kFrames - 3);
  EXPECT_GT(std::stod(poses.front()), 99) << "the first recording comes first";
}

TEST_F(LyingInput, GrayOfTenBitsAndThermalImagesAreTracked) {
  for (const auto& [scale, offset] : {std::pair{4.0, 0.0}, {8.0, 28500.0}}) {
    const TempFolder folder;
    const std::string room =
        CopyOf(Rendered({"room", "--frames", std::to_string(kFrames), "--seed", "9"}), folder);
    ChangeImages(room + "/rgb", ReadImageGray, [by = scale, from = offset](const cv::Mat& image) {
      cv::Mat wide;
      image.convertTo(wide, CV_16U, by, from);
      return wide;
    });
    const ProgramResult result = Run(room);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(Poses(), kFrames) << scale;
    EXPECT_LT(Error(room), 0.01) << scale;
  }
}

TEST_F(LyingInput, DepthOfEightBitsIsNotUsed) {
  const std::string room = Room();
  ChangeImages(room + "/depth", ReadDepth, [](const cv::Mat& depth) {
    cv::Mat small;
    depth.convertTo(small, CV_8U, 1 / 200.0);
    return small;
  });
  const ProgramResult refused = Run(room, {"--sensor", "rgbd"});
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr("has 8 bits"));
  const ProgramResult result = Run(room);
  EXPECT_THAT(result.err, HasSubstr("has 8 bits"));
  EXPECT_THAT(result.err, HasSubstr("one camera alone is used"));
}

TEST_F(LyingInput, TheRangeOfDepthAndWhatWasAssumedAreTold) {
  const std::string room = Room();
  std::vector<std::string> camera;
  for (const std::string& line : ReadLines(room + "/camera.yaml")) {
    if (line.find("depth_factor") == std::string::npos) camera.push_back(line);
  }
  WriteLines(room + "/camera.yaml", camera);
  const ProgramResult result = Run(room);
  EXPECT_THAT(result.out, testing::ContainsRegex("Depth from [0-9.]+ to [0-9.]+ m, 5000 units per "
                                                 "meter assumed"));
  camera.push_back("depth_factor: 1");
  WriteLines(room + "/camera.yaml", camera);
  EXPECT_THAT(Run(room).err, HasSubstr("which no depth camera measures"));
}

TEST_F(LyingInput, DepthImagesOfAWholeFractionAreScaledUp) {
  const std::string room = Room();
  ChangeImages(room + "/depth", ReadDepth, [](const cv::Mat& depth) {
    cv::Mat small;
    cv::resize(depth, small, depth.size() / 4, 0, 0, cv::INTER_NEAREST);
    return small;
  });
  const ProgramResult result = Run(room);
  EXPECT_THAT(result.out, HasSubstr("are scaled up to"));
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(Poses(), kFrames);
  EXPECT_LT(Error(room), 0.01);
}

TEST_F(LyingInput, SwappedAndLatePairsAreToldAndOneCameraIsUsed) {
  const std::string pair = Pair();
  fs::rename(pair + "/image_0", pair + "/image_2");
  fs::rename(pair + "/image_1", pair + "/image_0");
  fs::rename(pair + "/image_2", pair + "/image_1");
  const ProgramResult result = Run(pair);
  EXPECT_THAT(result.err, HasSubstr("left and right images are swapped: one camera alone is used"));
  EXPECT_EQ(json::parse(ReadText(out_ + "/stats.json"), nullptr, false).value("sensor", ""),
            "mono");
  const ProgramResult refused = Run(pair, {"--sensor", "stereo"});
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr("--sensor stereo: the left and right images are swapped"));
}

TEST_F(LyingInput, SoundRecordingsAreNotWarnedOf) {
  EXPECT_EQ(Run(Room()).err, "");
  const TempFolder folder;
  EXPECT_EQ(Run(CopyOf(Rendered({"room", "--frames", std::to_string(kFrames), "--seed", "9",
                                 "--stereo", "--format", "kitti"}),
                       folder))
                .err,
            "");
}

TEST_F(LyingInput, ABaselineInMillimetersIsTold) {
  const std::string pair = Pair();
  std::vector<std::string> lines = ReadLines(pair + "/calib.txt");
  for (std::string& line : lines) {
    if (line.rfind("P1:", 0) != 0) continue;
    std::istringstream words(line);
    std::string word, changed;
    for (int i = 0; words >> word; ++i)
      changed += (i ? " " : "") + (i == 4 ? std::to_string(1000 * std::stod(word)) : word);
    line = changed;
  }
  WriteLines(pair + "/calib.txt", lines);
  EXPECT_THAT(Run(pair).err, HasSubstr("is the baseline in millimeters?"));
}

}  // namespace
}  // namespace alidade::lying_input_test
