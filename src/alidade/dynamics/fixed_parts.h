// Parts of the image that are fixed to the camera: a hood, a gripper, a hand, a caption, dead
// pixels. They never move in the image while everything else does. A pose estimated from them
// stands still, and with depth they pull all poses towards themselves.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "alidade/features/frame.h"
#include "alidade/geometry/camera.h"

namespace alidade {

struct FixedPartsSettings {
  double interval = 0.15;    // seconds between two comparisons, at least
  double longest = 2;        // seconds between them, at most, where little moves
  double corner = 4.5;       // smaller eigenvalue of the mean gradient square, (gray / px)²
  double same = 0.3;         // of that eigenvalue: largest squared change of a gradient that stayed
  double found = 0.9;        // P(stays | fixed): noise, compression and lighting change the rest
  double prior = 0.01;       // P(fixed)
  double unproven = 0.09;    // P(fixed) up to which the motion of the camera need not be known
  double certain = 0.88;     // P(fixed) from which a pixel is left out
  double most_stay = 0.55;   // share of the image that may stay while "everything else" moves
  double most_still = 0.25;  // StillShare() from which the camera may be the one that stands
  // GlanceSettings::min_area for it: what stays in place lies about in as much of the image as
  // everything. A band over half of the image has 0.7 (root of the share of the height).
  double still_area = 0.7;
  double least = 0.02;  // share of the image; smaller parts do no harm
};

// Per pixel p of a thumbnail, the log-odds that it is fixed. Each time most of the image has moved
// since the last comparison, a corner at p that stayed adds log(found / s), one that changed adds
// log((1 - found) / (1 - s)), where s = P(stays | scene) is the larger of the share of the image
// that stayed and ChanceToStay(). Evidence without the latter, which takes longer, lifts P(fixed)
// to `unproven` only. Used by one thread.
class FixedParts {
 public:
  explicit FixedParts(const Camera& camera, const FixedPartsSettings& settings = {});

  // Call for each frame, in order of time. `image`: 8-bit gray, of the camera's size; `frame`: its
  // features. Returns true if a part has been found that mask() did not have before.
  bool See(const cv::Mat& image, const std::shared_ptr<const Frame>& frame);
  // 255: fixed to the camera; CV_8U of the thumbnail's size, to be stretched over the image. Empty:
  // nothing is.
  const cv::Mat& mask() const { return mask_; }
  double share() const { return share_; }  // of the image that mask() leaves out
  void SetCamera(const Camera& camera);
  void Cut();  // the next frame need not continue the last one

 private:
  struct Corners {
    cv::Mat is, stayed;  // CV_8U, 0 or 1
  };
  Corners Compare(const cv::Mat& thumbnail) const;
  // Share of the cells with corners, of those not believed to be fixed, that stayed; negative if
  // there are too few.
  double ShareThatStayed(const Corners& corners) const;
  // False: nothing can be learned, since the motion of the camera is needed and not known.
  bool Weigh(const Corners& corners, double stayed, const Frame& frame);
  bool Decide();
  void Renew(const cv::Mat& thumbnail, const std::shared_ptr<const Frame>& frame);

  Camera camera_;
  FixedPartsSettings settings_;
  cv::Mat log_odds_;  // CV_32F
  cv::Mat then_;      // thumbnail of the last comparison
  std::shared_ptr<const Frame> frame_then_;
  double time_ = 0;        // of the last comparison, seconds
  double looked_ = 0;      // when a comparison was last tried, seconds
  double candidates_ = 0;  // share of the image that was certain at the last comparison
  double told_ = 0;        // the largest share that See() has reported
  cv::Mat mask_;
  double share_ = 0;
};

}  // namespace alidade
