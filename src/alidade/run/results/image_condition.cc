#include "alidade/run/results/image_condition.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/run/setup/setting_group.h"

namespace alidade {
namespace {

constexpr int kTaps = 9;    // of the blur that is added, as in the paper
constexpr int kLines = 48;  // rows and columns looked at, evenly: the measure is a mean of many

// Sums over one line of the picture.
struct Differences {
  double all = 0;   // between neighbours
  double lost = 0;  // of these, what the added blur takes away
  void Add(const std::vector<int>& line) {
    const int count = static_cast<int>(line.size());
    for (int i = kTaps / 2 + 1; i + kTaps / 2 < count; ++i) {
      const auto at = [&](int k) { return line[static_cast<size_t>(k)]; };
      const int sharp = std::abs(at(i) - at(i - 1));
      // The difference of two neighbouring means of kTaps pixels.
      const double blurred =
          std::abs(at(i + kTaps / 2) - at(i - kTaps / 2 - 1)) / static_cast<double>(kTaps);
      all += sharp;
      lost += std::max(0.0, sharp - blurred);
    }
  }
  double Blur() const { return all > 0 ? (all - lost) / all : 1; }
};

// `s` is a LookSettings, const or not.
constexpr auto kVisit = [](auto& s, auto&& visit) {
  visit("look.blur", s.blur);
  visit("look.contrast", s.contrast);
  visit("look.corners", s.corners);
  visit("look.dark", s.dark);
};

}  // namespace

void LookSettings::Check() const {
  const auto within = [](double value, int most, const char* name) {
    if (!(value >= 0 && value <= most))
      ThrowUsage("look." + std::string(name) + " must be within 0…" + std::to_string(most));
  };
  within(dark, 255, "dark");
  within(blur, 1, "blur");
  within(contrast, 255, "contrast");
  within(corners, 1, "corners");
}

void LookSettings::Set(const std::string& name, const std::string& value) {
  SetByName(*this, kVisit, name, value);
}

std::vector<std::pair<std::string, std::string>> LookSettings::All() const {
  return AllByName(*this, kVisit);
}

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
  if (cv::mean(gray)[0] < settings.dark) return Look::kDark;
  if (CoarseContrast(gray) < settings.contrast) return Look::kBare;
  if (BlurOf(gray) > usual_blur + settings.blur * (1 - usual_blur)) return Look::kBlurred;
  return corners < settings.corners ? Look::kBare : Look::kOrdinary;
}

}  // namespace alidade
