#include "alidade/run/results/image_condition.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/settings_table.h"

namespace alidade {
namespace {

constexpr int kTaps = 9;    // of the added blur, as in the paper
constexpr int kLines = 48;  // number of rows and columns used, evenly distributed

// Sums over one row or column of the image.
struct Differences {
  double all = 0;   // between neighbours
  double lost = 0;  // the part that the added blur removes
  void Add(const std::vector<int>& line) {
    const int count = static_cast<int>(line.size());
    for (int i = kTaps / 2 + 1; i + kTaps / 2 < count; ++i) {
      const auto at = [&](int k) { return line[static_cast<size_t>(k)]; };
      const int sharp = std::abs(at(i) - at(i - 1));
      // Difference of two neighboring means of kTaps pixels.
      const double blurred =
          std::abs(at(i + kTaps / 2) - at(i - kTaps / 2 - 1)) / static_cast<double>(kTaps);
      all += sharp;
      lost += std::max(0.0, sharp - blurred);
    }
  }
  double Blur() const { return all > 0 ? (all - lost) / all : 1; }
};

}  // namespace

std::span<const Setting> LookSettings::Table() {
  using T = LookSettings;
  static constexpr Setting kRows[] = {
      PublicSetting<&T::min_brightness>("look.min_brightness", FromTo(0, 255), "gray levels",
                                        "Lost frames with a lower mean are reported as dark."),
      PublicSetting<&T::blur>("look.blur", kZeroToOne, "",
                              "Lost frames that lost this share of the sharpness of the others are "
                              "reported as blurred."),
      ExpertSetting<&T::contrast>("look.contrast", FromTo(0, 255), "gray levels",
                                  "Lost frames with less coarse contrast are reported as bare."),
      ExpertSetting<&T::corners>("look.corners", kZeroToOne, "",
                                 "Lost sharp frames with less than this share of the wanted "
                                 "keypoints are reported as bare."),
  };
  return kRows;
}

void LookSettings::Check() const { CheckRanges(*this); }

double BlurOf(const cv::Mat& gray) {
  Differences along, down;
  std::vector<int> line(static_cast<size_t>(gray.cols));
  for (int y = 0; y < gray.rows; y += 1 + gray.rows / kLines) {
    for (int x = 0; x < gray.cols; ++x) line[static_cast<size_t>(x)] = gray.at<uchar>(y, x);
    along.Add(line);
  }
  line.resize(static_cast<size_t>(gray.rows));
  for (int x = 0; x < gray.cols; x += 1 + gray.cols / kLines) {
    for (int y = 0; y < gray.rows; ++y) line[static_cast<size_t>(y)] = gray.at<uchar>(y, x);
    down.Add(line);
  }
  return std::max(along.Blur(), down.Blur());
}

double CoarseContrast(const cv::Mat& gray) {
  constexpr int kSmaller = 8;
  const cv::Size size(std::max(2, gray.cols / kSmaller), std::max(2, gray.rows / kSmaller));
  cv::Mat small;
  cv::resize(gray, small, size, 0, 0, cv::INTER_AREA);
  const cv::Rect left(0, 0, size.width - 1, size.height), right(1, 0, left.width, left.height);
  const cv::Rect above(0, 0, size.width, size.height - 1), below(0, 1, above.width, above.height);
  const auto mean = [&](const cv::Rect& a, const cv::Rect& b) {
    return cv::norm(small(a), small(b), cv::NORM_L1) / static_cast<double>(a.area());
  };
  return std::max(mean(left, right), mean(above, below));
}

Look LookOf(const cv::Mat& gray, double corners, double usual_blur, const LookSettings& settings) {
  if (gray.empty() || gray.type() != CV_8UC1) return Look::kOrdinary;
  if (cv::mean(gray)[0] < settings.min_brightness) return Look::kDark;
  if (CoarseContrast(gray) < settings.contrast) return Look::kBare;
  if (BlurOf(gray) > usual_blur + settings.blur * (1 - usual_blur)) return Look::kBlurred;
  return corners < settings.corners ? Look::kBare : Look::kOrdinary;
}

}  // namespace alidade
