// How the picture of a frame without a pose looks: dark, blurred, bare or none of these.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

namespace alidade {

enum class Look { kOrdinary, kDark, kBlurred, kBare };

struct LookSettings {
  double dark = 25;    // mean grey level (0…255) below which a picture is dark
  double blur = 0.25;  // share of what the run's sharp pictures have over 1 in BlurOf() that must
                       // be gone. Cameras differ: sharp is 0.25 to 0.55, blurred 0.6 and more
  double contrast = 2.5;  // CoarseContrast() in grey levels below which a picture is bare: rooms
                          // have 6 to 17, empty walls with their shadows 2
  double corners = 0.25;  // share of the corners wanted below which a sharp picture is bare: a
                          // third is enough to go on
  void Check() const;     // throws Error (usage) naming the field that cannot be

  // As SlamSettings::Set() and All(); names begin with "look.".
  void Set(const std::string& name, const std::string& value);
  std::vector<std::pair<std::string, std::string>> All() const;
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
