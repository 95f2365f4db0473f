// Classifies the images of frames without a pose: dark, blurred, without texture, or none of these.
#pragma once

#include <opencv2/core.hpp>
#include <span>

namespace alidade {

enum class Look { kOrdinary, kDark, kBlurred, kBare };

struct Setting;

// Range, unit and meaning: Table() in image_condition.cc.
struct LookSettings {
  double min_brightness = 25;
  // BlurOf() depends on the camera: 0.25 to 0.55 for sharp images, above 0.6 for blurred ones.
  double blur = 0.25;
  // Rooms have 6 to 17, blank walls with shadows 2.
  double contrast = 2.5;
  // A third is enough for tracking.
  double corners = 0.25;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

// BlurOf() of a sharp image if none has been seen: the middle of the usual range.
inline constexpr double kUsualBlur = 0.4;

// 0: sharp, 1: blurred. Share of the differences between neighboring pixels that remains when the
// image is blurred by 9 pixels along rows or columns; the larger one of both, since motion blurs in
// one direction. Crété-Roffet et al. 2007, "The blur effect". `gray`: CV_8UC1.
double BlurOf(const cv::Mat& gray);

// Mean difference, in gray levels, between neighboring pixels of the image at an eighth of its
// size. It survives a blur of some pixels, and is low for a blank wall. `gray`: CV_8UC1.
double CoarseContrast(const cv::Mat& gray);

// `corners`: number found, as a share of those wanted. `usual_blur`: BlurOf() of the other images
// of the run. Takes about a millisecond.
Look LookOf(const cv::Mat& gray, double corners, double usual_blur = kUsualBlur,
            const LookSettings& settings = {});

}  // namespace alidade
