// `alidade georeference` of a rendered run of one camera: every file lands on the true world.
#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>

#include "alidade/evaluation/ate.h"
#include "alidade/io/cloud.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/map/map_file.h"
#include "alidade/run/folder/own_files.h"
#include "support/read_text.h"
#include "support/saved_map_command.h"

namespace alidade::georeference_test {
namespace {

class GeoreferenceCommand : public SavedMapCommand {
 protected:
  void SetUp() override {
    fs::copy(plain_, result_, fs::copy_options::recursive);
    const std::string recording = plain_.substr(0, plain_.rfind('.'));
    truth_ = ReadTrajectory(recording + "/groundtruth.txt");
  }
  // True positions; every fifth one is an outlier.
  std::string Positions(double offset, size_t count = 1000) {
    const std::string file = folder_ / "positions.csv";
    std::ofstream out(file);
    out << "t,x,y,z\n";
    for (size_t i = 0; i < std::min(count, truth_.size()); ++i) {
      Eigen::Vector3d p = truth_[i].T_world_camera.t;
      if (i % 5 == 3) p += Eigen::Vector3d(1, -2, 1.5);
      out << FormatTime(truth_[i].time + offset) << ',' << p.x() << ',' << p.y() << ',' << p.z()
          << '\n';
    }
    return file;
  }
  double AbsoluteError(const std::string& file) const {
    AteSettings settings;
    settings.align = Alignment::kNone;
    return EvaluateAte(truth_, ReadTrajectory(file), settings).error.rmse;
  }
  // A run that turns enough to tell the rotation.
  static std::string Desk() {
    const std::string recording =
        Rendered({"desk", "--frames", "90", "--width", "320", "--height", "240"});
    const std::string out = recording + ".mono";
    if (fs::exists(out)) return out;
    const std::string draft = out + "." + std::to_string(getpid());
    const ProgramResult run = RunAlidade(
        {"run", recording, "--sensor", "mono", "--profile", "phone", "--out", draft, "--quiet"});
    EXPECT_EQ(run.status, 0) << run.err;
    std::error_code taken;  // another test process made the same map
    fs::rename(draft, out, taken);
    if (taken) fs::remove_all(draft);
    return out;
  }
  const std::string plain_ = Desk(), result_ = folder_ / "walk",
                    moved_ = result_ + "-georeferenced";
  Trajectory truth_;
};

TEST_F(GeoreferenceCommand, EveryFileIsInTheWorldOfThePositions) {
  cv::Mat depth(4, 5, CV_16UC1, cv::Scalar(5000));
  fs::create_directories(result_ + "/depth");
  std::ofstream(result_ + "/depth/1.png", std::ios::binary) << EncodePng(depth);
  std::ofstream(result_ + "/depth.txt") << kDepthListHeader << "1 depth/1.png\n";
  const ProgramResult run = RunAlidade({"georeference", result_, "--to", Positions(2.5)});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("left out as outliers"));
  EXPECT_LT(AbsoluteError(moved_ + "/trajectory.txt"), 0.02);
  EXPECT_LT(AbsoluteError(moved_ + "/keyframes.txt"), 0.02);
  EXPECT_LT(AbsoluteError(moved_ + "/trajectory_live.txt"), 0.06);

  const SavedMap map = DecodeMap(ReadText(moved_ + "/map.alidade"));
  const MapWorld* world = map.map.WorldOf(map.map.Maps().front());
  ASSERT_NE(world, nullptr);
  EXPECT_TRUE(world->meters);
  EXPECT_EQ(world->down, -Eigen::Vector3d::UnitZ());
  const Cloud points = DecodePly(ReadText(moved_ + "/landmarks.ply"), "landmarks.ply");
  const std::vector<LandmarkId> ids = map.map.Landmarks();
  ASSERT_EQ(points.points.size(), ids.size());
  for (size_t i = 0; i < ids.size(); ++i) {
    const Eigen::Vector3d& p = map.map.Find(ids[i])->p_world;
    EXPECT_LT((points.points[i].cast<double>() - p).norm(), 1e-3 * (1 + p.norm()));
  }
  const json stats = json::parse(ReadText(moved_ + "/stats.json"));
  const json& found = stats["georeference"]["maps"][0];
  const double scale = found["scale"];
  EXPECT_NEAR(found["time_offset"].get<double>(), 2.5, 0.02);
  EXPECT_EQ(stats["scale"]["known"], true);
  EXPECT_EQ(stats["gravity"], json({0, 0, -1}));
  const DecodedImage scaled = DecodeImageBytes(ReadText(moved_ + "/depth/1.png"), ImageUse::kDepth);
  EXPECT_NEAR(scaled.image.at<uint16_t>(2, 2), std::min(65535., 5000 * scale), 1);
  EXPECT_TRUE(fs::exists(moved_ + "/report.html"));

  // It is a result like any other, and is replaced by the next call.
  const std::string again = folder_ / "again.txt";
  Export(moved_, "evo", again);
  EXPECT_LT(AbsoluteError(again), 0.02);
  EXPECT_EQ(RunAlidade({"georeference", result_, "--to", Positions(0), "--quiet"}).status, 0);
}

TEST_F(GeoreferenceCommand, TheCameraIsFoundInTheMovedMap) {
  ASSERT_EQ(RunAlidade({"georeference", result_, "--to", Positions(0), "--quiet"}).status, 0);
  const std::string recording = plain_.substr(0, plain_.rfind('.')), out = folder_ / "found";
  const ProgramResult run =
      RunAlidade({"localize", recording, "--map", moved_ + "/map.alidade", "--sensor", "mono",
                  "--profile", "phone", "--out", out, "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_LT(AbsoluteError(out + "/trajectory.txt"), 0.02);
  const json stats = json::parse(ReadText(out + "/stats.json"));
  EXPECT_EQ(stats["scale"]["known"], true);
}

TEST_F(GeoreferenceCommand, WhatIsNotObservableIsRefusedAndNothingIsWritten) {
  ExpectRefused({"georeference", result_, "--to", Positions(0, 4)}, 3, "too few positions");
  ExpectRefused({"georeference", result_, "--to", Positions(0), "--out", result_}, 2,
                "is the result itself");
  ExpectRefused({"georeference", folder_ / "none", "--to", Positions(0)}, 3, "not a result folder");
  const std::string readings = folder_ / "imu.csv";
  std::ofstream file(readings);
  file << "t,wx,wy,wz,ax,ay,az\n";
  for (int i = 0; i < 600; ++i) file << 0.005 * i << ",0.01,0,0.001,0.1,9.8,0.2\n";
  file.close();
  const ProgramResult run = RunAlidade({"georeference", result_, "--to", readings});
  EXPECT_EQ(run.status, 3);
  EXPECT_FALSE(fs::exists(moved_));
}

}  // namespace
}  // namespace alidade::georeference_test
