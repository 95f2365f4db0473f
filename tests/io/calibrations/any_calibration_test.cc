// What all calibrations have in common: damage, folds, sizes.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>

#include "alidade/base/log.h"
#include "alidade/io/files/calibrations/fold.h"
#include "alidade/io/files/calibrations/write_calibration.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/choose_calibration.h"
#include "support/expect_camera.h"
#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::any_calibration_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

RawCamera Some(Lens lens) {
  RawCamera camera = {lens,  640,    480,   401.25,
                      402.5, 318.75, 241.5, {-0.1, 0.02, 0.001, -0.002, 0.003}};
  if (lens == Lens::kFisheye) camera.distortion = {0.01, -0.002, 0.001, -0.0002, 0};
  return camera;
}

std::vector<std::string> GoodTexts() {
  Calibration calibration;
  calibration.left = Some(Lens::kPinhole);
  calibration.left.distortion[4] = 0;
  std::vector<std::string> texts = {
      R"({"width": 640, "height": 480, "ppx": 318, "ppy": 241, "fx": 381, "fy": 381, "model": "none", "coeffs": [0, 0, 0, 0, 0]})",
      R"({"camera_model": "OPENCV", "fl_x": 500, "cx": 320, "cy": 240, "w": 640, "h": 480, "frames": [{"file_path": "a", "transform_matrix": [[1]]}]})",
      R"({"cameraData": [[0, {"width": 640, "height": 480, "intrinsicMatrix": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "distortionCoeff": [0.1], "extrinsics": {"toCameraSocket": 1, "rotationMatrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "translation": {"x": -7, "y": 0, "z": 0}}}]]})",
      R"({"value0": {"intrinsics": [{"camera_type": "ds", "intrinsics": {"fx": 300, "fy": 300, "cx": 320, "cy": 240, "xi": -0.2, "alpha": 0.6}}], "resolution": [[640, 480]], "T_imu_cam": [{"px": 0}]}})",
      "%YAML:1.0\nCamera.type: PinHole\nCamera1.fx: 500\nCamera1.fy: 500\nCamera1.cx: "
      "320\nCamera1.cy: "
      "240\nCamera.width: 640\nCamera.height: 480\nStereo.b: 0.1\n",
      "Camera:\n  model: perspective\n  setup: stereo\n  fx: 500\n  fy: 500\n  cx: 320\n  cy: "
      "240\n  "
      "cols: 640\n  rows: 480\n  focal_x_baseline: 50\n",
      "sensor_type: camera\nrate_hz: 20\nresolution: [640, 480]\ncamera_model: "
      "pinhole\nintrinsics: "
      "[500, 500, 320, 240]\ndistortion_model: radtan\ndistortion_coefficients: [0.1, 0, 0, 0]\n",
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<camera_matrix type_id=\"opencv-matrix\">\n  "
      "<rows>3</rows>\n  <cols>3</cols>\n  <dt>d</dt>\n  <data>\n    500. 0. 320. 0. 500. 240. 0. "
      "0. "
      "1.</data></camera_matrix>\n</opencv_storage>\n",
      " Intrinsic of \"Color\" / 640x480 / {RGB8}\n  Width: 640\n  Height: 480\n  PPX: 320\n  PPY: "
      "240\n  Fx: 600\n  Fy: 600\n  Distortion: Inverse Brown Conrady\n  Coeffs: 0 0 0 0 0\n"};
  for (const auto style :
       {CalibrationStyle::kAlidade, CalibrationStyle::kKalibr, CalibrationStyle::kRos,
        CalibrationStyle::kOpenCv, CalibrationStyle::kColmap})
    texts.push_back(FormatCalibration(calibration, style).text);
  return texts;
}

// Whatever is read must be an Error that names the file, or a calibration.
bool Survives(const std::string& text) {
  try {
    ParseCameraFile(text, "damaged.cal");
    return true;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("damaged.cal")) << text.substr(0, 400);
    return false;
  }
}

TEST(AnyCalibration, DamagedFilesAreErrors) {
  SetWarningListener([](const std::string&) {});
  std::mt19937 random(5);
  int refused = 0;
  for (const std::string& good : GoodTexts()) {
    ASSERT_TRUE(Survives(good)) << good;
    for (size_t end = 0; end < good.size(); end += 11)
      refused += Survives(good.substr(0, end)) ? 0 : 1;
    // Each value in turn becomes something else.
    for (const std::string other : {"1e400", "-1e308", "1e-320", ".nan", "nan", "[]", "{}",
                                    "[[[1]]]", "~", "\"\"", "-1", "x"}) {
      for (size_t at = good.find_first_of("0123456789"); at != std::string::npos;
           at = good.find_first_of("0123456789", good.find_first_not_of("0123456789.", at))) {
        const size_t end = std::min(good.find_first_not_of("0123456789.", at), good.size());
        refused += Survives(good.substr(0, at) + other + good.substr(end)) ? 0 : 1;
      }
    }
    for (int i = 0; i < 50; ++i) {
      std::string text = good;
      text[random() % text.size()] = static_cast<char>(random());
      refused += Survives(text) ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 500);
  SetWarningListener(nullptr);
}

TEST(AnyCalibration, FilesOfAnotherKindAreToldWhatIsKnown) {
  const auto message = [](const std::string& text) {
    return MessageOf(ErrorKind::kInput, [&] { ParseCameraFile(text, "what"); });
  };
  for (const std::string text : {"", "a: 1\n", "{\"a\": 1}", "{}"}) {
    EXPECT_THAT(message(text), AllOf(HasSubstr("what"), HasSubstr("Kalibr"), HasSubstr("COLMAP"),
                                     HasSubstr("OpenCV"), HasSubstr("RealSense")));
  }
  EXPECT_THAT(message(std::string("\x01\x00\x00\x00", 4)),
              AllOf(HasSubstr("not a text file"), HasSubstr("model_converter")));
  EXPECT_THAT(message("<html><body></body></html>"), HasSubstr("opencv_storage"));
  std::string deep = "{\"frames\": ";
  for (int i = 0; i < 100000; ++i) deep += "[";
  EXPECT_THAT(message(deep + "\"transform_matrix\""), HasSubstr("what"));
  std::string deep_xml = "<opencv_storage>";
  for (int i = 0; i < 100000; ++i) deep_xml += "<a>";
  EXPECT_THAT(message(deep_xml), HasSubstr("nested"));
}

TEST(AnyCalibration, ACameraIsChosenAfterAHash) {
  const TempFolder folder;
  const std::string path = folder.Write(
      "cameras.txt", "1 PINHOLE 640 480 500 500 320 240\n2 PINHOLE 64 48 50 50 32 24\n");
  EXPECT_EQ(ReadCameraFile(path + "#2").left.width, 64);
  EXPECT_EQ(CameraFilePath(path + "#2"), path);
  // A file may have a # in its name.
  const std::string odd = folder.Write("a#2", "1 PINHOLE 640 480 500 500 320 240\n");
  EXPECT_EQ(ReadCameraFile(odd).left.width, 640);
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadCameraFile(odd + "#cam1"); }),
              HasSubstr("cam1"));
  const std::string own = folder.Write(
      "own.yaml", "model: pinhole\nwidth: 64\nheight: 48\nfx: 60\nfy: 61\ncx: 31\ncy: 24\n");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadCameraFile(own + "#cam1"); }),
              HasSubstr("has one camera"));
}

TEST(AnyCalibration, AnotherSizeOfTheSameAspectIsScaled) {
  Calibration calibration;
  calibration.origin = "cam.yaml";
  calibration.left = Some(Lens::kPinhole);
  calibration.right = Some(Lens::kFisheye);
  const Calibration half = FitToSize(calibration, {320, 240});
  ExpectCamera(half.left,
               {Lens::kPinhole, 320, 240, 401.25 / 2, 402.5 / 2, (318.75 + 0.5) / 2 - 0.5,
                (241.5 + 0.5) / 2 - 0.5, calibration.left.distortion});
  EXPECT_EQ(half.right->width, 320);
  EXPECT_THAT(half.told, AllOf(HasSubstr("cam.yaml"), HasSubstr("640x480"), HasSubstr("320x240")));
  // The same direction is at the same place of the image: pixel areas, not centers, are halved.
  const Eigen::Vector3d p(0.2, -0.1, 1);
  const Eigen::Vector2d large = calibration.left.Project(p), small = half.left.Project(p);
  EXPECT_LT((((large.array() + 0.5) / 2 - 0.5).matrix() - small).norm(), 1e-9);
  EXPECT_EQ(FitToSize(calibration, {640, 480}).told, "");
  // A side rounded to whole pixels is the same aspect, a crop is not.
  EXPECT_EQ(FitToSize(calibration, {853, 640}).left.width, 853);
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] {
                          FitToSize(calibration, {640, 360});
                        }),
              AllOf(HasSubstr("cam.yaml is for images of 640x480"), HasSubstr("640x360"),
                    HasSubstr("aspect")));
  calibration.left.width = calibration.left.height = 0;
  EXPECT_THAT(FitToSize(calibration, {640, 480}).told, HasSubstr("does not state the size"));
}

// r (1 + k1 r²) has its maximum at r = 1 / sqrt(-3 k1), where it is 2/3 of r.
TEST(AnyCalibration, AFoldInsideTheImageIsRefused) {
  const auto camera = [](double k1) {
    return RawCamera{Lens::kPinhole, 640, 480, 400, 400, 319.5, 239.5, {k1, 0, 0, 0, 0}};
  };
  const double corner = std::hypot(319.5, 239.5);
  const auto fold = [](double k1) { return 400 * 2 / (3 * std::sqrt(-3 * k1)); };
  ASSERT_LT(fold(-0.16), corner);
  ASSERT_GT(fold(-0.13), corner);
  ASSERT_TRUE(FoldRadius(camera(-0.16)));
  EXPECT_NEAR(*FoldRadius(camera(-0.16)), fold(-0.16), corner / 32);
  EXPECT_FALSE(FoldRadius(camera(-0.13)));
  EXPECT_FALSE(FoldRadius(camera(0.5)));
  // Only the tangential term bends here.
  RawCamera tangential = camera(0);
  tangential.distortion[2] = 0.01;
  EXPECT_FALSE(FoldRadius(tangential));
  tangential.distortion[2] = 0.5;
  EXPECT_TRUE(FoldRadius(tangential));
  // θ (1 + k1 θ²) likewise.
  RawCamera fisheye = camera(-0.1);
  fisheye.lens = Lens::kFisheye;
  EXPECT_FALSE(FoldRadius(fisheye));
  fisheye.distortion[0] = -0.3;
  EXPECT_TRUE(FoldRadius(fisheye));
  for (const std::string text :
       {"model: pinhole\nwidth: 640\nheight: 480\nfx: 400\nfy: 400\ncx: 319.5\ncy: 239.5\n"
        "distortion: [-0.4, 0, 0, 0]\n",
        "1 RADIAL 640 480 400 320 240 -0.4 0\n", "1 RADIAL_FISHEYE 640 480 400 320 240 -0.4 0\n",
        "image_width: 640\nimage_height: 480\ncamera_matrix: [400, 0, 320, 0, 400, 240, 0, 0, 1]\n"
        "distortion_coefficients: [0.1, 0, 0, 0, 0, 9, 0, 0]\n"}) {
    EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { RequireSize(ParseCameraFile(text, "bent")); }),
                AllOf(HasSubstr("bent"), HasSubstr("alibrate again")));
  }
}

TEST(AnyCalibration, AFoldingRightCameraMattersForStereoOnly) {
  Calibration pair;
  pair.left = Some(Lens::kPinhole);
  pair.right = pair.left;
  pair.right->distortion = {-0.4, 0, 0, 0, 0};
  EXPECT_EQ(FitToSize(pair, {640, 480}, false).left.width, 640);
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] {
                          FitToSize(pair, {640, 480}, true);
                        }),
              HasSubstr("right camera's distortion folds"));
}

class WrittenCalibrations : public testing::TestWithParam<CalibrationStyle> {};

TEST_P(WrittenCalibrations, AreReadBack) {
  const CalibrationStyle style = GetParam();
  for (const Lens lens : {Lens::kPinhole, Lens::kFisheye}) {
    Calibration c;
    c.left = Some(lens);
    if (style == CalibrationStyle::kKalibr) c.left.distortion[4] = 0;
    const WrittenCalibration written = FormatCalibration(c, style, "first\nsecond");
    EXPECT_THAT(CommentOfCalibration(written.text), testing::StartsWith("# first\n# second\n"));
    ExpectCamera(ParseCameraFile(written.text, "written").left, c.left);
    EXPECT_EQ(written.told, "");
    // A pair, where the format has one.
    c.right = c.left;
    c.right->cx += 3.25;
    c.T_left_right = {ExpSo3({0.01, -0.02, 0.03}), {0.12, 0.001, -0.002}};
    const WrittenCalibration pair = FormatCalibration(c, style);
    const Calibration read = ParseCameraFile(pair.text, "written");
    ExpectCamera(read.left, c.left);
    if (style == CalibrationStyle::kRos || style == CalibrationStyle::kColmap) {
      EXPECT_FALSE(read.right);
      EXPECT_THAT(pair.told, HasSubstr("only the left one"));
      continue;
    }
    ASSERT_TRUE(read.right);
    ExpectCamera(*read.right, *c.right);
    EXPECT_LT((read.T_left_right.t - c.T_left_right.t).norm(), 1e-9);
    EXPECT_LT(RotationAngle(read.T_left_right, c.T_left_right), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Styles, WrittenCalibrations,
                         testing::Values(CalibrationStyle::kAlidade, CalibrationStyle::kKalibr,
                                         CalibrationStyle::kRos, CalibrationStyle::kOpenCv,
                                         CalibrationStyle::kColmap),
                         [](const auto& style) { return NameOf(style.param); });

TEST(WrittenCalibration, OpenCvReadsItsOwn) {
  Calibration c;
  c.left = Some(Lens::kPinhole);
  const cv::FileStorage file(FormatCalibration(c, CalibrationStyle::kOpenCv, "comment").text,
                             cv::FileStorage::READ | cv::FileStorage::MEMORY);
  cv::Mat K, D;
  file["camera_matrix"] >> K;
  file["distortion_coefficients"] >> D;
  ASSERT_EQ(K.size(), cv::Size(3, 3));
  ASSERT_EQ(D.total(), 5u);
  EXPECT_EQ(K.at<double>(0, 0), c.left.fx);
  EXPECT_EQ(K.at<double>(1, 2), c.left.cy);
  EXPECT_EQ(D.at<double>(4), c.left.distortion[4]);
  EXPECT_EQ(static_cast<int>(file["image_width"]), 640);
}

TEST(WrittenCalibration, KalibrHasNoThirdRadialCoefficient) {
  Calibration c;
  c.left = Some(Lens::kPinhole);
  const WrittenCalibration written = FormatCalibration(c, CalibrationStyle::kKalibr);
  EXPECT_THAT(written.told, AllOf(HasSubstr("k3"), HasSubstr("pixels")));
  const RawCamera read = ParseCameraFile(written.text, "x").left;
  for (double u = 0; u < 640; u += 50) {
    for (double v = 0; v < 480; v += 50) {
      const Eigen::Vector3d p = c.left.Direction({u, v});
      EXPECT_LT((read.Project(p) - Eigen::Vector2d(u, v)).norm(), 0.5);
    }
  }
  const RawCamera middle = c.left;
  c.left.cx = -2000;  // nothing of a lens is seen
  EXPECT_THAT(
      MessageOf(ErrorKind::kUsage, [&] { FormatCalibration(c, CalibrationStyle::kKalibr); }),
      HasSubstr("too far outside"));
  c.left = middle;
  c.left.distortion = {0.2, -0.9, 0, 0, 2};
  EXPECT_THAT(
      MessageOf(ErrorKind::kUsage, [&] { FormatCalibration(c, CalibrationStyle::kKalibr); }),
      AllOf(HasSubstr("Kalibr"), HasSubstr("k3"), HasSubstr("ros or opencv")));
}

}  // namespace
}  // namespace alidade::any_calibration_test
