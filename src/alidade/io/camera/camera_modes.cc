#include "alidade/io/camera/camera_modes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "alidade/base/print.h"

namespace alidade {
namespace {

constexpr double kUsualFps = 30, kUsualPixels = 640 * 480;

// Smaller is better.
std::tuple<double, double, int, double> CostOf(const CameraMode& mode,
                                               const CameraRequest& request) {
  double pixels = mode.size.area();
  if (request.stereo != StereoLayout::kNone) pixels /= 2;
  const double size = request.size.empty() ? std::abs(std::log(pixels / kUsualPixels)) : 0;
  const double missing =
      request.fps > 0 ? std::abs(mode.fps - request.fps) : std::max(0.0, kUsualFps - mode.fps);
  return {missing, size, PreferenceOf(*mode.format), mode.fps};
}

}  // namespace

const CameraMode* ChooseMode(const std::vector<CameraMode>& modes, const CameraRequest& request) {
  const CameraMode* best = nullptr;
  for (const CameraMode& mode : modes) {
    if (!request.format.empty() && mode.format->name != request.format) continue;
    if (!request.size.empty() && mode.size != request.size) continue;
    if (!best || CostOf(mode, request) < CostOf(*best, request)) best = &mode;
  }
  return best;
}

std::string NameOf(const CameraMode& mode) {
  char text[80];
  PrintTo(text, sizeof text, "%d x %d %s", mode.size.width, mode.size.height, mode.format->name);
  std::string name = text;
  if (mode.fps > 0) {
    PrintTo(text, sizeof text, " at %.4g per second", mode.fps);
    name += text;
  }
  return name;
}

}  // namespace alidade
