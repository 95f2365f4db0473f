// What a run's report and its last line say of what went wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "alidade/io/files/image_file.h"
#include "support/bare_wall.h"
#include "support/program.h"
#include "support/sliding_recording.h"

namespace alidade::report_words_test {
namespace {

using testing::HasSubstr;
using testing::Not;

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
  EXPECT_THAT(Lost(), HasSubstr("the image was blurred. Move more slowly, or use more light"));
}

TEST_F(ReportWords, BareWall) {
  LastLines([](const cv::Mat& image) {
    cv::Mat wall;
    cv::resize(BareWall(), wall, image.size());
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
