#include "alidade/tracking/frame_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "alidade/base/part_times.h"
#include "alidade/features/frame.h"
#include "alidade/features/pyramid.h"

namespace alidade {
namespace {

constexpr int kLevels = 4;             // of the halved images, at most
constexpr size_t kCoarsePoints = 100;  // whose patches find the pose; more change little
constexpr int kCoarseSteps = 8;        // on each level
// Gray levels: noise of a pixel and what a patch changes between two views.
constexpr float kNoise = 5;
constexpr float kLinear = 2;         // pixels: gradients predict brightness no farther
constexpr double kSmallStep = 0.05;  // pixels of the level: the pose is found
constexpr float kReach = 6;          // pixels of the level: largest error of the pose found before
// Pixels of the level: standard deviation of the error that the level before left.
constexpr float kLeft = 1;
constexpr float kMinCorrelation = 0.8f;

double ScaleOf(size_t level) { return 1 << level; }

// The halved image in which a keypoint is about as sharp as on its own level of the pyramid.
size_t HalvedLevel(int level, size_t count) {
  constexpr double kEach = 0.263034;  // log2(1.2)
  return std::min(static_cast<size_t>(level * kEach + 0.25), count - 1);
}

Eigen::Vector2f OnLevel(const Eigen::Vector2f& raw, size_t level) {
  const double scale = ScaleOf(level);
  return Eigen::Vector2d(FromLevelZero(raw.x(), scale), FromLevelZero(raw.y(), scale))
      .cast<float>();
}

Eigen::Vector2f FromLevel(const Eigen::Vector2f& place, size_t level) {
  const double scale = ScaleOf(level);
  return Eigen::Vector2d(ToLevelZero(place.x(), scale), ToLevelZero(place.y(), scale))
      .cast<float>();
}

// Raw pixel of a point in front of the camera.
Eigen::Vector2f RawPixel(const Camera& camera, const Eigen::Vector3d& p) {
  const Eigen::Vector2d pixel = camera.Project(p);
  return (camera.HasDistortion() ? camera.Distort(pixel) : pixel).cast<float>();
}

// Derivative of the pixel by the point in the camera's frame.
Eigen::Matrix<double, 2, 3> PixelByPoint(const Camera& camera, const Eigen::Vector3d& p) {
  const double inv_z = 1 / p.z();
  Eigen::Matrix<double, 2, 3> J;
  J << camera.fx * inv_z, 0, -camera.fx * p.x() * inv_z * inv_z, 0, camera.fy * inv_z,
      -camera.fy * p.y() * inv_z * inv_z;
  return J;
}

// Derivative of the pixel by a left increment of the pose (translation; rotation).
Eigen::Matrix<double, 2, 6> PixelByPose(const Camera& camera, const Eigen::Vector3d& p) {
  const Eigen::Matrix<double, 2, 3> by_point = PixelByPoint(camera, p);
  Eigen::Matrix<double, 2, 6> J;
  J.leftCols<3>() = by_point;
  J.rightCols<3>() = -by_point * Skew(p);
  return J;
}

constexpr double kInFront = 0.01;  // map units: in front of the camera

// Share of a patch's information that remains where its place is known to kLeft pixels, 0 to 1.
// Texture of wave number k looks alike after 2 π / k pixels. Averaged over places that are normally
// distributed with standard deviation s, its contrast is exp(-k² s² / 2) of what it is, and the
// information the square of that. k² is the mean squared difference of neighbors over the variance.
float Distinctness(const Patch& patch) {
  constexpr int kSide = Patch::kSide;
  float differences = 0, squares = 0;
  for (int i = 0; i < Patch::kPixels; ++i) {
    const float v = patch.value[i];
    squares += v * v;
    if (i % kSide > 0) differences += (v - patch.value[i - 1]) * (v - patch.value[i - 1]);
    if (i >= kSide) differences += (v - patch.value[i - kSide]) * (v - patch.value[i - kSide]);
  }
  const float share = static_cast<float>(kSide) / (kSide - 1);  // pixels per difference
  return std::exp(-share * differences / std::max(squares, 1e-6f) * kLeft * kLeft);
}

}  // namespace

void FrameAlignment::SetReference(const cv::Mat& reference, size_t keypoints) {
  const PartTimer timer(FramePart::kAlign);
  reference_ = HalvedImages(reference, kLevels);
  patches_.clear();
  patch_of_.assign(reference_.size(), std::vector<int>(keypoints, kUnknown));
}

std::vector<AlignedPoint> FrameAlignment::Align(const Camera& camera, const cv::Mat& image,
                                                std::span<const ReferencePoint> points,
                                                const Se3& T_reference_world, Se3& T_camera_world,
                                                double seconds) {
  const PartTimer timer(FramePart::kAlign);
  image_ = HalvedImages(image, kLevels);
  // Evenly over the list, which is sorted by level and place.
  std::vector<ReferencePoint> some;
  const size_t step = std::max<size_t>(1, points.size() / kCoarsePoints);
  for (size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  const Se3 guess = T_camera_world;
  for (size_t level = CoarsestFor(seconds); level > 0; --level)
    AlignOn(level, camera, some, T_camera_world);
  RememberError(camera, some, guess, T_camera_world, seconds);

  std::vector<AlignedPoint> aligned;
  aligned.reserve(points.size());
  const Se3 T_camera_reference = T_camera_world * T_reference_world.Inverse();
  for (const ReferencePoint& point : points)
    aligned.push_back(Find(camera, point, T_camera_reference, T_camera_world));
  return aligned;
}

// The level on which gradients predict brightness as far as the guess may be off. On coarser ones
// stripes and checks, which repeat after a few pixels, look alike a period away. An extrapolated
// motion is off by the acceleration times t² / 2, and the next one accelerates like the last ones.
size_t FrameAlignment::CoarsestFor(double seconds) const {
  const size_t coarsest = reference_.size() - 1;
  if (errors2_.size() < kRemembered || !std::isfinite(seconds)) return coarsest;
  double sum = 0;
  for (double error2 : errors2_) sum += error2;
  constexpr double kSigmas = 3;
  const double reach = kSigmas * std::sqrt(sum / kRemembered) * seconds * seconds;
  size_t level = 1;
  while (level < coarsest && reach > kLinear * ScaleOf(level)) ++level;
  return std::min(level, coarsest);
}

void FrameAlignment::RememberError(const Camera& camera, std::span<const ReferencePoint> points,
                                   const Se3& guess, const Se3& found, double seconds) {
  if (!std::isfinite(seconds) || !(seconds > 0)) return;
  double sum = 0;
  int count = 0;
  for (const ReferencePoint& point : points) {
    const Eigen::Vector3d p = guess * point.p_world, q = found * point.p_world;
    if (!(p.z() > kInFront) || !(q.z() > kInFront)) continue;
    sum += (camera.Project(p) - camera.Project(q)).squaredNorm();
    ++count;
  }
  if (count == 0) return;
  errors2_.push_back(sum / count / std::pow(seconds, 4));
  if (errors2_.size() > kRemembered) errors2_.pop_front();
}

const FrameAlignment::ReferencePatch* FrameAlignment::PatchOn(size_t level,
                                                              const ReferencePoint& point) {
  int& index = patch_of_[level][static_cast<size_t>(point.keypoint)];
  if (index == kUnknown) {
    Patch patch;
    const bool usable =
        CutPatch(reference_[level], OnLevel(point.raw, level), Eigen::Matrix2f::Identity(), patch);
    index = usable ? static_cast<int>(patches_.size()) : kUnusable;
    if (usable) patches_.push_back({patch, Distinctness(patch)});
  }
  return index == kUnusable ? nullptr : &patches_[static_cast<size_t>(index)];
}

// Gauss-Newton steps: each patch measures how far its landmark is from where the pose predicts it,
// with the information its gradients give.
void FrameAlignment::AlignOn(size_t level, const Camera& camera,
                             std::span<const ReferencePoint> points, Se3& T_camera_world) {
  const double scale = ScaleOf(level);
  for (int i = 0; i < kCoarseSteps; ++i) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    double weights = 0;
    for (const ReferencePoint& point : points) {
      const ReferencePatch* reference = PatchOn(level, point);
      const Eigen::Vector3d p = T_camera_world * point.p_world;
      if (!reference || !(p.z() > kInFront)) continue;
      const Patch& patch = reference->patch;
      const PatchStep step = StepOf(patch, image_[level], OnLevel(RawPixel(camera, p), level));
      if (!step.inside || !(step.gain > 0)) continue;
      const float length = step.shift.norm();
      const float trust = length > kLinear ? kLinear / length : 1;
      const double weight = reference->distinct * trust / (kNoise * kNoise + step.residual2);
      const Eigen::Matrix2d information = weight * patch.information.cast<double>();
      const Eigen::Matrix<double, 2, 6> J = PixelByPose(camera, p) / scale;
      const Eigen::Matrix<double, 6, 2> JtI = J.transpose() * information;
      H += JtI * J;
      g += JtI * step.shift.cast<double>();
      weights += information.trace() / 2;
    }
    const Eigen::LDLT<Matrix6d> solver(H);
    if (solver.info() != Eigen::Success || !solver.isPositive()) return;
    const Vector6d increment = solver.solve(g);
    if (!increment.allFinite()) return;
    T_camera_world = Se3::Exp(increment) * T_camera_world;
    // Mean squared motion of the points.
    if (increment.dot(g) < kSmallStep * kSmallStep * weights) return;
  }
}

AlignedPoint FrameAlignment::Find(const Camera& camera, const ReferencePoint& point,
                                  const Se3& T_camera_reference, const Se3& T_camera_world) const {
  AlignedPoint aligned;
  const Eigen::Vector3d q = T_camera_world * point.p_world;
  const double z = T_camera_reference.R.col(2).dot(q - T_camera_reference.t);  // in the reference
  if (!(z > kInFront) || !(q.z() > kInFront)) return aligned;
  // Of a surface parallel to the reference image.
  Eigen::Matrix2d turned = PixelByPoint(camera, q) * T_camera_reference.R.leftCols<2>() * z;
  turned.col(0) /= camera.fx;
  turned.col(1) /= camera.fy;
  if (!(turned.determinant() > 0)) return aligned;

  const size_t level = HalvedLevel(point.level, reference_.size());
  const cv::Mat& image = image_[level];
  Eigen::Vector2f place = OnLevel(RawPixel(camera, q), level);
  aligned.expected = HoldsPatch(image, place);
  if (!aligned.expected) return aligned;
  Patch patch;
  if (!CutPatch(reference_[level], OnLevel(point.raw, level), turned.inverse().cast<float>(),
                patch)) {
    aligned.expected = false;
    return aligned;
  }
  aligned.found = AlignPatch(patch, image, kReach, kMinCorrelation, place);
  aligned.raw = FromLevel(place, level);
  aligned.turn = static_cast<float>(std::atan2(turned(1, 0), turned(0, 0)));
  return aligned;
}

}  // namespace alidade
