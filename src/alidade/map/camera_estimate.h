// What a map says of the camera that it was made with: focal length and radial distortion.
#pragma once

#include <vector>

#include "alidade/base/api.h"
#include "alidade/map/map_store.h"
#include "alidade/map/measurement.h"
#include "alidade/optimize/lens_adjustment.h"

namespace ALIDADE_API alidade {

struct CameraEstimateSettings {
  int window = 12;        // keyframes in a row that are adjusted together
  int max_windows = 40;   // at most, spread over the map
  int min_keyframes = 6;  // of a window; with fewer nothing is said
  int min_seen = 3;       // keyframes of a window that must see a landmark for it to count
  // What is believed of distortion beforehand: standard deviations of the shift at the picture's
  // corners by k1, and by k2, as a share of their distance from the middle.
  double k1_corner_sigma = 0.08;
  double k2_corner_sigma = 0.02;
  // Known: 0.01 is the standard deviation of the focal length, relative, below which it is.
  double max_focal_sigma = 0.01;
  // And of where the optical axis meets the picture: standard deviation about its middle, as a
  // share of its longer side. Pictures are cut out of what a sensor sees.
  double centre_sigma = 0.01;
  // Rolling shutter, where the camera's readout is not known: what is believed of it beforehand,
  // seconds about none. 0: it is not looked for.
  double readout_sigma = 0;
  bool hold_lens = false;         // the lens is known: only the readout is looked for
  LensAdjustmentSettings adjust;  // but for what follows from the above
  void Check() const;             // throws Error (usage) naming the field that cannot be
};

struct CameraEstimate {
  Camera camera;           // of the images that the map was made from
  double focal_sigma = 0;  // standard deviation of log focal: relative, unitless
  double k1_sigma = 0, k2_sigma = 0;
  Eigen::Vector2d centre_sigma = Eigen::Vector2d::Zero();  // pixels
  // Of camera.readout, seconds; zero for a direction that was not looked for, or found to be none.
  Eigen::Vector2d readout_sigma = Eigen::Vector2d::Zero();
  int keyframes = 0, observations = 0;  // that had a say; 0: nothing is said
  double noise = 0;                     // of keypoints on the finest level, pixels
  bool known = false;                   // focal_sigma is small enough
};

// Views of one map, or several of one camera, for AdjustLens(). Pixels are as in the image (with
// hold_lens: undistorted), for square pixels: rows are stretched about the centre by fx / fy.
std::vector<LensWindow> LensWindowsOf(const MapSnapshot& map, MapId id, const Camera& camera,
                                      const MeasurementNoise& noise,
                                      const CameraEstimateSettings& settings);

// `camera`: what the windows' maps were made with; where the search starts. Readout is looked for
// along Camera::ReadAlong(), and is none where it is not more than 3 sigma.
CameraEstimate EstimateCamera(std::vector<LensWindow> windows, const Camera& camera,
                              const MeasurementNoise& noise,
                              const CameraEstimateSettings& settings = {});

// How far two cameras differ, as a share of a pixel's distance from the middle: the larger of that
// near the middle and that at the corners.
double Apart(const Camera& a, const Camera& b);
// The camera that lies so far (0…1) from `a` to `b`: log focal length, distortion, centre and
// readout of each.
Camera Between(const Camera& a, const Camera& b, double share);

}  // namespace alidade
