#include "alidade/io/files/kitti_calibration.h"

#include "alidade/base/error.h"
#include "fuzz/targets.h"
#include "fuzz/use_calibration.h"

namespace alidade::fuzz {

// The gray pair and the color pair.
void KittiCalibration(std::string_view bytes) {
  const std::string text(bytes);
  try {
    UseCalibration(ParseKittiCalibration(text, "calib.txt", 2, {20, 16}));
  } catch (const Error&) {
  }
  UseCalibration(ParseKittiCalibration(text, "calib.txt", 0, {20, 16}));
}

}  // namespace alidade::fuzz
