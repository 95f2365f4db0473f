#include "alidade/io/trajectory.h"

#include <gtest/gtest.h>

#include "alidade/io/files/trajectory_file.h"
#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::trajectory_test {
namespace {

using testing::HasSubstr;

Se3 SomePose(int i) {
  Vector6d xi;
  xi << 0.1 * i, -0.2, 3 + i, 0.3, -0.1 * i, 0.2;
  return Se3::Exp(xi);
}

TEST(Trajectory, TumTextComesBack) {
  Trajectory trajectory;
  for (int i = 0; i < 4; ++i)
    trajectory.push_back({1305031229.5 + i, SomePose(i), i == 0 ? "" : "007." + std::to_string(i)});
  const std::string text = FormatTumTrajectory(trajectory);
  EXPECT_THAT(text, HasSubstr("\n1305031229.500000000 0.0"));
  EXPECT_THAT(text, HasSubstr("\n007.2 "));
  const Trajectory back = ParseTumTrajectory(text, "back");
  ASSERT_EQ(back.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_LT((back[i].T_world_camera.t - trajectory[i].T_world_camera.t).norm(), 2e-9);
    EXPECT_LT(RotationAngle(back[i].T_world_camera, trajectory[i].T_world_camera), 1e-7);
  }
  EXPECT_EQ(back[3].stamp, "007.3");
}

TEST(Trajectory, TumTextTakesCommentsTabsAndWindowsLineEnds) {
  const Trajectory t = ParseTumTrajectory(
      "\xef\xbb\xbf# head\r\n\r\n1.5\t1 2 3 0 0 0 1\r\n2.5, 4, 5, 6, 0, 0, 1, 0", "x");
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t[0].stamp, "1.5");
  EXPECT_EQ(t[1].T_world_camera.t.y(), 5);
  EXPECT_NEAR(t[1].T_world_camera.R(0, 0), -1, 1e-12);  // half a turn about z
}

TEST(Trajectory, BadLinesAreNamedWithFileAndLine) {
  const auto message = [](const char* text) {
    return MessageOf(ErrorKind::kInput, [&] { ParseTumTrajectory(text, "truth.txt"); });
  };
  EXPECT_THAT(message("# c\n1 0 0 nan 0 0 0 1\n"),
              HasSubstr("truth.txt:2: `nan` is not a finite number"));
  EXPECT_THAT(message("1 0 0 0 0 0 0\n"), HasSubstr("truth.txt:1: expected"));
  EXPECT_THAT(message("1 0 0 0 0 0 0 0\n"), HasSubstr("quaternion"));
  EXPECT_THAT(message("1 0 0 0x 0 0 0 1\n"), HasSubstr("`0x`"));
}

TEST(Trajectory, TumStampsThatCannotBeSecondsAreConverted) {
  const Trajectory poses = ParseTumTrajectory(
      "1403715273262142976 1 2 3 0 0 0 1\n1403715273312143104 1 2 3 0 0 0 1\n", "truth.txt");
  EXPECT_EQ(poses.at(0).stamp, "1403715273.262142976");
  EXPECT_NEAR(poses.at(1).time, 1403715273.312143, 1e-6);
}

TEST(Trajectory, OfResultsIsTheEstimateEvenWhereTheTruthLiesBesideIt) {
  const TempFolder folder;
  folder.Write("groundtruth.txt", "1 7 7 7 0 0 0 1\n");
  folder.Write("trajectory.txt", "1 2 3 4 0 0 0 1\n");
  EXPECT_EQ(ReadEstimate(folder.path()).at(0).T_world_camera.t, Eigen::Vector3d(2, 3, 4));
  EXPECT_EQ(ReadTrajectory(folder.path()).at(0).T_world_camera.t, Eigen::Vector3d(7, 7, 7));
}

TEST(Trajectory, OfTheBodyIsTakenToTheLeftCamera) {
  const TempFolder folder;
  folder.Write("mav0/state_groundtruth_estimate0/data.csv",
               "#timestamp, p_x, p_y, p_z, q_w, q_x, q_y, q_z, v...\n"
               "1403715273262142976,1,2,3,0.70710678118,0,0,0.70710678118,9,9,9\n");
  {
    WarningCatcher warnings;
    EXPECT_LT((ReadTrajectory(folder.path())[0].T_world_camera.t - Eigen::Vector3d(1, 2, 3)).norm(),
              1e-12);
    EXPECT_THAT(warnings.text(), HasSubstr("poses of the body"));
  }
  folder.Write("mav0/cam0/sensor.yaml",
               "%YAML:1.0\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, 0.5, 1, 0, 0, 0, 0, 0, "
               "1, 0, 0, 0, 0, 1]\n"
               "resolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458, 457, 367, 248]\n");
  const Trajectory t = ReadTrajectory(folder.path());
  ASSERT_EQ(t.size(), 1u);
  EXPECT_EQ(t[0].stamp, "1403715273.262142976");
  // The body looks along y (a quarter turn about z); the camera is 0.5 m in front of it and rotated
  // once more.
  EXPECT_LT((t[0].T_world_camera.t - Eigen::Vector3d(1, 2.5, 3)).norm(), 1e-9);
  EXPECT_NEAR(t[0].T_world_camera.R(0, 0), -1, 1e-9);
}

TEST(Trajectory, KittiPosesFindTheirTimes) {
  const TempFolder folder;
  const std::string poses = "1 0 0 1 0 1 0 2 0 0 1 3\n0 0 1 4 0 1 0 5 -1 0 0 6\n";
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(folder.Write("a.txt", poses)); }),
              HasSubstr("times.txt"));
  folder.Write("sequences/07/times.txt", "0.000000e+00\n1.037359e-01\n");
  const Trajectory t = ReadTrajectory(folder.Write("poses/07.txt", poses));
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t[1].stamp, "1.037359e-01");
  EXPECT_DOUBLE_EQ(t[1].time, 0.1037359);
  EXPECT_EQ(t[1].T_world_camera.t, Eigen::Vector3d(4, 5, 6));
  EXPECT_NEAR(t[1].T_world_camera.R(0, 2), 1, 1e-12);
  folder.Write("poses.txt", poses);
  folder.Write("times.txt", "0\n");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(folder.path()); }),
              HasSubstr("2 poses"));
  folder.Write("times.txt", "0\n1\n");
  folder.Write("poses.txt", "1 0 0 1 0 2 0 2 0 0 1 3\n1 0 0 1 0 1 0 2 0 0 1 3\n");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(folder.path()); }),
              HasSubstr("poses.txt:1: the left 3x3 part is not a rotation"));
}

TEST(Trajectory, FilesThatHoldNoneSaySo) {
  const TempFolder folder;
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(folder.path()); }),
              HasSubstr("no trajectory in"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(folder / "x.txt"); }),
              HasSubstr("x.txt"));
  EXPECT_THAT(
      MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(folder.Write("x.txt", "# none\n")); }),
      HasSubstr("contains no poses"));
}

}  // namespace
}  // namespace alidade::trajectory_test
