#include "alidade/surface/occupancy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "alidade/base/error.h"
#include "problems/surface_truth.h"
#include "support/dense_views.h"
#include "support/expect_error.h"

namespace alidade::occupancy_test {
namespace {

// A camera 1 m above the floor looks 30° down along x, z up: at the floor, and at a wall with its
// lower edge at `bottom`, if it is nearer.
DenseView ViewOfWall(double x_wall, double bottom, double floor_depth = 0) {
  DenseView view = FlatView(0, 160, 120);
  const double down = M_PI / 6;
  view.T_world_camera.R.col(0) = -Eigen::Vector3d::UnitY();
  view.T_world_camera.R.col(1) = Eigen::Vector3d(-std::sin(down), 0, -std::cos(down));
  view.T_world_camera.R.col(2) = Eigen::Vector3d(std::cos(down), 0, -std::sin(down));
  view.T_world_camera.t = {0, 0, 1};
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      const Eigen::Vector3d ray = view.T_world_camera.R * view.camera.Unproject({u, v});
      const double floor = ray.z() < 0 ? (1 + floor_depth) / -ray.z() : INFINITY,
                   wall = x_wall / ray.x();
      const bool hits = wall < floor && 1 + wall * ray.z() > bottom;
      const double z = hits ? wall : floor;
      view.depth(v, u) = z < 20 ? static_cast<float>(z) : 0;
    }
  }
  return view;
}

int StateAt(const OccupancyPicture& picture, double x, double y) {
  const int column = static_cast<int>(std::floor((x - picture.x) / picture.cell)),
            row = static_cast<int>(std::floor((y - picture.y) / picture.cell));
  if (column < 0 || row < 0 || column >= picture.width || row >= picture.height) return -1;
  return picture.At(column, row);
}

OccupancyPicture PictureOf(const std::vector<DenseView>& views,
                           const OccupancySettings& settings = {}) {
  OccupancyMap map(settings, Se3());
  for (const DenseView& view : views) map.Add(view);
  return map.Picture();
}

TEST(Occupancy, FloorIsFreeWallsAreOccupiedTheRestIsUnknown) {
  const OccupancyPicture picture = PictureOf({ViewOfWall(2.02, 0), ViewOfWall(2.02, 0)});
  EXPECT_EQ(StateAt(picture, 1.5, 0), 0);
  EXPECT_EQ(StateAt(picture, 1.5, 0.5), 0);
  EXPECT_EQ(StateAt(picture, 2.02, 0), 100);
  EXPECT_EQ(StateAt(picture, 2.2, 0), -1);    // behind the wall
  EXPECT_EQ(StateAt(picture, 0.1, 0), -1);    // below the view
  EXPECT_EQ(StateAt(picture, 1.5, 1.9), -1);  // beside it
}

TEST(Occupancy, WhatHangsHigherThanTheRobotIsDrivenUnder) {
  OccupancySettings low;
  low.height = 0.3;
  const std::vector<DenseView> views(2, ViewOfWall(1.72, 0.4));
  EXPECT_EQ(StateAt(PictureOf(views), 1.72, 0), 100);
  EXPECT_EQ(StateAt(PictureOf(views, low), 1.72, 0), 0);
}

TEST(Occupancy, AHoleInTheFloorIsNotFree) {
  const std::vector<DenseView> views(4, ViewOfWall(50, 0, 0.5));  // all is half a meter lower
  for (const int8_t cell : PictureOf(views).cells) EXPECT_NE(cell, 0);
}

TEST(Occupancy, ThingsThatLeftAreForgotten) {
  std::vector<DenseView> views(3, ViewOfWall(1.52, 0));
  EXPECT_EQ(StateAt(PictureOf(views), 1.52, 0), 100);
  views.resize(3 + 15, ViewOfWall(2.52, 0));
  EXPECT_EQ(StateAt(PictureOf(views), 1.52, 0), 0);
}

// Uncertain by `inverse_sigma`, of which half is wrong: all readings are that much too far.
DenseView Uncertain(DenseView view, double inverse_sigma) {
  view.inverse_sigma = 0;
  view.inverse_sigmas = cv::Mat1f(view.depth.size(), static_cast<float>(inverse_sigma));
  for (float& z : view.depth) {
    if (z > 0) z = static_cast<float>(1 / (1 / z - inverse_sigma / 2));
  }
  return view;
}

TEST(Occupancy, FloorIsFreeWhereItsHeightIsSure) {
  // 1.5 m away the height has half a standard deviation of inverse depth times 1.5 m · 1 m.
  EXPECT_EQ(StateAt(PictureOf({Uncertain(ViewOfWall(50, 0), 0.01)}), 1.5, 0), 0);
  EXPECT_EQ(StateAt(PictureOf({Uncertain(ViewOfWall(50, 0), 0.04)}), 1.5, 0), -1);
}

TEST(Occupancy, UncertainReadingsMakeThickWalls) {
  const std::vector<DenseView> views(3, Uncertain(ViewOfWall(2.02, 0), 0.02));  // 9 cm at 2 m
  const OccupancyPicture picture = PictureOf(views);
  EXPECT_EQ(StateAt(picture, 2.02, 0), 100);
  EXPECT_EQ(StateAt(picture, 2.1, 0), 100);
}

void ExpectRoomAsItIs(const SynthSettings& room, DepthOf kind, double cell, double free) {
  const SynthRecording recording(room);
  const auto sensed = DenseViewsOf(recording, 25, kind),
             exact = DenseViewsOf(recording, 25, DepthOf::kExact);
  OccupancySettings settings;
  settings.cell = settings.clearance = cell;  // what is lower cannot be told from the floor
  const GridScore score = ScoreGrid(PictureOf(sensed, settings), settings, Se3(), exact,
                                    settings.SharpRange(sensed.front()));
  EXPECT_GT(score.free, 800);
  EXPECT_GE(score.FreeShare(), free);
  EXPECT_GE(score.WallShare(), 0.95);
  EXPECT_LT(score.walls_free, 0.01 * score.walls);
}

TEST(Occupancy, RoomIsAsItIsByADepthCamera) {
  ExpectRoomAsItIs(SynthDefaults("room"), DepthOf::kSensor, 0.05, 0.98);
}

TEST(Occupancy, RoomIsAsItIsByAStereoPair) {
  ExpectRoomAsItIs(SmallRoom(true), DepthOf::kStereo, 0.1, 0.95);
}

TEST(Occupancy, FilesAreThoseOfMapServer) {
  OccupancyPicture picture;
  picture.width = 3;
  picture.height = 2;
  picture.cell = 0.05;
  picture.x = -1.25;
  picture.y = 0.5;
  picture.cells = {0, 100, -1, 0, 0, 0};  // the second row has the larger y
  EXPECT_EQ(EncodeGridPgm(picture), std::string("P5\n3 2\n255\n\xfe\xfe\xfe\xfe\0\xcd", 17));
  const std::string yaml = EncodeGridYaml(picture, "it's.pgm", {"A note."});
  EXPECT_NE(yaml.find("# A note.\nimage: 'it''s.pgm'\nmode: trinary\nresolution: 0.05\n"
                      "origin: [-1.25, 0.5, 0]\nnegate: 0\noccupied_thresh: 0.65\n"),
            std::string::npos)
      << yaml;
}

TEST(Occupancy, RefusesSettingsThatCannotBe) {
  OccupancySettings settings;
  settings.height = settings.clearance;
  EXPECT_NE(MessageOf(ErrorKind::kUsage, [&] { OccupancyMap(settings, Se3()); }).find("height"),
            std::string::npos);
}

}  // namespace
}  // namespace alidade::occupancy_test
