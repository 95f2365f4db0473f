// Folders to train on, read as nerfstudio and COLMAP document them, and by COLMAP itself.
#include <cmath>
#include <cstring>
#include <map>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>
#include <sstream>

#include "alidade/io/files/image_file.h"
#include "support/colmap_program.h"
#include "support/saved_map_command.h"

namespace alidade::training_export_test {
namespace {

// A recording in color with lens distortion, and the result of one camera.
class TrainingExport : public SavedMapCommand {
 protected:
  static std::string Recording() {
    const std::string gray = Rendered({"room", "--frames", "60", "--distortion"});
    const std::string colored = gray + ".colored";
    if (fs::exists(colored)) return colored;
    const std::string draft = colored + "." + std::to_string(getpid());
    fs::copy(gray, draft, fs::copy_options::recursive);
    for (const auto& entry : fs::directory_iterator(draft + "/rgb")) {
      cv::Mat color;  // bluish: the channels differ
      cv::applyColorMap(ReadImageGray(entry.path().string()), color, cv::COLORMAP_BONE);
      WriteImage(entry.path().string(), color);
    }
    std::error_code taken;
    fs::rename(draft, colored, taken);
    if (taken) fs::remove_all(draft);
    return colored;
  }
  static std::string ColoredResult() {
    const std::string out = Recording() + ".result";
    if (fs::exists(out)) return out;
    const std::string draft = out + "." + std::to_string(getpid());
    const ProgramResult run =
        RunAlidade({"run", Recording(), "--sensor", "mono", "--out", draft, "--quiet"});
    EXPECT_EQ(run.status, 0) << run.err;
    std::error_code taken;
    fs::rename(draft, out, taken);
    if (taken) fs::remove_all(draft);
    return out;
  }
};

double Median(std::vector<double> values) {
  EXPECT_FALSE(values.empty());
  if (values.empty()) return NAN;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// transforms.json and its point cloud, by the convention of docs.nerf.studio: a pixel's center lies
// half a pixel from its corner, cameras look along -z with y up.
struct NerfView {
  cv::Mat image;
  Eigen::Matrix4d camera_from_world;
};
struct NerfScene {
  double fx, fy, cx, cy;
  int width, height;
  std::vector<NerfView> views;
  std::vector<Eigen::Vector3d> points;
  std::vector<cv::Vec3b> colors;  // blue green red

  // Position in the image array (0 is the center of the first pixel); nullopt: not in the image.
  std::optional<cv::Point2f> Project(const NerfView& view, const Eigen::Vector3d& point) const {
    const Eigen::Vector3d p = (view.camera_from_world * point.homogeneous()).head<3>();
    if (p.z() >= 0) return std::nullopt;
    const double u = fx * p.x() / -p.z() + cx - 0.5, v = fy * -p.y() / -p.z() + cy - 0.5;
    if (u < 0 || v < 0 || u > width - 1 || v > height - 1) return std::nullopt;
    return cv::Point2f(static_cast<float>(u), static_cast<float>(v));
  }
};

NerfScene ReadNerfstudio(const std::string& folder) {
  const json all = json::parse(ReadText(folder + "/transforms.json"));
  NerfScene scene{all["fl_x"], all["fl_y"], all["cx"], all["cy"], all["w"], all["h"], {}, {}, {}};
  for (const char* name : {"k1", "k2", "p1", "p2"}) EXPECT_EQ(all[name], 0);
  for (const json& frame : all["frames"]) {
    Eigen::Matrix4d world_from_camera;
    for (int r = 0; r < 4; ++r) {
      for (int c = 0; c < 4; ++c) world_from_camera(r, c) = frame["transform_matrix"][r][c];
    }
    const Eigen::Matrix3d R = world_from_camera.topLeftCorner<3, 3>();
    EXPECT_NEAR(R.determinant(), 1, 1e-9);
    scene.views.push_back({ReadImageColor(folder + "/" + frame["file_path"].get<std::string>()),
                           world_from_camera.inverse()});
    EXPECT_EQ(scene.views.back().image.size(), cv::Size(scene.width, scene.height));
  }
  const std::string ply = ReadText(folder + "/" + all["ply_file_path"].get<std::string>());
  const size_t body = ply.find("end_header\n") + 11;
  EXPECT_THAT(ply.substr(0, body), HasSubstr("format binary_little_endian"));
  EXPECT_THAT(ply.substr(0, body), HasSubstr("property uchar red"));
  constexpr size_t kBytes = 3 * sizeof(float) + 3;
  EXPECT_EQ((ply.size() - body) % kBytes, 0u);
  for (size_t at = body; at + kBytes <= ply.size(); at += kBytes) {
    float xyz[3];
    std::memcpy(xyz, ply.data() + at, sizeof(xyz));
    scene.points.emplace_back(xyz[0], xyz[1], xyz[2]);
    const auto* rgb = reinterpret_cast<const uint8_t*>(ply.data() + at + sizeof(xyz));
    scene.colors.emplace_back(rgb[2], rgb[1], rgb[0]);
  }
  return scene;
}

// What one image shows at a point's projection is found again in the next one by optical flow: its
// distances to the projection there, pixels.
std::vector<double> FlowErrors(const NerfScene& scene) {
  std::vector<double> errors;
  for (size_t i = 0; i + 1 < scene.views.size(); ++i) {
    std::vector<cv::Point2f> here, there;
    for (const Eigen::Vector3d& point : scene.points) {
      const auto a = scene.Project(scene.views[i], point),
                 b = scene.Project(scene.views[i + 1], point);
      if (!a || !b) continue;
      here.push_back(*a);
      there.push_back(*b);
    }
    EXPECT_GT(here.size(), 50u);
    if (here.empty()) continue;
    std::vector<cv::Point2f> found = there;
    std::vector<uint8_t> ok;
    cv::calcOpticalFlowPyrLK(
        scene.views[i].image, scene.views[i + 1].image, here, found, ok, cv::noArray(), {15, 15}, 1,
        {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01}, cv::OPTFLOW_USE_INITIAL_FLOW);
    for (size_t k = 0; k < found.size(); ++k) {
      if (ok[k]) errors.push_back(cv::norm(found[k] - there[k]));
    }
  }
  return errors;
}

TEST_F(TrainingExport, PointsOfNerfstudioProjectWhereTheImagesShowThem) {
  const std::string out = folder_ / "ns";
  Export(ColoredResult(), "nerfstudio", out);
  const NerfScene scene = ReadNerfstudio(out);
  ASSERT_GE(scene.views.size(), 3u);
  ASSERT_GT(scene.points.size(), 200u);
  const std::vector<double> errors = FlowErrors(scene);
  ASSERT_GT(errors.size(), 200u);
  EXPECT_LT(Median(errors), 1);
}

TEST_F(TrainingExport, PointsHaveTheColorsOfTheirPixels) {
  const std::string out = folder_ / "ns";
  Export(ColoredResult(), "nerfstudio", out);
  const NerfScene scene = ReadNerfstudio(out);
  std::vector<double> differences, to_gray;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    std::vector<double> in_views;
    for (const NerfView& view : scene.views) {
      const auto at = scene.Project(view, scene.points[i]);
      if (!at) continue;
      cv::Mat patch;
      cv::getRectSubPix(view.image, {1, 1}, *at, patch);
      const auto pixel = patch.at<cv::Vec3b>(0, 0);
      in_views.push_back(cv::norm(cv::Vec3d(pixel) - cv::Vec3d(scene.colors[i]), cv::NORM_INF));
    }
    if (in_views.empty()) continue;
    differences.push_back(Median(in_views));
    to_gray.push_back(std::abs(double(scene.colors[i][0]) - scene.colors[i][2]));
  }
  EXPECT_LT(Median(differences), 20);  // corners: half a pixel changes much
  EXPECT_GT(Median(to_gray), 5);       // not gray, and not with red and blue exchanged
  for (const cv::Vec3b& color : scene.colors) EXPECT_GE(color[0] + 2, color[2]);
}

TEST_F(TrainingExport, ColmapFoldersHaveTheRecordingsOwnNames) {
  const std::string out = folder_ / "colmap";
  Export(ColoredResult(), "colmap", out);
  const auto cameras = DataLines(out + "/sparse/0/cameras.txt");
  ASSERT_EQ(cameras.size(), 1u);
  std::istringstream camera(cameras[0]);
  std::string id, model;
  int width = 0, height = 0;
  camera >> id >> model >> width >> height;
  EXPECT_EQ(model, "PINHOLE");
  const auto names = NamesIn(out + "/images");
  EXPECT_EQ(names.size(), static_cast<size_t>(Info(ColoredResult())["keyframes"]));
  for (const std::string& name : names) {
    EXPECT_TRUE(fs::exists(Recording() + "/rgb/" + name)) << name;
    EXPECT_EQ(ReadImageSize(out + "/images/" + name), cv::Size(width, height));
  }
  for (const std::string& line : DataLines(out + "/sparse/0/points3D.txt")) {
    std::istringstream in(line);
    double skipped = 0, error = 0;
    for (int i = 0; i < 7; ++i) in >> skipped;
    in >> error;
    int image = 0, keypoint = 0, seen = 0;
    while (in >> image >> keypoint) ++seen;
    EXPECT_GE(seen, 2);
    EXPECT_GE(error, 0);
  }
}

TEST_F(TrainingExport, SplatTrainersGetACenteredPrincipalPoint) {
  const std::string out = folder_ / "gs";
  Export(ColoredResult(), "gsplat", out, {"--format", "text"});
  std::istringstream camera(DataLines(out + "/sparse/0/cameras.txt").at(0));
  std::string id, model;
  double width = 0, height = 0, fx = 0, fy = 0, cx = 0, cy = 0;
  camera >> id >> model >> width >> height >> fx >> fy >> cx >> cy;
  EXPECT_NEAR(cx, width / 2, 1e-6);
  EXPECT_NEAR(cy, height / 2, 1e-6);
}

TEST_F(TrainingExport, OtherFramesHavePosesOfTheTrajectory) {
  const std::string every = folder_ / "every", sharpest = folder_ / "sharpest";
  Export(ColoredResult(), "nerfstudio", every, {"--images", "every:4"});
  const NerfScene scene = ReadNerfstudio(every);
  const size_t tracked = DataLines(ColoredResult() + "/trajectory.txt").size();
  EXPECT_GE(scene.views.size(), tracked / 4 - 1);
  EXPECT_LE(scene.views.size(), tracked / 4 + 1);
  EXPECT_GT(scene.points.size(), 200u);
  EXPECT_LT(Median(FlowErrors(scene)), 1);

  // 60 frames at 30 per second: one or two windows of a second for each image.
  Export(ColoredResult(), "colmap", sharpest, {"--images", "sharpest:2"});
  EXPECT_GE(NamesIn(sharpest + "/images").size(), 3u);
  EXPECT_LE(NamesIn(sharpest + "/images").size(), 5u);
}

TEST_F(TrainingExport, ARecordingThatIsGoneOrAnotherIsAnError) {
  const std::string copy = CopyOf(Recording(), folder_), moved = folder_ / "moved";
  const std::string result = folder_ / "result", out = folder_ / "out";
  ASSERT_EQ(RunAlidade({"run", copy, "--sensor", "mono", "--out", result, "--quiet"}).status, 0);
  fs::rename(copy, moved);
  ExpectRefused({"export", result, "--to", "colmap", out}, 3, "is not there any more");
  Export(result, "colmap", out, {"--source", moved});
  const std::string before = ReadText(out + "/sparse/0/images.txt");
  // Of the same size, with the same times, and of another place.
  const std::string other = Rendered({"desk", "--frames", "60", "--distortion"});
  ExpectRefused({"export", result, "--to", "colmap", out, "--source", other}, 3,
                "do not show what the map was made of");
  const std::string small =
      Rendered({"room", "--frames", "20", "--width", "320", "--height", "240"});
  ExpectRefused({"export", result, "--to", "colmap", out, "--source", small}, 3, "320x240");
  EXPECT_EQ(ReadText(out + "/sparse/0/images.txt"), before);  // nothing was lost
  Export(result, "colmap", folder_ / "model", {"--no-images"});
  EXPECT_EQ(NamesIn(folder_ / "model").size(), 7u);
  // A map without its folder does not say what it is of.
  fs::copy(result + "/map.alidade", folder_ / "alone.alidade");
  ExpectRefused({"export", folder_ / "alone.alidade", "--to", "colmap", folder_ / "alone"}, 3,
                "name it with --source");
  Export(folder_ / "alone.alidade", "colmap", folder_ / "alone", {"--source", moved});
  ExpectRefused({"export", folder_ / "alone.alidade", "--to", "colmap", folder_ / "more",
                 "--source", moved, "--images", "every:2"},
                2, "result folder");
}

TEST_F(TrainingExport, AFolderOfSomebodyElseIsKept) {
  folder_.Write("mine/images/holiday.jpg", "not ours");
  ExpectRefused({"export", ColoredResult(), "--to", "nerfstudio", folder_ / "mine"}, 3,
                "other files");
  const std::string out = folder_ / "ns";
  Export(ColoredResult(), "nerfstudio", out);
  Export(ColoredResult(), "gsplat", out);  // ours is replaced
  EXPECT_FALSE(fs::exists(out + "/transforms.json"));
  folder_.Write("ns/images/notes.txt", "dear diary");
  ExpectRefused({"export", ColoredResult(), "--to", "colmap", out}, 3, "images/notes.txt");
  EXPECT_TRUE(fs::exists(out + "/sparse/0/cameras.bin"));
  EXPECT_EQ(NamesIn(folder_.path()).size(), 2u);  // no drafts
}

TEST_F(TrainingExport, ALinkIsKeptAndWhatItLeadsToIsReplaced) {
  const std::string out = folder_ / "ns", link = folder_ / "link";
  Export(ColoredResult(), "nerfstudio", out);
  fs::create_directory_symlink(out, link);
  Export(ColoredResult(), "gsplat", link + "/");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_TRUE(fs::exists(out + "/sparse/0/cameras.bin"));
  EXPECT_FALSE(fs::exists(out + "/transforms.json"));
}

// Killed between the two renames of ExportFolder::Place(): the earlier export lies aside.
TEST_F(TrainingExport, AnExportThatWasPutAsideComesBack) {
  const std::string out = folder_ / "ns";
  Export(ColoredResult(), "nerfstudio", out);
  fs::rename(out, out + ".tmp4711-0");
  ExpectRefused({"export", ColoredResult(), "--to", "colmap", out, "--source", folder_ / "gone"}, 3,
                "is not there any more");
  EXPECT_TRUE(fs::exists(out + "/transforms.json"));
}

TEST_F(TrainingExport, TheChosenCameraOfAFileIsFoundAgain) {
  const std::string cameras = folder_ / "cameras.txt", result = folder_ / "result";
  ASSERT_EQ(RunAlidade({"calibrate", "--camera", Recording() + "/camera.yaml", "--to", "colmap",
                        "--out", cameras})
                .status,
            0);
  ASSERT_EQ(RunAlidade({"run", Recording(), "--sensor", "mono", "--camera", cameras + "#1", "--out",
                        result, "--quiet"})
                .status,
            0);
  Export(result, "colmap", folder_ / "colmap");
}

TEST_F(TrainingExport, OptionsThatCannotBeAreUsageErrors) {
  const std::string result = ColoredResult(), out = folder_ / "out";
  ExpectRefused({"export", result, "--to", "colmap", out, "--images", "some"}, 2, "every:N");
  ExpectRefused({"export", result, "--to", "colmap", out, "--images", "every:0"}, 2, "every:N");
  ExpectRefused({"export", result, "--to", "ply", out, "--images", "every:2"}, 2, "nerfstudio");
  ExpectRefused({"export", result, "--to", "nerfstudio", out, "--no-images"}, 2, "colmap");
  ExpectRefused({"export", result, "--to", "colmap", out, "--masks"}, 2, "--write-masks");
  EXPECT_TRUE(NamesIn(folder_.path()).empty());
}

TEST_F(TrainingExport, MasksLieBesideTheImages) {
  const std::string result = folder_ / "result", out = folder_ / "ns";
  const ProgramResult run = RunAlidade({"run", "synth:room?frames=40&actors=2", "--out", result,
                                        "--quiet", "--dynamics", "geometry", "--write-masks"});
  ASSERT_EQ(run.status, 0) << run.err;
  Export(result, "nerfstudio", out, {"--masks"});
  const json all = json::parse(ReadText(out + "/transforms.json"));
  ASSERT_FALSE(all["frames"].empty());
  for (const json& frame : all["frames"]) {
    const cv::Mat mask = ReadImageGray(out + "/" + frame["mask_path"].get<std::string>());
    EXPECT_EQ(mask.size(), cv::Size(all["w"], all["h"]));
    EXPECT_GT(cv::countNonZero(mask == 255), 0);
    EXPECT_EQ(cv::countNonZero(mask == 0) + cv::countNonZero(mask == 255), mask.rows * mask.cols);
  }
}

// COLMAP's own features, matched and triangulated with our poses and camera, must agree with them.
TEST_F(TrainingExport, ColmapTriangulatesWithThesePoses) {
  if (!HasColmap()) GTEST_SKIP() << "needs COLMAP (scripts/setup --tests installs Debian's)";
  const std::string out = folder_ / "colmap", database = folder_ / "database.db";
  Export(ColoredResult(), "colmap", out);
  const ProgramResult ours = Colmap("model_analyzer --path " + out + "/sparse/0");
  EXPECT_EQ(ours.status, 0) << ours.out;
  EXPECT_EQ(NumberAfter(ours.out, "\nRegistered images:"), NamesIn(out + "/images").size());
  EXPECT_LT(NumberAfter(ours.out, "\nMean reprojection error:"), 1);
  const auto triangulated = ColmapTriangulates(out, database, folder_.Folder("again"));
  EXPECT_GT(triangulated.points, 100);
  EXPECT_LT(triangulated.error, 1);
}

}  // namespace
}  // namespace alidade::training_export_test
