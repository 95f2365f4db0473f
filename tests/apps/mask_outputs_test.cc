// Masks of what was left out as moving: what a run leaves of them, and what becomes of an earlier
// one's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "alidade/base/error.h"
#include "alidade/io/files/image_file.h"
#include "alidade/run/results/mask_writer.h"
#include "support/program.h"
#include "support/rendered.h"
#include "support/small_disk.h"

namespace alidade::mask_outputs_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

std::set<std::string> FilesUnder(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    names.insert(fs::relative(entry.path(), folder).generic_string());
  return names;
}

constexpr char kStats[] = R"({"version": 1, "source": "x", "coverage": 1, "settings": {}})";

class MaskOutputs : public testing::Test {
 protected:
  static SourceFrame Frame(const std::string& stamp) {
    SourceFrame frame;
    frame.stamp = stamp;
    frame.time = std::stod(stamp);
    frame.image = cv::Mat(6, 8, CV_8U, cv::Scalar(100));
    return frame;
  }
  // Left half of a camera of half the size.
  static cv::Mat LeftHalf() {
    cv::Mat mask = cv::Mat::zeros(3, 4, CV_8U);
    mask.colRange(0, 2) = 255;
    return mask;
  }
  void WriteTwo(OutputFolder& folder) {
    MaskWriter masks(folder);
    masks.Write(Frame("1.50"), LeftHalf());
    masks.Write(Frame("2.50"), {});
    masks.Finish();
  }

  TempFolder temp_;
  std::string out_ = temp_ / "out";
};

TEST_F(MaskOutputs, HaveTheSizeOfTheFramesAndAList) {
  OutputFolder folder({out_});
  WriteTwo(folder);
  const std::string draft = folder.draft();
  EXPECT_THAT(FilesUnder(draft), ElementsAre("mask", "mask.txt", "mask/1.50.png", "mask/2.50.png"));
  EXPECT_EQ(ReadText(draft + "/mask.txt"),
            std::string(kMaskListHeader) + "1.50 mask/1.50.png\n2.50 mask/2.50.png\n");
  const cv::Mat first = ReadImageGray(draft + "/mask/1.50.png");
  ASSERT_EQ(first.size(), cv::Size(8, 6));
  EXPECT_EQ(cv::countNonZero(first), 24);
  EXPECT_EQ(cv::countNonZero(first.colRange(0, 4) == 255), 24);
  EXPECT_EQ(cv::countNonZero(ReadImageGray(draft + "/mask/2.50.png")), 0);
}

TEST_F(MaskOutputs, AreNotThereUntilTheyAreComplete) {
  OutputFolder folder({out_});
  {
    MaskWriter masks(folder);
    masks.Write(Frame("1.50"), LeftHalf());
    EXPECT_FALSE(fs::exists(folder.draft() + "/mask"));
    EXPECT_FALSE(fs::exists(folder.draft() + "/mask.txt"));
  }
  EXPECT_TRUE(FilesUnder(folder.draft()).empty());  // never finished
}

TEST_F(MaskOutputs, ThatCannotBeListedDoNotStay) {
  OutputFolder folder({out_});
  fs::create_directory(folder.draft() + "/mask.txt");  // in the way
  EXPECT_THROW(WriteTwo(folder), Error);
  EXPECT_THAT(FilesUnder(folder.draft()), ElementsAre("mask.txt"));
}

TEST_F(MaskOutputs, OfAnEarlierRunGoAndNobodyElses) {
  const auto run = [&](bool masks) {
    OutputFolder folder({out_});
    folder.Write("stats.json", kStats);
    if (masks) WriteTwo(folder);
    folder.Place(true);
  };
  run(true);
  EXPECT_THAT(FilesUnder(out_),
              ElementsAre("mask", "mask.txt", "mask/1.50.png", "mask/2.50.png", "stats.json"));
  temp_.Write("out/mask/mine.png", "a picture of my own");
  run(true);  // beside it
  EXPECT_THAT(FilesUnder(out_), ElementsAre("mask", "mask.txt", "mask/1.50.png", "mask/2.50.png",
                                            "mask/mine.png", "stats.json"));
  run(false);
  EXPECT_THAT(FilesUnder(out_), ElementsAre("mask", "mask/mine.png", "stats.json"));
  fs::remove(out_ + "/mask/mine.png");
  run(true);
  run(false);
  EXPECT_THAT(FilesUnder(out_), ElementsAre("stats.json"));
}

TEST_F(MaskOutputs, SomeoneElsesListStays) {
  temp_.Write("out/stats.json", kStats);
  temp_.Write("out/mask.txt", "# person masks\n1.50 mask/1.50.png\n");
  temp_.Write("out/mask/1.50.png", "a person's");
  OutputFolder folder({out_});
  folder.Write("stats.json", kStats);
  WriteTwo(folder);
  folder.Place(true);
  EXPECT_EQ(ReadText(out_ + "/mask.txt"), "# person masks\n1.50 mask/1.50.png\n");
  EXPECT_EQ(ReadText(out_ + "/mask/1.50.png"), "a person's");
  EXPECT_FALSE(fs::exists(out_ + "/mask/2.50.png"));  // not half of ours
}

TEST_F(MaskOutputs, OfARunThatWasKilledAreNoHindrance) {
  temp_.Write("out/mask.tmp123-0/1.50.png", "ours");
  OutputFolder folder({out_});
  EXPECT_FALSE(fs::exists(out_ + "/mask.tmp123-0"));
}

class MaskRun : public testing::Test {
 protected:
  static std::string Recording() {
    return Rendered({"desk", "--frames", "12", "--actors", "2", "--seed", "3"});
  }
  ProgramResult Run(std::vector<std::string> words) {
    words.insert(words.begin(), {"run", recording_, "--quiet", "--out", out_});
    return RunAlidade(words);
  }
  // Second fields of the lines of mask.txt.
  std::vector<std::string> Listed() {
    std::vector<std::string> names;
    for (const std::string& line : DataLines(out_ + "/mask.txt"))
      names.push_back(line.substr(line.find(' ') + 1));
    return names;
  }

  TempFolder temp_;
  std::string recording_ = Recording(), out_ = temp_ / "out";
};

TEST_F(MaskRun, LeavesAMaskForEveryFrame) {
  const ProgramResult result = Run({"--dynamics", "geometry", "--write-masks"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::vector<std::string> names = Listed();
  const std::vector<std::string> frames = DataLines(recording_ + "/rgb.txt");
  ASSERT_EQ(names.size(), frames.size());
  for (size_t i = 0; i < names.size(); ++i) {
    const std::string stamp = frames[i].substr(0, frames[i].find(' '));
    EXPECT_EQ(names[i], "mask/" + stamp + ".png");
    EXPECT_EQ(ReadImageSize(out_ + "/" + names[i]), cv::Size(640, 480));
  }
  // A run without masks clears them.
  ASSERT_EQ(Run({"--last", "3", "--overwrite"}).status, 0);
  EXPECT_FALSE(fs::exists(out_ + "/mask.txt"));
  EXPECT_FALSE(fs::exists(out_ + "/mask"));
}

TEST_F(MaskRun, ThatIsInterruptedLeavesThoseOfTheFramesSoFar) {
  const ProgramResult result =
      RunAlidade({"run", recording_, "--quiet", "--out", out_, "--dynamics", "geometry",
                  "--write-masks", "--repeat", "500"},
                 [&](pid_t child) {
                   const auto pictures = [&] {
                     std::error_code none;
                     int count = 0;
                     for (const auto& entry : fs::recursive_directory_iterator(out_, none))
                       count += entry.path().extension() == ".png";
                     return count;
                   };
                   for (int i = 0; i < 600 && pictures() < 3; ++i)  // a minute
                     usleep(100000);
                   kill(child, SIGINT);
                 });
  EXPECT_EQ(result.status, 130) << result.err;
  const auto stats = nlohmann::json::parse(ReadText(out_ + "/stats.json"), nullptr, false);
  const std::vector<std::string> names = Listed();
  EXPECT_GE(names.size(), 3u);
  EXPECT_EQ(names.size(), stats["frames"].get<size_t>());
  for (const std::string& name : names) EXPECT_TRUE(fs::exists(out_ + "/" + name)) << name;
}

TEST_F(MaskRun, PhonesMasksAreScaledToTheFrames) {
  const ProgramResult result =
      Run({"--dynamics", "geometry", "--write-masks", "--profile", "phone"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const std::string& name : Listed()) {
    const cv::Mat mask = ReadImageGray(out_ + "/" + name);
    EXPECT_EQ(mask.size(), cv::Size(640, 480));
    EXPECT_EQ(cv::countNonZero((mask != 0) & (mask != 255)), 0) << name;  // nothing in between
  }
}

TEST_F(MaskRun, AFullDiskLeavesAllOfThemOrNone) {
  // Full with the first masks; with the last; with what comes after them.
  for (const int kilobytes : {24, 56, 88, 120, 180}) {
    const std::string folder = temp_.Folder("disk" + std::to_string(kilobytes));
    const SmallDisk disk(folder, kilobytes);
    if (!disk.mounted()) GTEST_SKIP() << "mounting is not permitted here";
    out_ = folder + "/out";
    const ProgramResult result = Run({"--dynamics", "geometry", "--write-masks"});
    EXPECT_EQ(result.status, 3) << kilobytes;
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    if (!fs::exists(out_)) continue;
    const std::set<std::string> names = FilesUnder(out_);
    EXPECT_TRUE(names.count("stats.json")) << "what stays can be written over";
    EXPECT_EQ(names.count("mask"), names.count("mask.txt"));
    for (const std::string& name : names) EXPECT_EQ(name.find("tmp"), std::string::npos) << name;
  }
}

TEST_F(MaskRun, FramesThatAreSkippedHaveNone) {
  recording_ = CopyOf(Recording(), temp_);
  const std::string bad = DataLines(recording_ + "/rgb.txt")[5];
  const std::string stamp = bad.substr(0, bad.find(' '));
  temp_.Write("recording/" + bad.substr(bad.find(' ') + 1), "no picture");
  const ProgramResult result = Run({"--dynamics", "geometry", "--write-masks"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(Listed().size(), 11u);
  EXPECT_FALSE(fs::exists(out_ + "/mask/" + stamp + ".png"));
}

}  // namespace
}  // namespace alidade::mask_outputs_test
