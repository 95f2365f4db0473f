// Depth pictures and clouds of a run, and what becomes of those of an earlier one.
#include "alidade/run/results/semidense_outputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "alidade/base/error.h"
#include "alidade/io/files/image_file.h"
#include "support/read_text.h"
#include "support/temp_folder.h"

namespace alidade::semidense_outputs_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::set<std::string> FilesUnder(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.insert(fs::relative(entry.path(), folder).generic_string());
  }
  return names;
}

constexpr char kStats[] = R"({"version": 1, "source": "x", "coverage": 1})";

class SemiDenseOutputs : public testing::Test {
 protected:
  // Two maps; all keyframes but the third have depth: one pixel each, at (x, 5).
  SemiDenseOutputs() {
    results_.R_camera_rectified.setIdentity();
    MapStore store;
    store.Commit([&](MapCommit& commit) {
      for (int i = 0; i < 5; ++i) {
        KeyFrame keyframe;
        auto frame = std::make_shared<Frame>();
        frame->time = 100 + i;
        frame->number = i;
        keyframe.frame = frame;
        if (i > 0 && i != 4) keyframe.parent = ids_[0];
        keyframe.T_camera_world.t = {-1.0 * i, 0, 0};  // 1 m to the right of the one before
        keyframe.scale = 2;
        if (i != 2) {
          auto depth = std::make_shared<DepthMap>();
          depth->width = camera_.width;
          depth->height = camera_.height;
          depth->scale = 2;
          depth->pixels.push_back({static_cast<uint16_t>(10 + i), 5, 0.5f, 0.01f, {9, 8, 7}});
          keyframe.depth = depth;
        }
        ids_.push_back(commit.Add(keyframe));
      }
    });
    results_.map = store.Snapshot();
    const auto maps = results_.map.Maps();
    EXPECT_EQ(maps.size(), 2u);
    for (MapId id : maps) results_.maps.push_back({id, {}, {}, {}, {}});
    for (int i = 0; i < 5; ++i) {
      MapResults& map = results_.maps[i == 4];
      map.keyframe_ids.push_back(ids_[static_cast<size_t>(i)]);
      // The last came from a loaded map: nobody knows how its stamp was written.
      map.keyframes.push_back({100.0 + i, {}, i == 3 ? "" : "10" + std::to_string(i) + ".50"});
    }
  }

  // A run with depth, or without.
  Cloud Write(const std::string& path, bool depth = true) {
    OutputFolder folder({path});
    folder.Write("stats.json", kStats);
    const Cloud cloud = depth ? WriteSemiDense(folder, results_, camera_, 0.01) : Cloud();
    folder.Place(true);
    return cloud;
  }

  Camera camera_ = Camera::FromFieldOfView(64, 48, 60);
  std::vector<KeyFrameId> ids_;
  RunResults results_;
  TempFolder temp_;
};

TEST_F(SemiDenseOutputs, EachMapHasItsListAndCloudAndOneFolderHasThePictures) {
  const std::string out = temp_ / "out";
  const Cloud cloud = Write(out);
  EXPECT_THAT(FilesUnder(out),
              ElementsAre("depth.1.txt", "depth.txt", "depth/100.50.png", "depth/101.50.png",
                          "depth/103.000000000.png", "depth/104.50.png", "semidense.1.ply",
                          "semidense.ply", "stats.json"));
  EXPECT_EQ(ReadText(out + "/depth.txt"), std::string(kDepthListHeader) +
                                              "100.50 depth/100.50.png\n"
                                              "101.50 depth/101.50.png\n"
                                              "103.000000000 depth/103.000000000.png\n");
  EXPECT_EQ(ReadText(out + "/depth.1.txt"),
            std::string(kDepthListHeader) + "104.50 depth/104.50.png\n");
  const cv::Mat picture = ReadDepth(out + "/depth/101.50.png");
  EXPECT_EQ(picture.type(), CV_16UC1);
  EXPECT_EQ(picture.size(), cv::Size(64, 48));
  EXPECT_EQ(cv::countNonZero(picture), 1);
  EXPECT_EQ(picture.at<uint16_t>(5, 11), 10000);  // 2 m
  EXPECT_EQ(cloud.points.size(), 3u);
  EXPECT_EQ(ReadText(out + "/semidense.ply"), EncodePly(cloud, CloudFormat::kBinary));
  EXPECT_THAT(ReadText(out + "/semidense.ply"), HasSubstr("property float sigma\n"));
  EXPECT_THAT(ReadText(out + "/semidense.1.ply"), HasSubstr("element vertex 1\n"));
}

TEST_F(SemiDenseOutputs, CloudIsInTheWorldOfTheMountedCamera) {
  const std::vector<PlacedDepth> plain = DepthOf(results_, results_.maps[0]);
  ASSERT_EQ(plain.size(), 3u);
  EXPECT_LT((plain[1].T_world_camera.t - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  results_.R_camera_rectified = ExpSo3({0, 0, 1.570796326794896619});
  const std::vector<PlacedDepth> turned = DepthOf(results_, results_.maps[0]);
  EXPECT_LT((turned[1].T_world_camera.t - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  // As landmarks.ply: p_mounted = R p_rectified.
  const auto point = [&](const PlacedDepth& depth) {
    return Eigen::Vector3f(MakeDepthCloud({depth}, camera_, 0).points[0]);
  };
  const Eigen::Vector3f p = point(plain[1]), q = point(turned[1]);
  EXPECT_LT((q - Eigen::Vector3f(-p.y(), p.x(), p.z())).norm(), 1e-5f);
}

TEST_F(SemiDenseOutputs, NoDepthLeavesNoFile) {
  for (MapResults& map : results_.maps) map.keyframe_ids.clear();
  const std::string out = temp_ / "out";
  EXPECT_TRUE(Write(out).points.empty());
  EXPECT_THAT(FilesUnder(out), ElementsAre("stats.json"));
  EXPECT_FALSE(fs::exists(out + "/depth"));
}

TEST_F(SemiDenseOutputs, EarlierRunsPicturesGoAndNobodyElses) {
  const std::string out = temp_ / "out";
  Write(out);
  temp_.Write("out/depth/mine.png", "a picture of my own");
  temp_.Write("out/depth/101.50.png.tmp12-3", "half a picture");
  Write(out, false);
  EXPECT_THAT(FilesUnder(out), ElementsAre("depth/mine.png", "stats.json"));
  fs::remove_all(out + "/depth");
  Write(out);
  Write(out, false);
  EXPECT_FALSE(fs::exists(out + "/depth"));  // nothing else was in it
}

TEST_F(SemiDenseOutputs, DepthThatARunWithoutSemiDenseMappingDidNotWriteStays) {
  const std::string out = temp_ / "out";
  temp_.Write("out/stats.json", R"({"version": 1, "source": "x", "coverage": 1, "settings": {}})");
  temp_.Write("out/keyframes.txt", "100.50 0 0 0 0 0 0 1\n");
  temp_.Write("out/depth.txt", "# depth maps\n100.50 depth/100.50.png\n");
  temp_.Write("out/depth/100.50.png", "a sensor's");
  Write(out, false);
  EXPECT_THAT(FilesUnder(out), ElementsAre("depth.txt", "depth/100.50.png", "stats.json"));
}

TEST_F(SemiDenseOutputs, AFailureLeavesNoPictureWithoutAList) {
  const std::string out = temp_ / "out";
  OutputFolder folder({out});
  fs::create_directory(folder.draft() + "/depth.1.txt");  // in the way
  EXPECT_THROW(WriteSemiDense(folder, results_, camera_, 0.01), Error);
  EXPECT_TRUE(FilesUnder(folder.draft()).empty());
  EXPECT_FALSE(fs::exists(folder.draft() + "/depth"));
}

}  // namespace
}  // namespace alidade::semidense_outputs_test
