// Approximates lens models of other tools by those of RawCamera: linear least squares over the
// directions that the image shows.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "alidade/geometry/raw_camera.h"

namespace alidade {

// Pixels, the largest accepted error of an approximation anywhere in the image; about half the
// uncertainty of a keypoint.
inline constexpr double kMostMisfit = 0.5;

// Position in the image of a direction: ((u - cx) / fx, (v - cy) / fy). nullopt: not visible.
using LensProjection = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector3d&)>;

struct LensSample {
  Eigen::Vector3d direction;  // unit length, camera frame
  Eigen::Vector2d position;   // as returned by LensProjection
};

// Samples on rays from the principal point to the border of the image. `whole` is false when the
// projection ends or folds back within the image.
struct LensSamples {
  std::vector<LensSample> samples;
  bool whole = true;
  bool Enough() const;  // for a fit
};
LensSamples SampleLens(const RawCamera& camera, const LensProjection& project);

struct LensFit {
  RawCamera camera;  // with the approximation; a fisheye has other focal lengths as well
  double error = 0;  // largest error of a sample, pixels
};
// `coefficients`: 5, or 4 to leave k3 out.
LensFit FitBrown(const RawCamera& camera, const std::vector<LensSample>& samples,
                 int coefficients = 5);
LensFit FitFisheye(const RawCamera& camera, const std::vector<LensSample>& samples);

// Sets `camera` to the better approximation of the lens called `model`. Returns a sentence with the
// model and the error. Throws Error (input) with a text of the form "has a …" when the lens folds
// inside the image or the error exceeds kMostMisfit.
std::string ApproximateLens(const std::string& model, const LensSamples& samples,
                            RawCamera& camera);

// Sets the lens from OpenCV's coefficients k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [τx τy]]]]; their
// number says which they are. Returns a sentence if they had to be approximated, otherwise nothing.
// Throws Error (input) with a text of the form "has …".
std::string SetOpenCvLens(std::span<const double> coefficients, RawCamera& camera);

}  // namespace alidade
