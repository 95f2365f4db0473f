// Resamples recorded images to those of a pinhole camera without distortion, as trainers of
// radiance fields expect them.
#pragma once

#include <opencv2/core.hpp>

#include "alidade/geometry/camera.h"

namespace alidade {

struct PinholeSettings {
  // Puts the principal point into the center of the image by cropping, for trainers that ignore it.
  bool centered = false;
  // Left free on each side for the rolling-shutter correction, pixels of the map's camera.
  Eigen::Vector2d margin = Eigen::Vector2d::Zero();
};

// Camera motion while an image was read (Frame::motion), and the inverse depth of the scene for
// which its translation is corrected; its rotation is corrected at any depth.
struct ReadoutMotion {
  Vector6d motion = Vector6d::Zero();
  double inverse_depth = 0;  // 1 / map units
};

class PinholeImages {
 public:
  // `map_camera`: of the map's keypoints, whose images may be scaled down; `recorded`: size of the
  // images of the recording. The pinhole camera keeps the resolution in the middle of the recorded
  // image. It is the largest rectangle without black borders, of at most twice the recorded width:
  // with a pixel at (0, 0) as center of the top-left one, the centers of all its pixels lie between
  // those of the outer recorded pixels.
  PinholeImages(const Camera& map_camera, cv::Size recorded, const PinholeSettings& settings = {});

  const Camera& camera() const { return pinhole_; }
  // `image`: of the recorded size. Bicubic; returns `image` itself if there is nothing to change.
  cv::Mat Apply(const cv::Mat& image, const ReadoutMotion& readout = {}) const;
  cv::Mat ApplyNearest(const cv::Mat& mask, const ReadoutMotion& readout = {}) const;
  // The same in two steps, for several images of one frame. Positions in the recorded image of each
  // pixel, CV_32FC2; empty: the pinhole image is the recorded one. `buffer`: an earlier result,
  // whose memory is used again.
  cv::Mat PositionsAt(const ReadoutMotion& readout, cv::Mat buffer = {}) const;
  static cv::Mat Nearest(const cv::Mat& image, const cv::Mat& positions);

  // Where a raw pixel of the map's camera is in the pinhole image.
  Eigen::Vector2d InPinhole(const Eigen::Vector2d& raw, const ReadoutMotion& readout = {}) const;
  bool Holds(const Eigen::Vector2d& pixel) const;  // inside the pinhole image

 private:
  Eigen::Vector2d InRecorded(const Eigen::Vector2d& raw) const;
  Eigen::Vector2d Source(const Eigen::Vector2d& pixel, const ReadoutMotion& readout) const;
  cv::Mat Positions(const ReadoutMotion& readout, cv::Mat positions = {}) const;
  bool Moves(const ReadoutMotion& readout) const;

  Camera map_, pinhole_;
  cv::Size recorded_;
  bool same_ = false;  // the pinhole image is the recorded one
  cv::Mat at_rest_;    // CV_32FC2: position in the recorded image of each pixel, without motion
};

}  // namespace alidade
