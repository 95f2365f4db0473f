// A camera that is blinded, carried away, or comes back another day: on a real recording. And one
// that is lost where places look alike: on a rendered one.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "alidade/io/files/image_file.h"
#include "support/rendered.h"

namespace alidade::lost_and_found_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string Kitchen() {
  const char* data = std::getenv("ALIDADE_DATA");
  return data == nullptr ? std::string() : std::string(data) + "/kitchen";
}

class LostAndFound : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (Kitchen().empty()) GTEST_SKIP() << "ALIDADE_DATA is not set";
  }

  // The kitchen by links to its files, its list of images changed. `change` is given the number of
  // a frame and its line, and returns the line to keep; an empty one leaves the frame out.
  template <typename Change>
  std::string Changed(Change&& change) {
    const std::string copy = folder_.Folder("kitchen");
    for (const auto& entry : fs::directory_iterator(Kitchen())) {
      const std::string name = entry.path().filename().string();
      if (name != "rgb.txt") fs::create_symlink(fs::absolute(entry.path()), copy + "/" + name);
    }
    WriteImage(copy + "/black.png", cv::Mat::zeros(480, 640, CV_8UC1));
    std::vector<std::string> lines;
    int number = 0;
    for (const std::string& line : DataLines(Kitchen() + "/rgb.txt")) {
      const std::string kept = change(number++, line);
      if (!kept.empty()) lines.push_back(kept);
    }
    WriteLines(copy + "/rgb.txt", lines);
    return copy;
  }

  std::string Run(const std::vector<std::string>& words) {
    const std::string out = folder_ / ("out" + std::to_string(runs_++));
    std::vector<std::string> arguments = words;
    for (const char* word : {"--sensor", GetParam(), "--quiet", "--out"}) arguments.push_back(word);
    arguments.push_back(out);
    const ProgramResult result = RunAlidade(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return out;
  }
  static json Stats(const std::string& out) { return json::parse(ReadText(out + "/stats.json")); }
  double Rmse(const std::string& out) const {
    const bool mono = std::string(GetParam()) == "mono";
    const ProgramResult result = RunAlidade({"evaluate", "ate", Kitchen(), out + "/trajectory.txt",
                                             "--json", "--align", mono ? "sim3" : "se3"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out)["rmse"].get<double>();
  }

  // The whole recording's error, metres, as measured when this was written.
  static double Unharmed() { return std::string(GetParam()) == "mono" ? 0.0354 : 0.0418; }

  TempFolder folder_;
  int runs_ = 0;
};

TEST_P(LostAndFound, SeesAgainSoonAfterTheDark) {
  const std::string out = Run({"run", Changed([](int number, const std::string& line) {
                                 if (number < 250 || number > 290) return line;
                                 return line.substr(0, line.find(' ')) + " black.png";
                               })});
  const json stats = Stats(out);
  ASSERT_EQ(stats["lost_spans"].size(), 1u);
  const double lost_until = stats["lost_spans"][0][1];
  EXPECT_LT(lost_until, 1000 + 291 / 30.0 + 15 / 30.0);
  EXPECT_EQ(stats["maps"], 1);
  EXPECT_GE(stats["relocalizations"], 1);
  EXPECT_LE(Rmse(out), 1.3 * Unharmed());
}

TEST_P(LostAndFound, MapsBeforeAndAfterAGapBecomeOne) {
  const std::string out = Run({"run", Changed([](int number, const std::string& line) {
                                 return number < 200 || number > 400 ? line : std::string();
                               })});
  EXPECT_EQ(Stats(out)["maps"], 1);
  EXPECT_LE(Rmse(out), 1.3 * Unharmed());
}

// A phone that is busy: 15 frames a second, and now and then none for .3 to 1 s, beside a carpet
// that is the same everywhere. What cannot be placed is left out: a quarter may be.
TEST_P(LostAndFound, FramesThatComeLateBendNothing) {
  const int held[] = {9, 29, 17, 23};
  int frames = 0;
  const std::string out =
      Run({"run", Changed([&](int number, const std::string& line) {
             if (number > 0 && (number % 2 == 1 || number % 50 < held[number / 50 % 4]))
               return std::string();
             ++frames;
             return line;
           })});
  EXPECT_EQ(Stats(out)["maps"], 1);
  EXPECT_GE(Stats(out)["tracked"], 0.75 * frames);
  // One camera: frames that were lost before the map began are placed in it from its first
  // keyframes on, 7 to 10 cm off. With the other frames alone it is within 1.3, too.
  EXPECT_LE(Rmse(out), 1.45 * Unharmed());
}

TEST_P(LostAndFound, LaterFramesAreFoundInASavedMapThatStaysAsItIs) {
  const std::string first = Run({"run", Kitchen(), "--last", "399"});
  const std::string map = first + "/map.alidade", before = ReadText(map);
  const std::string later = Run({"localize", Kitchen(), "--first", "400", "--map", map});
  EXPECT_GE(Stats(later)["tracked"], 190);  // 95 % of 200
  EXPECT_TRUE(ReadText(map) == before);
  EXPECT_FALSE(fs::exists(later + "/map.alidade"));
  // Both in the map's frame: as one trajectory they are as good as each.
  std::vector<std::string> lines = DataLines(first + "/trajectory.txt");
  for (const std::string& line : DataLines(later + "/trajectory.txt")) lines.push_back(line);
  WriteLines(later + "/trajectory.txt", lines);
  EXPECT_LE(Rmse(later), 0.06);
}

INSTANTIATE_TEST_SUITE_P(Kitchen, LostAndFound, testing::Values("rgbd", "mono"));

// Out and back in a corridor whose ends look alike. With the phone's profile both turns are lost:
// the near end was taken for the far one, by relocalisation or by merging the next map (3.2 m off).
// With the desktop's the loop was not looked for, since the last keyframes share the far end, and
// nothing else, with the first ones (.52 m).
TEST(Corridor, ItsEndsAreNotOnePlace) {
  const std::string corridor = Rendered({"corridor", "--frames", "500", "--fps", "15", "--width",
                                         "480", "--height", "360", "--seed", "4"});
  const TempFolder folder;
  for (const std::string profile : {"phone", "desktop"}) {
    SCOPED_TRACE(profile);
    const std::string out = folder / profile;
    const ProgramResult run = RunAlidade(
        {"run", corridor, "--sensor", "mono", "--profile", profile, "--quiet", "--out", out});
    ASSERT_EQ(run.status, 0) << run.err;
    const ProgramResult ate =
        RunAlidade({"evaluate", "ate", corridor, out, "--align", "sim3", "--json"});
    ASSERT_EQ(ate.status, 0) << ate.err;
    EXPECT_LT(json::parse(ate.out)["rmse"].get<double>(), 0.05);
    const json stats = json::parse(ReadText(out + "/stats.json"));
    EXPECT_GT(stats["tracked"], 420) << stats;
    if (profile == "desktop") {
      EXPECT_EQ(stats["loops"], 1) << stats;
    }
  }
}

}  // namespace
}  // namespace alidade::lost_and_found_test
