// Exports in meters, by a distance that the user knows.
#include <cmath>
#include <cstdio>
#include <sstream>

#include "alidade/evaluation/ate.h"
#include "alidade/io/files/trajectory_file.h"
#include "support/saved_map_command.h"

namespace alidade::scaled_export_test {
namespace {

// RMS distance of a trajectory to the truth without changing its lengths, meters.
double MetricError(const std::string& trajectory, const std::string& result) {
  AteSettings settings;
  settings.align = Alignment::kSe3;
  const std::string truth = result.substr(0, result.rfind('.')) + "/groundtruth.txt";
  return EvaluateAte(ReadTrajectory(truth), ReadTrajectory(trajectory), settings).error.rmse;
}

class ScaledExport : public SavedMapCommand {
 protected:
  // Two frames far apart and the true distance between their cameras.
  std::vector<std::string> Known(double times = 1) {
    const Trajectory truth =
        ReadTrajectory(result_.substr(0, result_.rfind('.')) + "/groundtruth.txt");
    const StampedPose& a = truth.front();
    const StampedPose* b = &a;
    const auto from_a = [&](const StampedPose& pose) {
      return (pose.T_world_camera.t - a.T_world_camera.t).norm();
    };
    for (const StampedPose& pose : truth) {
      if (from_a(pose) > from_a(*b)) b = &pose;
    }
    return {"--scale-by", FormatTime(a.time), FormatTime(b->time),
            std::to_string(times * from_a(*b))};
  }
  const std::string result_ = Result("mono");
};

TEST_F(ScaledExport, TrajectoriesAreInMeters) {
  const std::string units = folder_ / "units.txt", meters = folder_ / "meters.txt",
                    keyframes = folder_ / "keyframes.txt";
  Export(result_, "evo", units);
  Export(result_, "evo", meters, Known());
  Export(result_, "tum", keyframes, Known());
  EXPECT_GT(MetricError(units, result_), 0.05);
  EXPECT_LT(MetricError(meters, result_), 0.02);
  EXPECT_LT(MetricError(keyframes, result_), 0.02);
}

TEST_F(ScaledExport, AMapInMetersGivesPosesInMeters) {
  const std::string map = folder_ / "meters.alidade", out = folder_ / "localized";
  Export(result_, "map", map, Known());
  const std::string recording = result_.substr(0, result_.rfind('.'));
  const ProgramResult run = RunAlidade(
      {"localize", recording, "--map", map, "--sensor", "mono", "--out", out, "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_LT(MetricError(out + "/trajectory.txt", result_), 0.02);
}

TEST_F(ScaledExport, PointsKeepTheirPlaceInTheImages) {
  const std::string twice = folder_ / "twice", once = folder_ / "once";
  Export(result_, "colmap", once, Known());
  Export(result_, "colmap", twice, Known(2));
  const auto first = DataLines(once + "/sparse/0/points3D.txt"),
             second = DataLines(twice + "/sparse/0/points3D.txt");
  ASSERT_EQ(first.size(), second.size());
  for (size_t i = 0; i < first.size(); ++i) {
    double x = 0, y = 0, z = 0, x2 = 0, y2 = 0, z2 = 0;
    int id = 0;
    std::istringstream(first[i]) >> id >> x >> y >> z;
    std::istringstream(second[i]) >> id >> x2 >> y2 >> z2;
    const double length = std::hypot(x, y, z);
    EXPECT_NEAR(std::hypot(x2 - 2 * x, y2 - 2 * y, z2 - 2 * z) / length, 0, 1e-5);
  }
  EXPECT_EQ(DataLines(once + "/sparse/0/cameras.txt"), DataLines(twice + "/sparse/0/cameras.txt"));
}

TEST_F(ScaledExport, PlacesAreFramesLandmarksAndPoints) {
  const std::string plain = folder_ / "plain.txt";
  Export(result_, "colmap", folder_ / "model", {"--no-images"});
  const auto points = DataLines(folder_ / "model" + "/points3D.txt");
  std::vector<std::string> at;
  for (const std::string& line : {points.front(), points.back()}) {
    std::string id, x, y, z;
    std::istringstream(line) >> id >> x >> y >> z;
    at.push_back(x + "," + y + "," + z);
  }
  const std::string by_points = folder_ / "by_points.txt";
  Export(result_, "tum", plain);
  Export(result_, "tum", by_points, {"--scale-by", at[0], at[1], "3"});
  const Trajectory before = ReadTrajectory(plain), after = ReadTrajectory(by_points);
  double ax, ay, az, bx, by, bz;
  ASSERT_EQ(std::sscanf(at[0].c_str(), "%lf,%lf,%lf", &ax, &ay, &az), 3);
  ASSERT_EQ(std::sscanf(at[1].c_str(), "%lf,%lf,%lf", &bx, &by, &bz), 3);
  const double factor = 3 / std::hypot(ax - bx, ay - by, az - bz);
  const Eigen::Vector3d moved = after.back().T_world_camera.t - after.front().T_world_camera.t,
                        was = before.back().T_world_camera.t - before.front().T_world_camera.t;
  EXPECT_NEAR(moved.norm() / was.norm(), factor, 1e-4 * factor);
}

TEST_F(ScaledExport, WhatCannotBeIsSaid) {
  const std::string out = folder_ / "out.txt";
  const auto refused = [&](const std::string& a, const std::string& b, const std::string& meters,
                           const std::string& words) {
    ExpectRefused({"export", result_, "--to", "tum", out, "--scale-by", a, b, meters}, 2, words);
  };
  refused("0", "999", "1", "no frame within 0.1 s has a pose");
  refused("0", "0", "1", "both places are the same");
  refused("0,0,0", "0,0,1", "0", "positive number of meters");
  refused("0,0,0", "0,0,1", "far", "not a number of meters");
  refused("0,0", "0,0,1", "1", "not a point x,y,z");
  refused("there", "0,0,1", "1", "neither a time");
  refused("landmark:99999999", "0,0,1", "1", "not in the map");
  ExpectRefused({"export", Result("rgbd"), "--to", "tum", out, "--scale-by", "0,0,0", "0,0,1", "1"},
                2, "in meters already");
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace alidade::scaled_export_test
