// Pose of an image relative to an earlier one by aligning the images around landmarks, and their
// positions in it to a fraction of a pixel: sparse image alignment, then one patch at a time
// (Forster, Pizzoli & Scaramuzza 2014; Forster et al. 2017).
#pragma once

#include <Eigen/Core>
#include <deque>
#include <limits>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/features/patch.h"
#include "alidade/geometry/camera.h"

namespace alidade {

// A landmark that a keypoint of the reference image shows.
struct ReferencePoint {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  Eigen::Vector2f raw = Eigen::Vector2f::Zero();  // keypoint in the reference image, raw pixels
  int level = 0;                                  // of the keypoint
  int keypoint = -1;                              // index in the reference frame
};

// Such a landmark in the present image.
struct AlignedPoint {
  bool expected = false;  // it should be in the image, with its whole patch
  bool found = false;
  Eigen::Vector2f raw = Eigen::Vector2f::Zero();  // raw pixels, if found
  float turn = 0;  // angle in the image, present minus reference, radians
};

// One thread at a time.
class FrameAlignment {
 public:
  // Keypoints of `reference` (8-bit gray, of the camera's size; not copied) are looked for from now
  // on. `keypoints`: their number.
  void SetReference(const cv::Mat& reference, size_t keypoints);
  void Clear() { reference_.clear(); }
  bool has_reference() const { return !reference_.empty(); }

  // Aligns `image` (8-bit gray, of the same size). `T_reference_world`: pose of the reference;
  // `T_camera_world`: a guess of the pose of `image`, which is replaced. `seconds`: how far ahead
  // the motion was extrapolated for the guess; infinity: it was not. Returns one result for each of
  // the points, which have distinct keypoints.
  std::vector<AlignedPoint> Align(const Camera& camera, const cv::Mat& image,
                                  std::span<const ReferencePoint> points,
                                  const Se3& T_reference_world, Se3& T_camera_world,
                                  double seconds = std::numeric_limits<double>::infinity());

 private:
  static constexpr int kUnknown = -1, kUnusable = -2;
  static constexpr size_t kRemembered = 8;  // images
  size_t CoarsestFor(double seconds) const;
  void RememberError(const Camera& camera, std::span<const ReferencePoint> points, const Se3& guess,
                     const Se3& found, double seconds);
  struct ReferencePatch {
    Patch patch;         // neither turned nor scaled
    float distinct = 1;  // share of its information that counts, 0 to 1
  };
  const ReferencePatch* PatchOn(size_t level, const ReferencePoint& point);
  void AlignOn(size_t level, const Camera& camera, std::span<const ReferencePoint> points,
               Se3& T_camera_world);
  AlignedPoint Find(const Camera& camera, const ReferencePoint& point,
                    const Se3& T_camera_reference, const Se3& T_camera_world) const;

  std::vector<cv::Mat> reference_, image_;  // halved images, the largest first
  std::vector<ReferencePatch> patches_;
  std::vector<std::vector<int>> patch_of_;  // index by level, keypoint; or kUnknown, kUnusable
  // Of the last guesses: mean squared error of the points, (pixels / s²)².
  std::deque<double> errors2_;
};

}  // namespace alidade
