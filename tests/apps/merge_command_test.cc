// `alidade merge`: maps of several recordings become one, and their trajectories come with them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"
#include "support/rendered.h"

namespace alidade::merge_command_test {
namespace {

using testing::HasSubstr;

ProgramResult Merge(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "merge");
  return RunAlidade(arguments);
}

double Rmse(const std::string& truth, const std::string& estimate, const std::string& align) {
  const ProgramResult ate =
      RunAlidade({"evaluate", "ate", truth, estimate, "--align", align, "--json"});
  EXPECT_EQ(ate.status, 0) << ate.err;
  return nlohmann::json::parse(ate.out)["rmse"].get<double>();
}

class MergeCommand : public testing::Test {
 protected:
  // Two visits of one rendered room, one by weaker light, in a recording each; another place.
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    const std::string room = "synth:room?frames=200&width=320&height=240";
    Run(room, "noon", {"--sensor", "rgbd", "--last", "119"});
    Run(room + "&light=0.6", "evening", {"--sensor", "rgbd", "--first", "70"});
    Run("synth:desk?frames=40&width=320&height=240", "desk", {"--sensor", "rgbd"});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static void Run(const std::string& source, const std::string& name,
                  std::vector<std::string> options) {
    options.insert(options.begin(), {"run", source, "--out", *folder_ / name});
    ASSERT_EQ(RunAlidade(options).status, 0);
  }
  static TempFolder* folder_;
  const std::string noon_ = *folder_ / "noon", evening_ = *folder_ / "evening",
                    desk_ = *folder_ / "desk";
};
TempFolder* MergeCommand::folder_ = nullptr;

TEST_F(MergeCommand, TwoVisitsAreOneMapAndOneTrajectory) {
  const std::string out = *folder_ / "both";
  const ProgramResult result = Merge({noon_, evening_ + "/", "--out", out});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              HasSubstr("noon and evening show the same place and are merged into one map"));
  const auto json = nlohmann::json::parse(ReadText(out + "/merge.json"));
  EXPECT_EQ(json["worlds"].size(), 1u);
  EXPECT_EQ(json["joins"].size(), 1u);
  EXPECT_EQ(DataLines(out + "/noon.txt").size(), DataLines(noon_ + "/trajectory.txt").size());
  // Frames of both, in one world: stamps of the second visit after those of the first, so that the
  // truth of both can be laid on all at once.
  const auto later = [](const std::vector<std::string>& lines) {
    std::vector<std::string> shifted;
    for (const std::string& line : lines) {
      const size_t blank = line.find(' ');
      shifted.push_back(std::to_string(std::stod(line.substr(0, blank)) + 1000) +
                        line.substr(blank));
    }
    return shifted;
  };
  std::vector<std::string> all = DataLines(out + "/noon.txt"),
                           truth = DataLines(noon_ + "/groundtruth.txt");
  for (const std::string& line : later(DataLines(out + "/evening.txt"))) all.push_back(line);
  for (const std::string& line : later(DataLines(evening_ + "/groundtruth.txt")))
    truth.push_back(line);
  WriteLines(*folder_ / "all.txt", all);
  WriteLines(*folder_ / "truth.txt", truth);
  // As good as one recording of all that both saw.
  Run("synth:room?frames=200&width=320&height=240", "one", {"--sensor", "rgbd"});
  const double one = Rmse(*folder_ / "one/groundtruth.txt", *folder_ / "one", "se3");
  EXPECT_LT(Rmse(*folder_ / "truth.txt", *folder_ / "all.txt", "se3"), 1.2 * one);
}

TEST_F(MergeCommand, AnotherPlaceStaysAMapOfItsOwn) {
  const std::string out = *folder_ / "apart.alidade";
  const ProgramResult result = Merge({noon_ + "/map.alidade", desk_, "--out", out});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              HasSubstr("desk shares no place with the others and remains a separate map"));
  EXPECT_THAT(result.out, HasSubstr("2 maps of 2 recordings"));
  EXPECT_THAT(RunAlidade({"info", out}).out, HasSubstr("2"));
  const auto json = nlohmann::json::parse(ReadText(*folder_ / "apart.trajectories/merge.json"));
  EXPECT_EQ(json["worlds"].size(), 2u);
  // Of a map alone: its keyframes; of a folder: its frames, unmoved.
  EXPECT_EQ(json["recordings"][0]["trajectories"][0]["of"], "keyframes");
  EXPECT_EQ(json["recordings"][1]["trajectories"][0]["of"], "frames");
  EXPECT_LT(Rmse(desk_ + "/trajectory.txt", *folder_ / "apart.trajectories/desk.txt", "none"),
            1e-6);
}

// The same walls and furniture in the same places; other pictures, books, floor and cloths.
TEST_F(MergeCommand, ARoomOfTheSameMakeStaysAMapOfItsOwn) {
  for (const char* sensor : {"rgbd", "mono"}) {
    SCOPED_TRACE(sensor);
    std::vector<std::string> rooms;
    for (const char* seed : {"1", "2"}) {
      const std::string name = std::string("room") + seed + sensor;
      Run(std::string("synth:room?frames=150&width=320&height=240&seed=") + seed, name,
          {"--sensor", sensor});
      rooms.push_back(*folder_ / name);
    }
    const std::string out = *folder_ / (std::string("rooms_") + sensor);
    const ProgramResult result = Merge({rooms[0], rooms[1], "--out", out});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out,
                HasSubstr("shares no place with the others and remains a separate map"));
    EXPECT_EQ(nlohmann::json::parse(ReadText(out + "/merge.json"))["worlds"].size(), 2u);
  }
}

TEST_F(MergeCommand, GivesTheSameBytesInAnyOrder) {
  ASSERT_EQ(Merge({noon_, evening_, desk_, "--out", *folder_ / "x.alidade"}).status, 0);
  ASSERT_EQ(Merge({desk_, evening_, noon_, "--out", *folder_ / "y.alidade"}).status, 0);
  EXPECT_EQ(ReadText(*folder_ / "x.alidade"), ReadText(*folder_ / "y.alidade"));
}

TEST_F(MergeCommand, SaysWhatCannotBe) {
  const std::string out = *folder_ / "never";
  const auto complaint = [&](std::vector<std::string> maps, int status) {
    maps.insert(maps.end(), {"--out", out});
    const ProgramResult result = Merge(maps);
    EXPECT_EQ(result.status, status);
    EXPECT_EQ(LineCount(result.err), 1);
    EXPECT_FALSE(std::filesystem::exists(out));
    return result.err;
  };
  EXPECT_THAT(complaint({noon_}, 2), HasSubstr("two maps or more"));
  EXPECT_THAT(complaint({noon_, noon_ + "/map.alidade"}, 3), HasSubstr("are the same map"));
  EXPECT_THAT(complaint({noon_, *folder_ / "nowhere"}, 3), HasSubstr("nowhere"));
  Run("synth:desk?frames=60&width=320&height=240", "mono", {"--sensor", "mono"});
  EXPECT_THAT(complaint({noon_, *folder_ / "mono"}, 3), HasSubstr("mono camera"));
  Run("synth:desk?frames=20&width=400&height=300", "wide", {"--sensor", "rgbd"});
  EXPECT_THAT(complaint({noon_, *folder_ / "wide"}, 3), HasSubstr("width"));
}

}  // namespace
}  // namespace alidade::merge_command_test
