// What a run's report and its last line say of what went wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "alidade/io/files/image_file.h"
#include "alidade/run/look.h"
#include "alidade/run/untracked.h"
#include "support/program.h"
#include "support/sliding_recording.h"
#include "support/texture.h"

namespace alidade::report_words_test {
namespace {

using testing::HasSubstr;
using testing::Not;

// Grey, lighter in the middle, with a camera's noise.
cv::Mat Wall() {
  cv::Mat wall(480, 640, CV_8UC1);
  for (int y = 0; y < wall.rows; ++y) {
    for (int x = 0; x < wall.cols; ++x)
      wall.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(
          190 - 60 * (cv::Point2d(x / 640.0 - 0.5, y / 480.0 - 0.5).dot({x / 640.0 - 0.5, 0}) +
                      (y / 480.0 - 0.5) * (y / 480.0 - 0.5)));
  }
  AddNoise(wall, 2, 3);
  return wall;
}

cv::Mat BlurredOneWay(const cv::Mat& picture) {
  cv::Mat blurred;
  cv::blur(picture, blurred, cv::Size(51, 1));
  return blurred;
}

TEST(Look, TellsBlurFromABareWallAndTheDark) {
  const cv::Mat room = MakeTexture(640, 480, 5);
  EXPECT_EQ(LookOf(room, 1), Look::kOrdinary);
  for (const double corners : {1.0, 0.05}) {  // blurred pictures have few, too
    EXPECT_EQ(LookOf(BlurredOneWay(room), corners), Look::kBlurred);
    EXPECT_EQ(LookOf(BlurredOneWay(room.t()).t(), corners), Look::kBlurred);
  }
  EXPECT_EQ(LookOf(Wall(), 1), Look::kBare);
  EXPECT_EQ(LookOf(room, 0.1), Look::kBare);
  EXPECT_EQ(LookOf(cv::Mat(room * 0.1), 1), Look::kDark);
}

TEST(Look, OddPicturesAreNoTrouble) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 200), cv::Size(200, 3)})
    EXPECT_NO_THROW(LookOf(cv::Mat(size, CV_8UC1, cv::Scalar(100)), 0));
  EXPECT_EQ(LookOf(cv::Mat(), 0), Look::kOrdinary);
  EXPECT_EQ(LookOf(cv::Mat(48, 64, CV_8UC3, cv::Scalar(0, 0, 0)), 0), Look::kOrdinary);
}

TEST(LostInWords, SaysWhatBeganItAndWhatHelpsToComeBack) {
  const std::vector<UntrackedFrames> untracked = {
      {100, 100, "too few landmarks found", Look::kBlurred, 1},
      {100.1, 100.3, "the place was not recognised", Look::kBlurred, 3},
      {100.4, 106, "the place was not recognised", Look::kOrdinary, 56}};
  const auto lines = LostInWords({{100, 106.1}}, untracked, 90);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], HasSubstr("10.00 s to 16.10 s: the picture was blurred."));
  EXPECT_THAT(lines[0], HasSubstr("going back to where the camera has been"));
  EXPECT_THAT(LostInWords({{100, 101}}, {}, 90)[0], HasSubstr("given up"));
}

class ReportWords : public testing::Test {
 protected:
  // A recording whose frames 12 to 17 look otherwise; what the run says at its end.
  template <typename Change>
  std::string LastLines(Change&& change) {
    SlidingRecording options;
    options.frames = 24;
    WriteSlidingTum(recording_, options);
    for (int i = 12; i < 18; ++i) {
      const std::string path = recording_ / SlidingImage(i);
      WriteImage(path, change(ReadImageGray(path)));
    }
    const ProgramResult result = RunAlidade({"run", recording_.path(), "--out", out_});
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }
  std::string Report() const { return ReadText(out_ + "/report.html"); }
  // What it says of the stretches without poses; empty: nothing.
  std::string Lost() const {
    const std::string report = Report();
    const size_t begin = report.find("<h2>Lost</h2>");
    return begin == std::string::npos ? ""
                                      : report.substr(begin, report.find("</ul>", begin) - begin);
  }

  TempFolder recording_, results_;
  const std::string out_ = results_ / "out";
};

TEST_F(ReportWords, BlurredStretch) {
  EXPECT_THAT(LastLines([](const cv::Mat& image) {  // what blurs one way only is still tracked
                cv::Mat blurred;
                cv::blur(image, blurred, cv::Size(71, 13));
                return blurred;
              }),
              HasSubstr("tracked, lost once, "));
  EXPECT_THAT(Lost(), HasSubstr("the picture was blurred. More light, or moving more slowly"));
}

TEST_F(ReportWords, BareWall) {
  LastLines([](const cv::Mat& image) {
    cv::Mat wall;
    cv::resize(Wall(), wall, image.size());
    return wall;
  });
  EXPECT_THAT(Lost(), HasSubstr("as in front of a bare wall"));
  EXPECT_THAT(Lost(), Not(HasSubstr("blurred")));
}

TEST_F(ReportWords, AllIsWell) {
  const std::string said = LastLines([](const cv::Mat& image) { return image; });
  EXPECT_THAT(said, HasSubstr("24 of 24 frames tracked; "));
  EXPECT_EQ(Lost(), "");
  EXPECT_NE(Report().find("<th>lost</th><td>never</td>"), std::string::npos);
}

}  // namespace
}  // namespace alidade::report_words_test
