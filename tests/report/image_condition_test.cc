// What the image of a frame without a pose looks like, and what a report says of it.
#include "alidade/run/results/image_condition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "alidade/run/results/untracked.h"
#include "support/bare_wall.h"
#include "support/texture.h"

namespace alidade::image_condition_test {
namespace {

using testing::HasSubstr;

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
  EXPECT_EQ(LookOf(BareWall(), 1), Look::kBare);
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
      {100.1, 100.3, "the place was not recognized", Look::kBlurred, 3},
      {100.4, 106, "the place was not recognized", Look::kOrdinary, 56}};
  const auto lines = LostInWords({{100, 106.1}}, untracked, 90);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], HasSubstr("10.00 s to 16.10 s: the image was blurred."));
  EXPECT_THAT(lines[0], HasSubstr("return to a place"));
  EXPECT_THAT(LostInWords({{100, 101}}, {}, 90)[0], HasSubstr("dropped"));
}

}  // namespace
}  // namespace alidade::image_condition_test
