// How the picture of a frame without a pose looks: dark, blurred, bare or none of these.
#pragma once

#include <opencv2/core.hpp>
#include <span>

namespace alidade {

enum class Look { kOrdinary, kDark, kBlurred, kBare };

struct Setting;

// Range, unit and meaning: Table() in look.cc.
struct LookSettings {
  double min_brightness = 25;
  // Cameras differ: sharp images have 0.25 to 0.55 in BlurOf(), blurred ones 0.6 and more.
  double blur = 0.25;
  // Rooms have 6 to 17, empty walls with their shadows 2.
  double contrast = 2.5;
  // A third is enough for tracking.
  double corners = 0.25;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

// What BlurOf() is of a sharp picture when none was seen: in the middle of those of cameras.
inline constexpr double kUsualBlur = 0.4;

// 0: sharp, 1: blurred. How little of the differences between neighbours is lost when the picture
// is blurred once more, by 9 pixels along a row or a column; the larger of the two, as motion blurs
// one way only. Crété-Roffet et al. 2007, "The blur effect". `gray`: CV_8UC1.
double BlurOf(const cv::Mat& gray);

// Mean difference, in grey levels, between neighbours of the picture at an eighth of its size: what
// blur of some pixels leaves, and a bare wall does not have. `gray`: CV_8UC1.
double CoarseContrast(const cv::Mat& gray);

// `corners`: how many were found, as a share of those wanted. `usual_blur`: BlurOf() of the run's
// other pictures. Takes about a millisecond.
Look LookOf(const cv::Mat& gray, double corners, double usual_blur = kUsualBlur,
            const LookSettings& settings = {});

}  // namespace alidade
