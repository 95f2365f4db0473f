// Recordings along a given path.
#include "alidade/synth/flight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "alidade/base/error.h"
#include "alidade/synth/camera_path.h"
#include "alidade/synth/recording.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade::synth_flight_test {
namespace {

CameraPath DeskPath() {
  SceneBuilder builder(1);
  const Layout layout = LayOut("desk", builder);
  return {layout.knots, layout.period, layout.turns, layout.shake, 1};
}

// 20 poses per second from `start` on, moved to somewhere else in the world.
Flight FlightAlong(const CameraPath& path, double start, double seconds) {
  Flight flight;
  for (int i = 0; i <= 20 * seconds; ++i) {
    FlightPose pose{start + i / 20.0, path.At(start + i / 20.0)};
    pose.T_world_camera.t += Eigen::Vector3d(30, -20, 4);
    flight.poses.push_back(pose);
  }
  flight.readings = {{start, {0, 0, 1}, {1, 0, 0}},
                     {start + 0.04, {0, 0, 2}, {2, 0, 0}},
                     {start + 0.06, {0, 0, 3}, {3, 0, 0}}};
  flight.imu.rate = 200;
  return flight;
}

SynthSettings Small() {
  SynthSettings settings = SynthDefaults(kFlightScene);
  settings.path = "groundtruth.txt";
  settings.width = 188;
  settings.height = 120;
  settings.noise = 0;
  return settings;
}

TEST(SynthFlight, ThePathIsSmoothBetweenItsPoses) {
  const CameraPath truth = DeskPath();
  const FlightPath path(FlightAlong(truth, 3, 4).poses);
  const Eigen::Vector3d moved(30, -20, 4);
  for (double t = 3.2; t < 6.8; t += 0.0171) {
    const Se3 at = path.At(t);
    EXPECT_LT((at.t - moved - truth.At(t).t).norm(), 2e-4) << t;
    EXPECT_LT(RotationAngle(at, truth.At(t)), 5e-4) << t;
  }
  EXPECT_LT((path.At(5).t - moved - truth.At(5).t).norm(), 1e-12);
  EXPECT_LT(RotationAngle(path.At(5), truth.At(5)), 1e-7);
  EXPECT_EQ(path.At(0).t, path.At(3).t);  // before the first pose
  const double h = 1e-5;                  // at a pose the velocity does not jump
  const Eigen::Vector3d before = path.At(5).t - path.At(5 - h).t,
                        after = path.At(5 + h).t - path.At(5).t;
  EXPECT_LT((after - before).norm() / h, 1e-3);
}

TEST(SynthFlight, ImagesAreTakenAtThePosesInAClosedHall) {
  const Flight flight = FlightAlong(DeskPath(), 3, 8);
  const SynthRecording recording(Small(), flight);
  EXPECT_EQ(recording.frames(), 161);
  EXPECT_NEAR(recording.settings().fps, 20, 1e-6);
  for (int i = 0; i < recording.frames(); i += 40) {
    EXPECT_EQ(recording.Time(i), flight.poses[i].time);
    EXPECT_LT((recording.Pose(i).t - flight.poses[i].T_world_camera.t).norm(), 1e-9);
    const RenderedFrame frame = recording.Render(i);
    double least = 0, most = 0;
    cv::minMaxLoc(frame.depth_exact, &least, &most);
    EXPECT_GT(least, 0.3) << i;  // 0: no surface; what stands on the floor is lower than the camera
    EXPECT_LT(most, 20) << i;
    cv::Mat mean, deviation;
    cv::meanStdDev(frame.clean, mean, deviation);
    EXPECT_GT(deviation.at<double>(0), 10) << i;
  }
}

TEST(SynthFlight, ReadingsAreThoseGiven) {
  const Flight flight = FlightAlong(DeskPath(), 3, 0.5);
  const RecordedImu imu(flight.readings, flight.imu);
  EXPECT_EQ(imu.told().rate, 200);
  EXPECT_EQ(imu.Between(2.9, 3).size(), 1u);
  const auto both = imu.Between(3, 3.06);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[1].angular_rate.z(), 3);
  EXPECT_TRUE(imu.Between(3.07, 9).empty());
}

TEST(SynthFlight, SaysWhatCannotBe) {
  Flight flight = FlightAlong(DeskPath(), 3, 0.5);
  std::swap(flight.poses[2], flight.poses[3]);
  EXPECT_THROW(flight.Check(), Error);
  SynthSettings settings = Small();
  settings.imu = "phone";
  EXPECT_THROW(settings.Check(), Error);
  settings.imu = "imu.csv";
  settings.Check();
  settings.path = "walk";
  EXPECT_THROW(settings.Check(), Error);
}

}  // namespace
}  // namespace alidade::synth_flight_test
