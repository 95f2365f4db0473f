#include <gtest/gtest.h>

#include <opencv2/features2d.hpp>

#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::euroc_source_test {
namespace {

using testing::HasSubstr;

std::string SensorYaml(double x, const std::string& more =
                                     "distortion_model: radial-tangential\n"
                                     "distortion_coefficients: [0, 0, 0, 0]\n") {
  return "%YAML:1.0\n# camera\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, "
         "0, " +
         std::to_string(x) +
         ",\n         0, 1, 0, 0,\n         0, 0, 1, 0,\n         0, 0, 0, 1]\nrate_hz: "
         "20\nresolution: [64, 48]\n"
         "camera_model: pinhole\nintrinsics: [60, 60, 31.5, 23.5]\n" +
         more;
}

// Stamps start at 2 s with steps of 50 ms; the right camera's are 10 µs later.
void WriteTinyEuroc(const TempFolder& folder, int frames, bool right = true) {
  for (int cam = 0; cam < (right ? 2 : 1); ++cam) {
    const std::string root = "mav0/cam" + std::to_string(cam);
    folder.Folder(root + "/data");
    std::string list = "#timestamp [ns],filename\n";
    for (int i = 0; i < frames; ++i) {
      const std::string name = std::to_string(2000000000LL + 50000000LL * i + 10000 * cam);
      WriteImage(folder / (root + "/data/" + name + ".png"), TinyImage(10 * i + cam));
      list += name + "," + name + ".png\r\n";
    }
    folder.Write(root + "/data.csv", list);
    folder.Write(root + "/sensor.yaml", SensorYaml(0.11 * cam));
  }
}

TEST(EurocSource, PairsTheImagesAndKeepsTheStamps) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 3);
  const auto source = OpenSource(folder.path());
  EXPECT_EQ(source->Info().kind, "euroc");
  EXPECT_EQ(source->Info().sensor, Sensor::kStereo);
  EXPECT_NEAR(source->Info().camera.baseline, 0.11, 1e-9);
  EXPECT_EQ(source->Info().camera.fps, 20);
  EXPECT_TRUE(source->Info().R_camera_rectified.isApprox(Eigen::Matrix3d::Identity(), 1e-12));
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp, i == 0 ? "2.000000000" : i == 1 ? "2.050000000" : "2.100000000");
    // Equal undistorted cameras with parallel axes: rectification changes nothing.
    EXPECT_LE(cv::norm(frame->image, TinyImage(10 * i), cv::NORM_INF), 1);
    EXPECT_LE(cv::norm(frame->right, TinyImage(10 * i + 1), cv::NORM_INF), 1);
  }
  EXPECT_FALSE(source->Next());
}

TEST(EurocSource, MonoKeepsTheLensInTheCamera) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 2);
  folder.Write("mav0/cam0/sensor.yaml",
               SensorYaml(0,
                          "distortion_model: radial-tangential\ndistortion_coefficients: [-0.28, "
                          "0.07, 0.0002, 1e-5]\n"));
  const auto source = OpenSource(folder.path(), {.sensor = Sensor::kMono});
  EXPECT_EQ(source->Info().camera.distortion,
            (std::array<double, 5>{-0.28, 0.07, 0.0002, 1e-5, 0}));
  EXPECT_EQ(source->Info().camera.baseline, 0);
  const auto frame = source->Next();
  EXPECT_EQ(cv::norm(frame->image, TinyImage(0), cv::NORM_INF), 0);
  EXPECT_TRUE(frame->right.empty());
}

TEST(EurocSource, WithoutSecondCameraIsMono) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 2, false);
  EXPECT_EQ(OpenSource(folder.path())->Info().sensor, Sensor::kMono);
  EXPECT_EQ(OpenSource(folder / "mav0")->Info().sensor, Sensor::kMono);
}

TEST(EurocSource, AFrameWithoutPartnerIsStillAPicture) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 3);
  folder.Write("mav0/cam1/data.csv", "2000000000,2000010000.png\n2100010000,2100010000.png\n");
  WarningCatcher warnings;
  const auto source = OpenSource(folder.path());
  EXPECT_THAT(warnings.text(), HasSubstr("1 of 3 frames have no right image"));
  for (const bool right : {true, false, true}) {
    const auto frame = source->Next();
    EXPECT_FALSE(frame->image.empty());
    EXPECT_EQ(frame->right.empty(), !right);
  }
}

TEST(EurocSource, CalibrationsThatCannotBeAreNamed) {
  const TempFolder folder;
  WriteTinyEuroc(folder, 2);
  const auto message = [&](const std::string& yaml) {
    folder.Write("mav0/cam0/sensor.yaml", yaml);
    return MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path()); });
  };
  EXPECT_THAT(message(SensorYaml(0, "distortion_model: omni\n")),
              HasSubstr("sensor.yaml:15: distortion_model"));
  EXPECT_THAT(message("%YAML:1.0\ncamera_model: pinhole\n"), HasSubstr("`resolution` is missing"));
  EXPECT_THAT(message(SensorYaml(0.5)), HasSubstr("swapped"));
  EXPECT_THAT(message("a: [1,\n"), HasSubstr("sensor.yaml:"));
}

TEST(EurocSource, RowsOfTheRealPairAgree) {
  if (DataFolder().empty()) GTEST_SKIP() << "needs ALIDADE_DATA";
  const auto source = OpenSource(DataFolder() + "/euroc_micro");
  EXPECT_EQ(source->Info().frames, 24);
  EXPECT_EQ(source->Info().sensor, Sensor::kStereo);
  EXPECT_NEAR(source->Info().camera.baseline, 0.11, 0.001);
  const auto frame = source->Next();
  EXPECT_EQ(frame->stamp, "1403715273.262142976");

  const auto orb = cv::ORB::create(2000);
  std::vector<cv::KeyPoint> left, right;
  cv::Mat left_descriptors, right_descriptors;
  orb->detectAndCompute(frame->image, cv::noArray(), left, left_descriptors);
  orb->detectAndCompute(frame->right, cv::noArray(), right, right_descriptors);
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING, true).match(left_descriptors, right_descriptors, matches);
  std::vector<double> rows, disparities;
  for (const cv::DMatch& match : matches) {
    if (match.distance > 40) continue;
    const cv::Point2f l = left[static_cast<size_t>(match.queryIdx)].pt,
                      r = right[static_cast<size_t>(match.trainIdx)].pt;
    if (std::abs(l.y - r.y) > 10) continue;  // a wrong match
    rows.push_back(l.y - r.y);
    disparities.push_back(l.x - r.x);
  }
  ASSERT_GT(rows.size(), 200u);
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
  };
  EXPECT_LT(std::abs(median(rows)), 0.3);  // no offset
  for (double& row : rows) row = std::abs(row);
  RecordProperty("median_row_difference", std::to_string(median(rows)));
  EXPECT_LT(median(rows), 0.5);
  EXPECT_GT(median(disparities), 1);  // the scene is in front of the camera
}

}  // namespace
}  // namespace alidade::euroc_source_test
