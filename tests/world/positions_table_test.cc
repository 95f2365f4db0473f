#include "alidade/run/world/positions_table.h"

#include <gtest/gtest.h>

#include "support/expect_error.h"

namespace alidade::positions_table_test {
namespace {

TEST(PositionsTable, ColumnsAreThoseNamed) {
  const PositionsTable table =
      ParsePositions("note,z,timestamp [ms],x,y\na,3,1500,1,2\nb,6,500,4,5\nc,,,,\n", "p.csv");
  ASSERT_EQ(table.positions.size(), 2u);
  EXPECT_EQ(table.positions[0].time, 0.5);  // in order of time
  EXPECT_EQ(table.positions[0].p, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(table.positions[1].p, Eigen::Vector3d(1, 2, 3));
  EXPECT_NE(table.told.find("1 line is no position"), std::string::npos);
  EXPECT_FALSE(table.origin);
}

TEST(PositionsTable, WithoutNamesItIsTimeAndThreeCoordinates) {
  const PositionsTable tum = ParsePositions("# timestamp tx ty tz qx qy qz qw\n1 2 3 4 0 0 0 1\n",
                                            "truth.txt"),
                       plain = ParsePositions("1 2 3 4\n", "plain.txt");
  EXPECT_EQ(tum.positions.front().p, Eigen::Vector3d(2, 3, 4));
  EXPECT_EQ(plain.positions.front().p, Eigen::Vector3d(2, 3, 4));
  const PositionsTable euroc = ParsePositions(
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w []\n"
      "1403636580838555648,1,2,3,1\n",
      "data.csv");
  EXPECT_NEAR(euroc.positions.front().time, 1403636580.838556, 1e-6);
}

// One arc second of latitude is 30.8 m, of longitude 30.9 m times the cosine of the latitude.
TEST(PositionsTable, PlacesOnTheEarthAreEastNorthUp) {
  const PositionsTable table = ParsePositions(
      "time_s,latitude,longitude,altitude\n0,47,8,400\n1,47.000277778,8,400\n"
      "2,47,8.000277778,400\n3,47,8,407.5\n",
      "gnss.csv");
  ASSERT_TRUE(table.origin);
  EXPECT_EQ(table.origin->latitude, 47);
  const auto& p = table.positions;
  EXPECT_LT(p[0].p.norm(), 1e-9);
  EXPECT_LT((p[1].p - Eigen::Vector3d(0, 30.88, 0)).norm(), 0.02);
  EXPECT_LT((p[2].p - Eigen::Vector3d(21.13, 0, 0)).norm(), 0.02);
  EXPECT_LT((p[3].p - Eigen::Vector3d(0, 0, 7.5)).norm(), 1e-6);
}

TEST(PositionsTable, KnowsReadingsFromPositions) {
  EXPECT_TRUE(IsImuTable("t,wx,wy,wz,ax,ay,az\n0,1,2,3,4,5,6\n"));
  EXPECT_TRUE(IsImuTable("#timestamp [ns],w_RS_S_x [rad s^-1],a_RS_S_x [m s^-2]\n0,1,2\n"));
  EXPECT_TRUE(IsImuTable("0,1,2,3,4,5,6\n"));
  EXPECT_FALSE(IsImuTable("t,lat,lon,alt\n0,1,2,3\n"));
  EXPECT_FALSE(IsImuTable("0 1 2 3\n"));
  EXPECT_FALSE(IsImuTable("# timestamp tx ty tz qx qy qz qw\n0 1 2 3 0 0 0 1\n"));
}

TEST(PositionsTable, WhatIsMissingIsNamed) {
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [] { ParsePositions("t,lat,alt\n0,1,2\n", "p.csv"); }),
              testing::HasSubstr("longitude"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [] { ParsePositions("t,x,y,z\n", "p.csv"); }),
              testing::HasSubstr("p.csv has no positions"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [] { ParsePositions("a b\n", "p.csv"); }),
              testing::HasSubstr("p.csv has no positions"));
}

}  // namespace
}  // namespace alidade::positions_table_test
