// Self-calibration: estimates focal length, radial distortion and readout time of a camera from a
// map.
#pragma once

#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/calibration/lens_adjustment.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in camera_estimate.cc.
struct CameraEstimateSettings {
  int window = 12;
  int max_windows = 40;
  int min_keyframes = 6;
  int min_seen = 3;
  double k1_corner_sigma = 0.08;
  double k2_corner_sigma = 0.02;
  double max_focal_sigma = 0.01;
  // Images are cut out of what a sensor sees.
  double centre_sigma = 0.01;
  // 0: the readout time is not estimated.
  double readout_sigma = 0;
  bool hold_lens = false;         // the lens is known: only the readout time is estimated
  LensAdjustmentSettings adjust;  // except what follows from the above
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

struct CameraEstimate {
  Camera camera;           // of the images from which the map was built
  double focal_sigma = 0;  // standard deviation of the log focal length: relative, unitless
  double k1_sigma = 0, k2_sigma = 0;
  Eigen::Vector2d centre_sigma = Eigen::Vector2d::Zero();  // pixels
  // Standard deviation of camera.readout, seconds; zero for a direction that was not estimated or
  // found insignificant.
  Eigen::Vector2d readout_sigma = Eigen::Vector2d::Zero();
  int keyframes = 0, observations = 0;  // number used; 0: no estimate
  double noise = 0;                     // of keypoints on level 0, pixels
  bool known = false;                   // focal_sigma is below max_focal_sigma
};

// Windows of one map for AdjustLens(); windows of several maps of one camera can be joined. Pixels
// are raw (with hold_lens: undistorted), scaled vertically about the center by fx / fy to square
// pixels.
std::vector<LensWindow> LensWindowsOf(const MapSnapshot& map, MapId id, const Camera& camera,
                                      const MeasurementNoise& noise,
                                      const CameraEstimateSettings& settings);

// `camera`: with which the windows' maps were built; start of the search. The readout time is
// estimated along Camera::ReadAlong() and set to zero if below 3 sigma.
CameraEstimate EstimateCamera(std::vector<LensWindow> windows, const Camera& camera,
                              const MeasurementNoise& noise,
                              const CameraEstimateSettings& settings = {});

// Difference between two cameras: displacement relative to a pixel's distance from the center, the
// larger of the values near the center and at the corners.
double Apart(const Camera& a, const Camera& b);
// Interpolates between `a` (share 0) and `b` (share 1): log focal length, distortion, principal
// point and readout time.
Camera Between(const Camera& a, const Camera& b, double share);

}  // namespace alidade
