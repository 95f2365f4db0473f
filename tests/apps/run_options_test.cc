// What `alidade run` says to options and settings that cannot be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/program.h"
#include "support/sliding_recording.h"

namespace alidade::run_options_test {
namespace {

using testing::HasSubstr;

class RunOptions : public testing::Test {
 protected:
  RunOptions() { WriteSlidingTum(recording_); }

  ProgramResult Run(std::vector<std::string> more) {
    std::vector<std::string> arguments = {"run", recording_.path(), "--out", results_ / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunAlidade(arguments);
  }

  void ExpectError(int status, const std::vector<std::string>& more, const std::string& words) {
    const ProgramResult result = Run(more);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(results_ / "out"));
  }

  nlohmann::json Settings() {
    return nlohmann::json::parse(ReadText(results_ / "out/stats.json"))["settings"];
  }

  TempFolder recording_, results_;
};

TEST_F(RunOptions, UnknownSettingNamesTheNearest) {
  ExpectError(2, {"--set", "tracker.min_trackd=20"}, "did you mean 'tracker.min_tracked'");
  ExpectError(2, {"--set", "seed"}, "expected name=value");
  ExpectError(2, {"--set", "tracker.min_tracked=many"}, "'many' is not a whole number");
}

TEST_F(RunOptions, SettingsOfTheStreamAreGivenAndListedAsAllOthers) {
  const std::string file =
      results_.Write("settings.yaml", "stream:\n  picture_width: 200\n  waiting: 4\nseed: 5\n");
  ASSERT_EQ(Run({"--last", "3", "--config", file, "--set", "expert.stream.max_waiting=5", "--set",
                 "look.min_brightness=30", "--record"})
                .status,
            0);
  const nlohmann::json settings = Settings();
  EXPECT_EQ(settings["stream.picture_width"], 200);
  EXPECT_EQ(settings["expert.stream.max_waiting"], 5);
  EXPECT_EQ(settings["look.min_brightness"], 30);
  EXPECT_EQ(settings["stream.pictures_hz"], 10);  // as it is by itself
  EXPECT_EQ(settings["seed"], 5);
  EXPECT_THAT(ReadText(results_ / "out/report.html"), HasSubstr("stream.picture_width"));
  const size_t with_pictures = std::filesystem::file_size(results_ / "out/run.stream");
  ASSERT_EQ(Run({"--last", "3", "--set", "stream.pictures_hz=0", "--record"}).status, 0);
  EXPECT_LT(std::filesystem::file_size(results_ / "out/run.stream"), with_pictures);
}

TEST_F(RunOptions, SettingsOfTheStreamThatCannotBeAreRefused) {
  ExpectError(2, {"--set", "stream.picture_widht=200"}, "did you mean 'stream.picture_width'");
  ExpectError(2, {"--set", "expert.stream.max_waiting=few"}, "'few' is not a whole number");
  ExpectError(2, {"--set", "stream.picture_quality=0"},
              "stream.picture_quality must be from 1 to 100");
  ExpectError(2, {"--set", "expert.stream.edge_shared=0", "--record"},
              "expert.stream.edge_shared must be");
  ExpectError(2, {"--set", "look.blurr=0.3"}, "did you mean 'look.blur'");
  ExpectError(2, {"--set", "look.min_brightness=256"},
              "look.min_brightness must be from 0 to 255, not 256");
}

TEST_F(RunOptions, NamesOfTheLastVersionAreAcceptedWithAWarning) {
  const std::string file = results_.Write(
      "old.yaml", "tracker:\n  unproven_frames: 3\n  keyframe_max_gap: 25\nloop.group: 8\n");
  const ProgramResult result = Run({"--last", "3", "--config", file, "--set", "early.most=9"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json settings = Settings();
  EXPECT_EQ(settings["expert.tracker.unconfirmed_frames"], 3);
  EXPECT_EQ(settings["tracker.max_keyframe_gap"], 25);
  EXPECT_EQ(settings["early.max_frames"], 9);
  for (const char* part :
       {"tracker.unproven_frames is now called expert.tracker.unconfirmed_frames",
        "loop.group no longer exists", "early.most is now called"})
    EXPECT_THAT(result.err, HasSubstr(part));
}

TEST_F(RunOptions, AMapThatCannotBeReadIsSaid) {
  ExpectError(3, {"--load", results_ / "none.alidade"}, "none.alidade");
}

TEST_F(RunOptions, UnknownOptionAndWordNameTheNearest) {
  ExpectError(2, {"--shedule", "inline"}, "did you mean '--schedule'");
  ExpectError(2, {"--schedule", "inlin"}, "did you mean 'inline'");
  ExpectError(2, {"--sensor", "rgb-d"}, "did you mean 'rgbd'");
  ExpectError(2, {"--profile", "tablet"}, "phone");
  ExpectError(2, {"--rate", "fast"}, "--rate");
  ExpectError(2, {"--rate", "-3"}, "--rate");
}

TEST_F(RunOptions, DynamicsFlagsThatDoNotGoTogetherAreRefused) {
  ExpectError(2, {"--dynamics", "full"}, "needs --detector");
  ExpectError(2, {"--dynamics", "geometry", "--detector", "model.onnx"}, "--detector");
  ExpectError(2, {"--write-masks"}, "requires --dynamics");
  ExpectError(2, {"--dynamics", "ful"}, "did you mean");
  ExpectError(3, {"--detector", "no_such_model.onnx"}, "no_such_model.onnx");
}

TEST_F(RunOptions, SemiDenseMappingIsAFlagAndASetting) {
  ASSERT_EQ(Run({"--last", "3", "--semidense"}).status, 0);
  EXPECT_EQ(Settings()["semidense.enabled"], 1);
  ASSERT_EQ(Run({"--last", "3", "--set", "semidense.enabled=1"}).status, 0);
  EXPECT_EQ(Settings()["semidense.enabled"], 1);
  ASSERT_EQ(Run({"--last", "3"}).status, 0);
  EXPECT_EQ(Settings()["semidense.enabled"], 0);
  EXPECT_THAT(ReadText(results_ / "out/report.html"), HasSubstr(" --last 3 --semidense"));
}

TEST_F(RunOptions, LocalizeMapsNoShape) {
  const ProgramResult result = RunAlidade({"localize", recording_.path(), "--map", "any.alidade",
                                           "--semidense", "--out", results_ / "out"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("--semidense"));
  EXPECT_EQ(LineCount(result.err), 1) << result.err;
}

TEST_F(RunOptions, ConfigFileErrorsSayFileAndLine) {
  const std::string file =
      results_.Write("settings.yaml", "tracker:\n  min_tracked: 20\n  min_keyframe_gp: 3\n");
  ExpectError(2, {"--config", file},
              file +
                  ":3: unknown setting 'tracker.min_keyframe_gp'; did you mean "
                  "'tracker.min_keyframe_gap'");
  ExpectError(2, {"--config", results_.Write("b.yaml", "seed: 1\ntracker.min_tracked: [1, 2]\n")},
              "b.yaml:2: setting tracker.min_tracked needs one value");
  ExpectError(2, {"--config", results_.Write("c.yaml", "\nimage_width: wide\n")}, "c.yaml:2: ");
  ExpectError(3, {"--config", results_.Write("d.yaml", "a: 1\nb: {\n")}, "d.yaml:");
  ExpectError(3, {"--config", results_ / "none.yaml"}, "none.yaml");
}

TEST_F(RunOptions, LaterOnesHold) {
  const std::string file = results_.Write(
      "settings.yaml", "seed: 5\ntracker:\n  extractor:\n    features: 700\nstart.window: 0.4\n");
  const ProgramResult result = Run(
      {"--profile", "phone", "--config", file, "--set", "expert.start.window=0.25", "--seed", "9"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json settings = Settings();
  EXPECT_EQ(settings["profile"], "phone");
  EXPECT_EQ(settings["image_width"], 400);                 // the profile's
  EXPECT_EQ(settings["tracker.extractor.features"], 700);  // the file's, over the profile's 500
  EXPECT_EQ(settings["expert.start.window"], 0.25);        // --set over the file's
  EXPECT_EQ(settings["seed"], 9);                          // the flag over the file's
}

TEST_F(RunOptions, DynamicsOffIsTheDefault) { EXPECT_EQ(Run({"--dynamics", "off"}).status, 0); }

}  // namespace
}  // namespace alidade::run_options_test
