#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/map/map_file.h"

namespace alidade {
namespace {

constexpr double kMaxDepthError = 0.005;  // relative
constexpr double kSigmas = 3;
constexpr double kMostShift = 0.03;  // of half the diagonal, for two calibrations of one camera
// Steps of the grid of compared pixels, in each direction.
constexpr int kSteps = 8;

// Displacements between the two cameras' pixels of one viewing direction, pixels.
struct Shifts {
  double largest = 0;
  double mean = 0;    // length of the mean: another principal point, nearly a rotation
  double others = 0;  // largest one apart from the mean
};

Shifts ShiftsOf(const Camera& saved, const Camera& now) {
  const Camera &a = saved, &b = now;
  if (a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
      a.distortion == b.distortion) {
    return {};  // also if the parameters are not finite
  }
  std::vector<Eigen::Vector2d> shifts;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel((saved.width - 1.0) * column / kSteps,
                                  (saved.height - 1.0) * row / kSteps);
      const Eigen::Vector3d direction = saved.Unproject(saved.Undistort(pixel));
      const Eigen::Vector2d there = saved.Distort(saved.Project(direction));
      shifts.emplace_back(now.Distort(now.Project(direction)) - there);
      mean += shifts.back();
    }
  }
  mean /= static_cast<double>(shifts.size());
  Shifts result;
  result.mean = mean.norm();
  for (const Eigen::Vector2d& shift : shifts) {
    const double whole = shift.norm(), other = (shift - mean).norm();
    if (!(whole <= result.largest)) result.largest = whole;  // also for NaN
    if (!(other <= result.others)) result.others = other;
  }
  return result;
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
                    ShiftsOf(saved, now).largest < kSameCamera &&
                    !DepthDiffers(saved.depth_factor, now.depth_factor) &&
                    !DepthDiffers(saved.baseline, now.baseline);
  if (same) return;
  const bool calibrations = saved.width == now.width && saved.height == now.height;
  ThrowInput("the map was made with another camera: " + Differences(saved, now) +
             (calibrations ? ". If it is one camera, calibrate it once for all recordings: alidade "
                             "calibrate RECORDING RECORDING --out camera.yaml, then run each with "
                             "--camera camera.yaml"
                           : ""));
}

double CameraShift(const Camera& a, const Camera& b) {
  if (a.width != b.width || a.height != b.height) return std::numeric_limits<double>::infinity();
  return ShiftsOf(a, b).largest;
}

bool MayBeOneCamera(const Camera& a, const Camera& b) {
  const double larger = std::max(a.focal_sigma, b.focal_sigma);
  if (!(larger > 0) || a.baseline > 0 || b.baseline > 0) return false;
  const auto sigma = [&](const Camera& camera) {
    return camera.focal_sigma > 0 ? camera.focal_sigma : larger;
  };
  if (a.width != b.width || a.height != b.height) return false;
  const double radius = 0.5 * std::hypot(a.width, a.height);
  const double sigmas = kSigmas * std::hypot(sigma(a), sigma(b));
  const Shifts shifts = ShiftsOf(a, b);
  return shifts.mean <= kMostShift * radius &&
         shifts.others <= kSameCamera + std::min(sigmas, kMostShift) * radius;
}

}  // namespace alidade
