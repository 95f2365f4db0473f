// Images of odd sizes, of 4K and of 8K: whole runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/files/image_file.h"
#include "support/rendered.h"

namespace alidade::image_sizes_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class ImageSizes : public testing::Test {
 protected:
  ProgramResult Run(const std::string& source, std::vector<std::string> options = {}) {
    std::vector<std::string> arguments = {"run", source, "--out", out_, "--overwrite"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return RunAlidade(arguments);
  }
  // Root mean square error, meters; with depth, the scale is known.
  double Error(const std::string& truth) const {
    const ProgramResult result =
        RunAlidade({"evaluate", "ate", truth, out_ + "/trajectory.txt", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out, nullptr, false).value("rmse", 1e9);
  }
  size_t Poses() const { return DataLines(out_ + "/trajectory.txt").size(); }

  TempFolder folder_;
  std::string out_ = folder_ / "out";
};

TEST_F(ImageSizes, ThatAreOddRunWithEveryOutput) {
  for (const auto& [width, height] : {std::pair("641", "479"), std::pair("333", "251")}) {
    const std::string room =
        Rendered({"room", "--frames", "16", "--width", width, "--height", height});
    const ProgramResult result = Run(room, {"--record", "--semidense"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(Poses(), 16u);
    EXPECT_LT(Error(room), 0.02);
    const ProgramResult mono = Run(room, {"--sensor", "mono"});
    ASSERT_EQ(mono.status, 0) << mono.err;
    const std::string pair =
        Rendered({"room", "--frames", "12", "--width", width, "--height", height, "--stereo"});
    ASSERT_EQ(Run(pair).status, 0);
    EXPECT_EQ(Poses(), 12u);
  }
}

// The calibration is that of the small images, and so is the depth: both are scaled.
TEST_F(ImageSizes, Of4KAnd8KAreWorkedOnAtASensibleSize) {
  const std::string small =
      Rendered({"room", "--frames", "5", "--fps", "10", "--width", "640", "--height", "360"});
  for (const int times : {6, 12}) {
    const TempFolder folder;
    const std::string large = CopyOf(small, folder);
    for (const auto& entry : fs::directory_iterator(large + "/rgb")) {
      cv::Mat image;
      cv::resize(ReadImageColor(entry.path().string()), image, {}, times, times, cv::INTER_LINEAR);
      // As JPEG, which is faster to write; the content tells the format.
      AtomicWriteFile(entry.path().string(), EncodeJpeg(image, 95), Sync::kNo);
    }
    const ProgramResult result = Run(large);
    ASSERT_EQ(result.status, 0) << result.err;
    const std::string size = std::to_string(640 * times) + "x" + std::to_string(360 * times);
    EXPECT_THAT(result.err, HasSubstr("images of " + size + " are downscaled to 1920x1080"));
    EXPECT_THAT(result.out, HasSubstr("Depth images of 640x360 are scaled up to " + size));
    EXPECT_EQ(Poses(), 5u);
    EXPECT_LT(Error(large), 0.02);
  }
}

}  // namespace
}  // namespace alidade::image_sizes_test
