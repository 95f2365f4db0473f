#include "alidade/run/setup/mask_file.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/io/files/image_file.h"

namespace alidade {
namespace {

constexpr double kMost = 0.9;        // of the image: too little is left for poses
constexpr double kSameShape = 0.02;  // relative difference of width / height

std::string Size(int width, int height) {
  return std::to_string(width) + " × " + std::to_string(height);
}

}  // namespace

cv::Mat ReadMaskFile(const std::string& path, const Camera& camera) {
  cv::Mat mask = ReadImageGray(path);
  const double shape = static_cast<double>(mask.cols) * camera.height /
                       (static_cast<double>(mask.rows) * camera.width);
  if (!(std::abs(shape - 1) <= kSameShape)) {
    ThrowInput(path + ": a mask of " + Size(mask.cols, mask.rows) + " does not fit images of " +
               Size(camera.width, camera.height));
  }
  cv::threshold(mask, mask, 127, 255, cv::THRESH_BINARY);  // JPEG's black is not quite black
  const double share = cv::countNonZero(mask) / static_cast<double>(mask.total());
  if (share == 0) ThrowInput(path + ": the mask is black, which leaves out nothing (white does)");
  if (share > kMost) {
    ThrowInput(path + ": the mask leaves out " + std::to_string(std::lround(100 * share)) +
               " % of the image (white is left out, black is used)");
  }
  return mask;
}

}  // namespace alidade
