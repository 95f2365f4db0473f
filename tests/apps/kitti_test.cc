// Stereo outdoors, on real pairs: what people try first. Needs ALIDADE_DATA.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/rendered.h"

namespace alidade::kitti_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class KittiClip : public testing::Test {
 protected:
  void SetUp() override {
    if (DataFolder().empty()) GTEST_SKIP() << "ALIDADE_DATA is not set";
    clip_ = DataFolder() + "/kitti_clip";
  }
  // The ATE of a run with default settings, metres; all frames must be tracked.
  double RunAll(const std::string& recording, int frames) {
    const std::string out = folder_ / "out";
    const ProgramResult run = RunAlidade({"run", recording, "--quiet", "--out", out});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(json::parse(ReadText(out + "/stats.json"))["tracked"], frames);
    const ProgramResult judged = RunAlidade(
        {"evaluate", "ate", recording + "/poses.txt", out + "/trajectory.txt", "--json"});
    EXPECT_EQ(judged.status, 0) << judged.err;
    return json::parse(judged.out)["rmse"];
  }

  TempFolder folder_;
  std::string clip_;
};

// 60 m. Without a scale error of 0.7 % (which is in the recording's calibration: disparities fall
// short of what its true poses ask for, by that share at every distance) 3 cm would be left.
TEST_F(KittiClip, IsTrackedWhole) { EXPECT_LT(RunAll(clip_, 51), 0.14); }

// Every second pair: 2.4 m from frame to frame, and nothing known of it at the start.
TEST_F(KittiClip, IsTrackedAtTwiceTheSpeed) {
  const std::string fast = folder_.Folder("fast");
  std::vector<std::string> times, poses;
  const std::vector<std::string> all_times = DataLines(clip_ + "/times.txt"),
                                 all_poses = DataLines(clip_ + "/poses.txt");
  for (const char* side : {"image_0", "image_1"}) {
    std::vector<fs::path> images;
    for (const auto& entry : fs::directory_iterator(clip_ + "/" + side))
      images.push_back(entry.path());
    std::sort(images.begin(), images.end());
    fs::create_directories(fs::path(fast) / side);
    for (size_t i = 0; i < images.size(); i += 2)
      fs::create_symlink(fs::absolute(images[i]), fs::path(fast) / side / images[i].filename());
  }
  for (size_t i = 0; i < all_times.size(); i += 2) {
    times.push_back(all_times[i]);
    poses.push_back(all_poses[i]);
  }
  WriteLines(fast + "/times.txt", times);
  WriteLines(fast + "/poses.txt", poses);
  fs::copy(clip_ + "/calib.txt", fast + "/calib.txt");
  EXPECT_LT(RunAll(fast, 26), 0.25);  // with the first motion taken for a small one: 0.78
}

}  // namespace
}  // namespace alidade::kitti_test
