#include <cmath>
#include <locale>
#include <sstream>

#include "alidade/base/error.h"
#include "alidade/map/map_file.h"

namespace alidade {
namespace {

constexpr double kMaxShift = 0.5;         // pixels
constexpr double kMaxDepthError = 0.005;  // relative
// Steps of the grid of compared pixels, in each direction.
constexpr int kSteps = 8;

// Largest displacement between the two cameras for the same viewing direction, pixels.
double LargestShift(const Camera& saved, const Camera& now) {
  const Camera &a = saved, &b = now;
  if (a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
      a.distortion == b.distortion) {
    return 0;  // also if the parameters are not finite
  }
  double largest = 0;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel((saved.width - 1.0) * column / kSteps,
                                  (saved.height - 1.0) * row / kSteps);
      const Eigen::Vector3d direction = saved.Unproject(saved.Undistort(pixel));
      const Eigen::Vector2d there = saved.Distort(saved.Project(direction));
      const double shift = (now.Distort(now.Project(direction)) - there).norm();
      if (!(shift <= largest)) largest = shift;  // also for NaN
    }
  }
  return largest;
}

bool DepthDiffers(double saved, double now) {
  return saved > 0 && now > 0 && !(std::abs(now / saved - 1) < kMaxDepthError);
}

// Lists all differing parameters, e.g. "fx 525 there, 520 here".
std::string Differences(const Camera& saved, const Camera& now) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);
  const char* gap = "";
  const auto compare = [&](const char* name, double there, double here) {
    if (std::abs(there - here) <= 1e-9 * std::abs(there)) return;
    out << gap << name << ' ' << there << " in the map, " << here << " here";
    gap = "; ";
  };
  compare("width", saved.width, now.width);
  compare("height", saved.height, now.height);
  compare("fx", saved.fx, now.fx);
  compare("fy", saved.fy, now.fy);
  compare("cx", saved.cx, now.cx);
  compare("cy", saved.cy, now.cy);
  const char* names[] = {"k1", "k2", "p1", "p2", "k3"};
  for (size_t i = 0; i < saved.distortion.size(); ++i) {
    compare(names[i], saved.distortion[i], now.distortion[i]);
  }
  if (saved.depth_factor > 0 && now.depth_factor > 0) {
    compare("depth_factor", saved.depth_factor, now.depth_factor);
  }
  if (saved.baseline > 0 && now.baseline > 0) compare("baseline", saved.baseline, now.baseline);
  return out.str();
}

}  // namespace

void CheckSameCamera(const Camera& saved, const Camera& now) {
  const bool same = saved.width == now.width && saved.height == now.height &&
                    LargestShift(saved, now) < kMaxShift &&
                    !DepthDiffers(saved.depth_factor, now.depth_factor) &&
                    !DepthDiffers(saved.baseline, now.baseline);
  if (!same) ThrowInput("the map was made with another camera: " + Differences(saved, now));
}

}  // namespace alidade
