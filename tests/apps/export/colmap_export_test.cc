// COLMAP models as their numbers are, and as COLMAP itself reads them.
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <sstream>

#include "support/colmap_program.h"
#include "support/saved_map_command.h"

namespace alidade::colmap_export_test {
namespace {

// The text model, read as COLMAP's documentation says and projected by OpenCV.
TEST_F(SavedMapCommand, ColmapModelProjectsToItsKeypoints) {
  const std::string out = folder_ / "model";
  Export(Result("mono"), "colmap", out, {"--no-images"});
  std::istringstream camera(DataLines(out + "/cameras.txt").at(0));
  std::string skipped, model;
  double fx, fy, cx, cy, k1, k2, p1, p2;
  camera >> skipped >> model >> skipped >> skipped >> fx >> fy >> cx >> cy >> k1 >> k2 >> p1 >> p2;
  ASSERT_EQ(model, "OPENCV");
  const cv::Matx33d K(fx, 0, cx, 0, fy, cy, 0, 0, 1);
  const cv::Vec4d distortion(k1, k2, p1, p2);

  struct Image {
    cv::Vec3d r, t;
    std::vector<cv::Point2d> keypoints;
    std::vector<int> points;
  };
  std::map<int, Image> images;
  const auto lines = ReadLines(out + "/images.txt");
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i][0] == '#') continue;
    std::istringstream head(lines[i]), keypoints(lines[i + 1]);
    int id = 0;
    double w, x, y, z, tx, ty, tz;
    head >> id >> w >> x >> y >> z >> tx >> ty >> tz;
    Image& image = images[id];
    const double angle = 2 * std::acos(std::min(1.0, w)), sine = std::sqrt(x * x + y * y + z * z);
    if (sine > 0) image.r = cv::Vec3d(x, y, z) * (angle / sine);
    image.t = {tx, ty, tz};
    int point = 0;
    for (cv::Point2d pixel; keypoints >> pixel.x >> pixel.y >> point;) {
      image.keypoints.push_back(pixel);
      image.points.push_back(point);
    }
    ++i;
  }
  double sum = 0;
  int count = 0;
  for (const std::string& line : DataLines(out + "/points3D.txt")) {
    std::istringstream in(line);
    int id = 0, image = 0, keypoint = 0;
    double error = 0, mean = 0;
    cv::Point3d p;
    in >> id >> p.x >> p.y >> p.z >> skipped >> skipped >> skipped >> error;
    EXPECT_THAT(line, HasSubstr(" 128 128 128 "));
    int seen = 0;
    for (; in >> image >> keypoint; ++seen) {
      const Image& in_image = images.at(image);
      EXPECT_EQ(in_image.points.at(keypoint), id);
      std::vector<cv::Point2d> projected;
      cv::projectPoints(std::vector<cv::Point3d>{p}, in_image.r, in_image.t, K, distortion,
                        projected);
      mean += cv::norm(projected[0] - in_image.keypoints[keypoint]);
    }
    mean /= seen;
    EXPECT_NEAR(mean, error, 1e-3) << line;
    sum += mean;
    ++count;
  }
  EXPECT_GT(count, 100);
  EXPECT_LT(sum / count, 1.5);
}

class RealColmap : public SavedMapCommand {
 protected:
  void SetUp() override {
    if (!HasColmap()) GTEST_SKIP() << "needs COLMAP (scripts/setup --tests installs Debian's)";
  }
};

TEST_F(RealColmap, ReadsTextAndBinary) {
  for (const char* sensor : {"rgbd", "mono"}) {
    const std::string result = Result(sensor);
    const json info = Info(result);
    for (const char* format : {"text", "binary", "both"}) {
      const std::string out = folder_ / (std::string(sensor) + format);
      Export(result, "colmap", out, {"--no-images", "--min-observations", "1", "--format", format});
      const ProgramResult analysis = Colmap("model_analyzer --path " + out);
      EXPECT_EQ(analysis.status, 0) << analysis.out;
      EXPECT_EQ(NumberAfter(analysis.out, "\nRegistered images:"), info["keyframes"]);
      EXPECT_EQ(NumberAfter(analysis.out, "\nPoints:"), info["landmarks"]);
      EXPECT_EQ(NumberAfter(analysis.out, "\nObservations:"),
                info["maps"][0]["observations"]["total"]);
      EXPECT_LT(NumberAfter(analysis.out, "\nMean reprojection error:"), 1.5);
    }
  }
}

TEST_F(RealColmap, ConvertsEachIntoTheOther) {
  const std::string text = folder_ / "text", binary = folder_ / "binary";
  Export(Result("rgbd"), "colmap", text, {"--no-images", "--format", "text"});
  Export(Result("rgbd"), "colmap", binary, {"--no-images", "--format", "binary"});
  const std::string out = folder_.Folder("converted");
  const ProgramResult converted =
      Colmap("model_converter --output_type TXT --input_path " + binary + " --output_path " + out);
  EXPECT_EQ(converted.status, 0) << converted.out;
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    auto ours = DataLines(text + "/" + name), theirs = DataLines(out + "/" + name);
    for (std::string& line : theirs) line.erase(line.find_last_not_of(' ') + 1);
    std::sort(ours.begin(), ours.end());  // COLMAP's own order is that of a hash table
    std::sort(theirs.begin(), theirs.end());
    EXPECT_TRUE(ours == theirs) << name;
  }
}

// COLMAP's own projection agrees too: its bundle adjustment starts at our error, and hardly lowers
// it.
TEST_F(RealColmap, AdjustsTheModel) {
  const std::string model = folder_ / "model", out = folder_.Folder("adjusted");
  Export(Result("mono"), "colmap", model, {"--no-images"});
  const double before = NumberAfter(Colmap("model_analyzer --path " + model).out, "error:");
  const ProgramResult adjusted =
      Colmap("bundle_adjuster --input_path " + model + " --output_path " + out);
  EXPECT_EQ(adjusted.status, 0) << adjusted.out;
  const double start = NumberAfter(adjusted.out, "Initial cost :"),
               end = NumberAfter(adjusted.out, "Final cost :");
  EXPECT_LT(start, 1.5);
  EXPECT_LT(std::abs(start - before), 0.5 * before);  // a root mean square beside a mean
  EXPECT_GT(end, 0.5 * start);
}

}  // namespace
}  // namespace alidade::colmap_export_test
