// How `alidade run` plays: bad frames, Ctrl-C, recordings in which there is nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "alidade/io/files/trajectory_file.h"
#include "support/program.h"
#include "support/sliding_recording.h"

namespace alidade::run_loop_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunLoop : public testing::Test {
 protected:
  void WriteRecording(int frames = 12) {
    SlidingRecording options;
    options.frames = frames;
    WriteSlidingTum(recording_, options);
  }
  ProgramResult Run(std::vector<std::string> more = {},
                    const std::function<void(pid_t)>& while_running = nullptr) {
    std::vector<std::string> arguments = {"run", recording_.path(), "--out", out_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunAlidade(arguments, while_running);
  }
  nlohmann::json Stats() { return nlohmann::json::parse(ReadText(out_ + "/stats.json")); }
  void Blank(const cv::Mat& image, int frames) {
    for (int i = 0; i < frames; ++i) WriteImage(recording_ / SlidingImage(i), image);
  }

  TempFolder recording_, results_;
  const std::string out_ = results_ / "out";
};

TEST_F(RunLoop, QuietSaysNothing) {
  WriteRecording();
  recording_.Write(SlidingImage(6), "");
  const ProgramResult result = Run({"--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out + result.err, "");
  EXPECT_EQ(Stats()["warnings"].size(), 1u);
}

TEST_F(RunLoop, RepeatPlaysForthAndBack) {
  WriteRecording(6);
  ASSERT_EQ(Run({"--repeat", "2"}).status, 0);
  const Trajectory trajectory = ReadTrajectory(out_ + "/trajectory.txt");
  ASSERT_EQ(trajectory.size(), 21u);  // 6, then 5 for each of the three other ways
  EXPECT_LT(trajectory[10].T_world_camera.t.norm(), 0.010);
  EXPECT_LT((trajectory[15].T_world_camera.t - trajectory[5].T_world_camera.t).norm(), 0.010);
}

TEST_F(RunLoop, BlackImagesMapNothingAndStillGiveResults) {
  WriteRecording();
  Blank(cv::Mat(240, 320, CV_8UC1, cv::Scalar(0)), 12);
  const ProgramResult result = Run();
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("nothing could be mapped: the images are black"));
  EXPECT_EQ(LineCount(result.err), 1) << result.err;
  EXPECT_EQ(Stats()["tracked"], 0);
  EXPECT_TRUE(Stats()["initialized_at"].is_null());
  EXPECT_TRUE(fs::exists(out_ + "/report.html"));
}

TEST_F(RunLoop, ImagesWithoutCornersMapNothing) {
  WriteRecording();
  Blank(cv::Mat(240, 320, CV_8UC1, cv::Scalar(128)), 12);
  for (const char* sensor : {"rgbd", "mono"}) {
    const ProgramResult result = Run({"--sensor", sensor});
    EXPECT_EQ(result.status, 4);
    EXPECT_THAT(result.err, HasSubstr("nothing could be mapped: too few corners")) << sensor;
  }
}

TEST_F(RunLoop, RealtimeTakesAsLongAsTheRecording) {
  WriteRecording(16);
  ASSERT_EQ(Run({"--schedule", "threaded"}).status, 0);
  EXPECT_GE(Stats()["wall_s"], 15 / 30.0);
  // A busy machine may drop some.
  EXPECT_EQ(Stats()["tracked"].get<int>() + Stats()["late_frames"].get<int>(), 16);
}

TEST_F(RunLoop, LateFramesGiveWayToNewerOnes) {
  WriteRecording(16);
  const auto run = [&](const std::string& schedule) {
    ASSERT_EQ(
        Run({"--schedule", schedule, "--rate", "100000", "--set", "time.max_latency=0"}).status, 0);
    EXPECT_EQ(Stats()["frames"].get<int>() + Stats()["late_frames"].get<int>(), 16);
    EXPECT_GT(Stats()["tracked"], 0);
  };
  run("threaded");  // the first frame takes longer than all of them last
  EXPECT_GT(Stats()["late_frames"], 0);
  run("inline");
  EXPECT_EQ(Stats()["late_frames"], 0);
}

TEST_F(RunLoop, InterruptDoesNotWaitForTheNextFrame) {
  WriteRecording();
  const ProgramResult result = Run({"--rate", "0.01"}, [this](pid_t program) {
    while (!fs::exists(out_)) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    kill(program, SIGINT);
  });
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.out, HasSubstr("Interrupted"));
  EXPECT_LT(Stats()["frames"], 12);
  EXPECT_TRUE(fs::exists(out_ + "/trajectory.txt"));
  EXPECT_TRUE(fs::exists(out_ + "/report.html"));
}

}  // namespace
}  // namespace alidade::run_loop_test
