// Drawings of a report show what happened in the run.
#include "alidade/view/drawings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <regex>

#include "alidade/view/grid_drawing.h"
#include "alidade/view/histogram.h"
#include "alidade/view/report.h"

namespace alidade::drawings_test {
namespace {

using testing::HasSubstr;
using testing::Not;

int Count(const std::string& text, const std::string& what) {
  int count = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

Se3 CameraAt(double x, double y, double z) { return {Eigen::Matrix3d::Identity(), {x, y, z}}; }

// Page coordinates of the first path.
std::vector<Eigen::Vector2d> PathPoints(const std::string& svg) {
  std::smatch match;
  std::regex_search(svg, match, std::regex("<polyline class=\"path\" points=\"([^\"]*)\""));
  const std::string list = match[1];
  std::vector<Eigen::Vector2d> points;
  const std::regex pair("([-0-9.]+),([-0-9.]+)");
  for (std::sregex_iterator it(list.begin(), list.end(), pair), end; it != end; ++it) {
    points.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  return points;
}

TEST(Drawings, ForwardIsUpAndRightIsRightOnThePage) {
  PlaceDrawing place;
  place.path = {{CameraAt(0, 0, 0), CameraAt(0, 0, 2), CameraAt(1, 0, 2)}};
  place.unit = "m";
  const auto p = PathPoints(DrawPlace(place, PlaceView::kAbove));
  ASSERT_EQ(p.size(), 3u);
  EXPECT_NEAR(p[1].x(), p[0].x(), 0.11);
  EXPECT_LT(p[1].y(), p[0].y());
  EXPECT_GT(p[2].x(), p[1].x());
  EXPECT_NEAR(p[2].y(), p[1].y(), 0.11);
  EXPECT_NEAR((p[1] - p[0]).norm(), 2 * (p[2] - p[1]).norm(), 0.3);  // the same scale for both
}

TEST(Drawings, TiltedCameraIsStillSeenFromAbove) {
  // Looks 40 degrees down while moving horizontally.
  const double tilt = 40 * M_PI / 180;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(-tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
  PlaceDrawing place;
  for (int turn = 0; turn < 12; ++turn) {  // a full turn, so that the tilt averages out
    const double yaw = turn * M_PI / 6;
    const Eigen::Matrix3d Y = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
    if (turn == 0) place.path.emplace_back();
    place.path[0].push_back({Y * R, {std::sin(yaw), 0, 1 - std::cos(yaw)}});
  }
  const auto p = PathPoints(DrawPlace(place, PlaceView::kAbove));
  ASSERT_EQ(p.size(), 12u);
  const Eigen::Vector2d middle = 0.5 * (p[0] + p[6]);
  for (const auto& q : p) EXPECT_NEAR((q - middle).norm(), (p[0] - middle).norm(), 0.3);
}

TEST(Drawings, EachStretchIsALineOfItsOwn) {
  PlaceDrawing place;
  place.path = {{CameraAt(0, 0, 0), CameraAt(0, 0, 1)}, {CameraAt(1, 0, 1), CameraAt(1, 0, 2)}};
  EXPECT_EQ(Count(DrawPlace(place, PlaceView::kAbove), "<polyline class=\"path\""), 2);
}

TEST(Drawings, NothingAtAllCanBeDrawn) {
  EXPECT_THAT(DrawPlace({}, PlaceView::kAbove), HasSubstr("</svg>"));
  EXPECT_THAT(DrawPlace({}, PlaceView::kSide), HasSubstr("</svg>"));
  EXPECT_THAT(DrawTimeline({}), HasSubstr("</svg>"));
  EXPECT_THAT(DrawSeries({}, 0, "ms"), HasSubstr("</svg>"));
  EXPECT_THAT(DrawHistogram({}, "ms", ""), HasSubstr("</svg>"));
  EXPECT_THAT(RenderReport({}), HasSubstr("</html>"));
  EXPECT_THAT(RenderReport({}), Not(HasSubstr("nan")));
}

TEST(Drawings, FarOffLandmarksDoNotShrinkThePlace) {
  PlaceDrawing place;
  place.path = {{CameraAt(0, 0, 0), CameraAt(0, 0, 1)}};
  for (int i = 0; i < 100; ++i) place.landmarks.emplace_back(0.02 * i - 1, 0, 0.02 * i - 1);
  place.landmarks.emplace_back(0, 0, 1e6);
  const auto p = PathPoints(DrawPlace(place, PlaceView::kAbove));
  EXPECT_GT((p[1] - p[0]).norm(), 100);
}

TEST(Drawings, TimelineBarsAreAsLongAsTheirFrames) {
  using enum FrameFate;
  const std::string svg = DrawTimeline({kStarting, kTracked, kTracked, kLost});
  EXPECT_THAT(svg, HasSubstr("class=\"starting\" x=\"0.00\" y=\"0\" width=\"225.00\""));
  EXPECT_THAT(svg, HasSubstr("class=\"tracked\" x=\"225.00\" y=\"0\" width=\"450.00\""));
  EXPECT_THAT(svg, HasSubstr("class=\"lost\" x=\"675.00\" y=\"0\" width=\"225.00\""));
}

TEST(Histogram, BarsAreAsTallAsTheyAreFull) {
  std::vector<double> values(300, 1.0);
  values.insert(values.end(), 100, 3.0);
  values.push_back(1000);  // one of 401: beyond the end of the axis
  const std::string svg = DrawHistogram(values, "ms", "times");
  std::vector<double> tall;
  const std::regex bar("class=\"bar\" [^/]*height=\"([0-9.]+)\"");
  for (std::sregex_iterator it(svg.begin(), svg.end(), bar), end; it != end; ++it)
    tall.push_back(std::stod((*it)[1]));
  ASSERT_EQ(tall.size(), 2u);  // the last bar includes the large value
  EXPECT_NEAR(tall[1] / tall[0], 101.0 / 300, 0.01);
}

TEST(Histogram, LabelsDoNotOverlap) {
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back(2.1 * i);  // "1000 ms", "1500 ms", "2000 ms"
  const std::string svg = DrawHistogram(values, "ms", "times");
  EXPECT_THAT(svg, HasSubstr(">1000 ms<"));
  EXPECT_THAT(svg, Not(HasSubstr("e+03")));
  const std::regex label("<text x=\"([0-9.]+)\"[^>]*>([^<]*)<");
  double end = -1;
  int count = 0;
  for (std::sregex_iterator it(svg.begin(), svg.end(), label), last; it != last; ++it, ++count) {
    const double middle = std::stod((*it)[1]), half = 4.0 * static_cast<double>((*it)[2].length());
    EXPECT_GT(middle - half, end);
    end = middle + half;
    EXPECT_LE(end, 440);
  }
  EXPECT_GE(count, 3);
}

TEST(Report, EachStageThatRanHasAHistogram) {
  RunReport report;
  report.milliseconds = {{"frame", {1, 2, 3}}, {"map", {4, 5}}, {"loop", {}}};
  EXPECT_EQ(Count(RenderReport(report), "aria-label=\"histogram: "), 2);
}

TEST(Report, WordsOfOthersCannotBecomeMarkup) {
  RunReport report;
  report.title = "<script>alert(1)</script>";
  report.warnings = {"a & b < c"};
  const std::string html = RenderReport(report);
  EXPECT_THAT(html, Not(HasSubstr("<script>")));
  EXPECT_THAT(html, HasSubstr("a &amp; b &lt; c"));
}

TEST(Report, FailureShapeAndNextStepsComeFirst) {
  RunReport report;
  EXPECT_THAT(RenderReport(report), Not(HasSubstr("role=\"note\"")));
  report.failure = {"Nothing was mapped: the images are black."};
  report.warnings = {"no depth"};
  report.lost_spans = {"1.00 s to 2.00 s: the image was blurred."};
  report.unit = "map units";
  report.on_units = "Lengths are in map units.";
  report.cloud.path = {{CameraAt(0, 0, 0), CameraAt(0, 0, 1)}};
  for (int i = 0; i < 100; ++i)
    report.cloud.cloud.points.emplace_back(0.1f * static_cast<float>(i), 1.f, 2.f);
  report.next = {{"See it", "alidade view 'a b'"}};
  report.facts = {{"source", "walk"}};
  const std::string html = RenderReport(report);
  size_t at = 0;
  for (const char* part :
       {"role=\"note\"", "images are black", "<h2>Lost</h2>", "<h2>Warnings</h2>", "<h2>Landmarks",
        "in map units.", "data-unit=\"map units\"", "What to do next", "alidade view 'a b",
        "<th>source"}) {
    const size_t found = html.find(part, at);
    ASSERT_NE(found, std::string::npos) << part;
    at = found;
  }
}

TEST(Report, EveryMapIsDrawnFromAboveAndFromTheSide) {
  RunReport report;
  PlaceDrawing place;
  place.path = {{CameraAt(0, 0, 0), CameraAt(0, 0, 1)}};
  report.maps = {{"40 frames", place}};
  EXPECT_EQ(Count(RenderReport(report), "<polyline class=\"path\""), 2);
  EXPECT_THAT(RenderReport(report), Not(HasSubstr("40 frames")));
  place.truth = {{CameraAt(0, 0.1, 0), CameraAt(0, 0.1, 1)}};
  report.maps.push_back({"12 frames", place});
  const std::string html = RenderReport(report);
  EXPECT_EQ(Count(html, "<polyline class=\"path\""), 4);
  EXPECT_EQ(Count(html, "<polyline class=\"truth\""), 2);
  EXPECT_THAT(html, HasSubstr("Map 2 of 2</h2>\n<p class=\"soft\">12 frames"));
}

TEST(Report, CloudIsThinnedAndItsPictureStaysWhereThereAreNoScripts) {
  RunReport report;
  EXPECT_THAT(RenderReport(report), Not(HasSubstr("<canvas")));
  report.cloud.path = {{CameraAt(0, 0, 0), CameraAt(0, 0, 1)}};
  for (int i = 0; i < 60000; ++i)
    report.cloud.cloud.points.emplace_back(i % 100 / 100.f, i / 100 % 100 / 100.f, i / 10000 / 6.f);
  report.cloud_picture = {"the place", "image/jpeg", "Man"};
  const std::string html = RenderReport(report);
  EXPECT_THAT(html, HasSubstr("alt=\"the place\" src=\"data:image/jpeg;base64,TWFu\""));
  EXPECT_THAT(html, HasSubstr("data-points=\"50000\" data-path=\"2\" data-colored=\"0\""));
  EXPECT_LT(html.size(), 1u << 20);
  // 6 bytes per point and pose, in base64.
  const size_t begin = html.find('>', html.find("data-points")) + 1;
  EXPECT_EQ(html.find('<', begin) - begin, 6 * 50002 / 3 * 4u);
}

TEST(Report, PicturesAreWithinThePage) {
  RunReport report;
  report.shape = {{"from above", "image/png", "Man"}, {"a<b", "image/jpeg", "Ma"}};
  const std::string html = RenderReport(report);
  EXPECT_THAT(html, HasSubstr("alt=\"from above\" src=\"data:image/png;base64,TWFu\""));
  EXPECT_THAT(html, HasSubstr("alt=\"a&lt;b\" src=\"data:image/jpeg;base64,TWE=\""));
}

TEST(Report, SectionsOfLaterCommandsAreAddedAndReplaced) {
  const std::string page = RenderReport({});
  std::string more = WithSection(page, "grid", "<p>first</p>\n");
  more = WithSection(more, "mesh", "<p>mesh</p>\n");
  more = WithSection(more, "grid", "<p>second</p>\n");
  EXPECT_EQ(more.find("<p>first"), std::string::npos);
  EXPECT_LT(more.find("<p>second</p>"), more.find("<p>mesh</p>"));
  EXPECT_LT(more.find("<p>mesh</p>"), more.find("<h2>Frames</h2>"));
  EXPECT_EQ(WithSection("<p>an older page</p>", "grid", "x"), "<p>an older page</p>");
}

TEST(DrawGrid, HoldsTheCellsAndAllOfThePath) {
  GridDrawing grid{4, 2, 0.5, 0, 0, "Man", {}, "m"};  // 2 m by 1 m
  grid.path = {{0, 0}, {-1, 0}};                      // 1 m beyond: 3 m and two cells are 900 wide
  const std::string svg = DrawGrid(grid);
  EXPECT_THAT(svg, HasSubstr("base64,TWFu\" x=\"337.5\" y=\"112.5\" width=\"450.0\""));
  EXPECT_THAT(svg, HasSubstr("points=\"337.5,337.5 112.5,337.5 \""));
  EXPECT_THAT(svg, HasSubstr(">0.5 m</text>"));
}

TEST(Base64, EncodesAsTheStandardsExamples) {
  // RFC 4648, §10.
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64("\xfb\xff\xfe"), "+//+");
}

}  // namespace
}  // namespace alidade::drawings_test
