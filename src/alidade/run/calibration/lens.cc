#include "alidade/run/calibration/lens.h"

#include <cmath>
#include <new>

#include "alidade/base/print.h"
#include "alidade/map/view.h"

namespace alidade {
LensCheck CheckLens(const Slam& slam, const SlamSettings& used, const LensCheckSettings& settings) {
  if (used.localize) return {};
  try {
    const MapSnapshot map = slam.Snapshot();
    const MapId largest = LargestMap(map);
    MeasurementNoise noise = used.mapper.noise;
    noise.right_from_sensor = slam.camera().baseline <= 0;
    return largest.valid() ? CheckLens(map, largest, slam.camera(), noise, settings) : LensCheck{};
  } catch (const std::bad_alloc&) {  // the warning is optional
    return {};
  }
}

std::string LensInWords(const LensCheck& check, const Camera& camera) {
  if (!check.strong) return "";
  char how[80];
  PrintTo(how, sizeof(how), " (k1 near %.2f, a shift of %.0f %% at the image corners)", check.k1,
          100 * std::abs(check.bend));
  const std::string than = camera.HasDistortion() ? " beyond its calibration" : "";
  return "this camera has strong radial distortion" + than + how +
         " that is not corrected, so trajectory and map are distorted. Use a calibration with "
         "distortion: --camera (docs/reference/camera.md)";
}

}  // namespace alidade
