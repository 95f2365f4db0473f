// Calibrations of other tools, through the program as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "alidade/io/files/camera_file.h"
#include "support/colmap_program.h"
#include "support/expect_camera.h"
#include "support/program.h"

namespace alidade::calibration_files_test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

// Of the rendered recording: 320 × 240 pixels, 75 degrees.
const double kFocal = 160 / std::tan(37.5 * M_PI / 180);
const std::string kF = std::to_string(kFocal);

// One recording for all tests.
const std::string& Recording() {
  static const TempFolder folder;
  static const std::string made = [] {
    const ProgramResult result = RunAlidade({"synth", "desk", folder / "made", "--frames", "12",
                                             "--width", "320", "--height", "240", "--fov", "75"});
    EXPECT_EQ(result.status, 0) << result.err;
    return folder / "made";
  }();
  return made;
}

TEST(CalibrationFiles, OfAnyToolAreRunWith) {
  const TempFolder folder;
  const std::map<std::string, std::string> files = {
      {"kalibr.yaml",
       "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [0, 0, 0, 0]\n  distortion_model: "
       "radtan\n"
       "  intrinsics: [" +
           kF + ", " + kF +
           ", 159.5, 119.5]\n  resolution: [320, 240]\n"
           "  rostopic: /cam0/image_raw\n"},
      {"cameras.txt", "# cams\n1 PINHOLE 320 240 " + kF + " " + kF + " 160 120\n"},
      {"cv.yaml",
       "%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
       "   data: [ " +
           kF + ", 0., 159.5, 0., " + kF + ", 119.5, 0., 0., 1. ]\n"},
      {"orb.yaml", "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: " + kF +
                       "\nCamera1.fy: " + kF +
                       "\nCamera1.cx: 159.5\nCamera1.cy: 119.5\n"
                       "Camera.width: 320\nCamera.height: 240\nCamera.fps: 30\n"},
      // of twice the size
      {"transforms.json", "{\"fl_x\": " + std::to_string(2 * kFocal) +
                              ", \"cx\": 320, \"cy\": 240, \"w\": 640, \"h\": 480}"}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    const std::string out = folder / ("out-" + name);
    const ProgramResult run =
        RunAlidade({"run", Recording(), "--camera", folder.Write(name, text), "--out", out});
    ASSERT_EQ(run.status, 0) << run.err;
    const json camera = json::parse(ReadText(out + "/stats.json"))["camera"];
    EXPECT_NEAR(camera["fx"].get<double>(), kFocal, 1e-5);
    EXPECT_NEAR(camera["cx"].get<double>(), 159.5, 1e-9);
    EXPECT_NEAR(camera["cy"].get<double>(), 119.5, 1e-9);
    EXPECT_EQ(camera["known"], "given");
    EXPECT_THAT(run.out, name == "transforms.json" ? HasSubstr("is scaled to 320x240")
                         : name == "cv.yaml"       ? HasSubstr("does not state the size")
                                                   : HasSubstr(""));
  }
}

TEST(CalibrationFiles, OfAnotherAspectOrWithAFoldAreRefused) {
  const TempFolder folder;
  const auto message = [&](const std::string& text) {
    const ProgramResult run = RunAlidade(
        {"run", Recording(), "--camera", folder.Write("camera", text), "--out", folder / "out"});
    EXPECT_EQ(run.status, 3);
    return run.err;
  };
  EXPECT_THAT(message("1 PINHOLE 320 180 200 200 160 90\n"),
              AllOf(HasSubstr("320x180"), HasSubstr("320x240"), HasSubstr("aspect ratio")));
  EXPECT_THAT(message("1 RADIAL 320 240 200 160 120 -0.5 0\n"),
              HasSubstr("folds inside the image"));
}

// What lies beside the recording is not used then.
TEST(CalibrationFiles, AFoldingOneBesideTheRecordingDoesNotKeepOthersOut) {
  const TempFolder folder;
  const std::string copy = CopyOf(Recording(), folder);
  const std::string good = ReadText(copy + "/camera.yaml");
  folder.Write("recording/camera.yaml",
               "model: pinhole\nwidth: 320\nheight: 240\nfx: 200\nfy: 200\ncx: 159.5\ncy: 119.5\n"
               "distortion: [-0.5, 0, 0, 0]\n");
  const auto run = [&](const std::vector<std::string>& how) {
    std::vector<std::string> words = {"run", copy, "--out", folder / "out", "--overwrite"};
    words.insert(words.end(), how.begin(), how.end());
    return RunAlidade(words);
  };
  EXPECT_THAT(run({}).err, HasSubstr("folds inside the image"));
  EXPECT_EQ(run({"--camera", folder.Write("good.yaml", good)}).status, 0);
  EXPECT_EQ(run({"--fov", "75"}).status, 0);
}

TEST(CalibrationFiles, AreConverted) {
  const TempFolder folder;
  const std::string kalibr = folder.Write(
      "chain.yaml",
      "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [-0.28, 0.08, 0.0002, 1.8e-05]\n"
      "  distortion_model: radtan\n  intrinsics: [458.654, 457.296, 367.215, 248.375]\n"
      "  resolution: [752, 480]\n");
  const RawCamera camera = ReadCameraFile(kalibr).left;
  for (const std::string to : {"alidade", "kalibr", "ros", "opencv", "colmap"}) {
    SCOPED_TRACE(to);
    const std::string out = folder / to;
    const std::vector<std::string> words = {"calibrate", "--camera", kalibr, "--to",
                                            to,          "--out",    out};
    const ProgramResult first = RunAlidade(words);
    ASSERT_EQ(first.status, 0) << first.err;
    ExpectCamera(ReadCameraFile(out).left, camera);
    // Its own file is replaced, another is not.
    EXPECT_EQ(RunAlidade(words).status, 0);
    folder.Write(to, "model: pinhole\n");
    const ProgramResult again = RunAlidade(words);
    EXPECT_EQ(again.status, 3);
    EXPECT_THAT(again.err, HasSubstr("--overwrite"));
  }
  const ProgramResult wrong = RunAlidade({"calibrate", "--camera", kalibr, "--to", "matlab"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--to must be"));
  EXPECT_EQ(RunAlidade({"calibrate", "--camera", kalibr, Recording()}).status, 2);
  EXPECT_EQ(RunAlidade({"calibrate"}).status, 2);
}

// COLMAP itself reads the written camera, and writes it again.
TEST(CalibrationFiles, ColmapReadsTheWrittenOne) {
  if (!HasColmap()) GTEST_SKIP() << "needs COLMAP (scripts/setup --tests)";
  const TempFolder folder;
  for (const std::string& lens : {std::string("pinhole"), std::string("fisheye")}) {
    SCOPED_TRACE(lens);
    const std::string own =
        folder.Write(lens + ".yaml",
                     "model: " + lens +
                         "\nwidth: 640\nheight: 480\nfx: 401.25\nfy: 402.5\ncx: 318.75\ncy: 241.5\n"
                         "distortion: [0.01, -0.002, 0.001, -0.0002]\n");
    const std::string in = folder / (lens + "-in"), out = folder / (lens + "-out");
    std::filesystem::create_directories(in);
    std::filesystem::create_directories(out);
    ASSERT_EQ(
        RunAlidade({"calibrate", "--camera", own, "--to", "colmap", "--out", in + "/cameras.txt"})
            .status,
        0);
    std::ofstream(in + "/images.txt") << "";
    std::ofstream(in + "/points3D.txt") << "";
    const ProgramResult converted = Colmap("model_converter --input_path " + in +
                                           " --output_path " + out + " --output_type TXT");
    ASSERT_EQ(converted.status, 0) << converted.out;
    ExpectCamera(ReadCameraFile(out + "/cameras.txt").left, ReadCameraFile(own).left);
  }
}

}  // namespace
}  // namespace alidade::calibration_files_test
