#include "alidade/io/files/calibrations/lens_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "alidade/base/error.h"
#include "alidade/base/print.h"

namespace alidade {
namespace {

constexpr int kRays = 48;
constexpr int kSteps = 80;  // samples on a ray, from the principal point to the image's corner
constexpr double kWidest = 89.5 * std::numbers::pi / 180;  // of a perspective lens, radians

bool InImage(const RawCamera& camera, const Eigen::Vector2d& position) {
  const double u = position.x() * camera.fx + camera.cx, v = position.y() * camera.fy + camera.cy;
  return u >= -0.5 && v >= -0.5 && u <= camera.width - 0.5 && v <= camera.height - 0.5;
}

double LargestError(const RawCamera& fitted, const RawCamera& camera,
                    const std::vector<LensSample>& samples) {
  double largest = 0;
  for (const LensSample& sample : samples) {
    const Eigen::Vector2d pixel(sample.position.x() * camera.fx + camera.cx,
                                sample.position.y() * camera.fy + camera.cy);
    const double error = (fitted.Project(sample.direction) - pixel).norm();
    if (!(error <= largest)) largest = error;  // NaN as well
  }
  return largest;
}

// OpenCV's camera model with up to 14 coefficients (calib3d documentation, "detailed description").
Eigen::Vector2d ProjectOpenCv(const std::array<double, 14>& k, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial =
      (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  const Eigen::Vector2d bent(
      x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x) + r2 * (k[8] + r2 * k[9]),
      y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y + r2 * (k[10] + r2 * k[11]));
  if (k[12] == 0 && k[13] == 0) return bent;
  // Tilted sensor: R = R_y(τy) R_x(τx), then projection onto the plane z = R33.
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(-k[13], Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(-k[12], Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  Eigen::Matrix3d tilt;
  tilt << R(2, 2), 0, -R(0, 2), 0, R(2, 2), -R(1, 2), 0, 0, 1;
  return (tilt * R * bent.homogeneous()).hnormalized();
}

}  // namespace

bool LensSamples::Enough() const { return samples.size() >= 5 * kRays; }

LensSamples SampleLens(const RawCamera& camera, const LensProjection& project) {
  const double u = std::max(camera.cx + 0.5, camera.width - 0.5 - camera.cx) / camera.fx;
  const double v = std::max(camera.cy + 0.5, camera.height - 0.5 - camera.cy) / camera.fy;
  const double step = std::min(std::hypot(u, v), std::numbers::pi) / kSteps;  // radians
  LensSamples out;
  std::vector<double> turns;
  for (int ray = 0; ray < kRays; ++ray) turns.push_back(2 * std::numbers::pi * ray / kRays);
  // Errors are largest in the corners.
  for (const double x : {-0.5, camera.width - 0.5}) {
    for (const double y : {-0.5, camera.height - 0.5})
      turns.push_back(std::atan2((y - camera.cy) / camera.fy, (x - camera.cx) / camera.fx));
  }
  for (const double turn : turns) {
    const Eigen::Vector2d along(std::cos(turn), std::sin(turn));
    double last = 0;
    for (double angle = step; angle < std::numbers::pi; angle += step) {
      const Eigen::Vector3d direction(along.x() * std::sin(angle), along.y() * std::sin(angle),
                                      std::cos(angle));
      const std::optional<Eigen::Vector2d> position = project(direction);
      const double radius = position ? position->dot(along) : 0;
      if (!(radius > last)) {  // ends or folds back before it reached the border
        out.whole = false;
        break;
      }
      if (!InImage(camera, *position)) break;
      out.samples.push_back({direction, *position});
      last = radius;
    }
  }
  return out;
}

LensFit FitBrown(const RawCamera& camera, const std::vector<LensSample>& samples,
                 int coefficients) {
  Eigen::MatrixXd A(2 * static_cast<Eigen::Index>(samples.size()), 5);
  Eigen::VectorXd b(A.rows());
  Eigen::Index row = 0;
  for (const LensSample& sample : samples) {
    const Eigen::Vector2d p = sample.direction.hnormalized();
    const double x = p.x(), y = p.y(), r2 = p.squaredNorm();
    A.row(row) << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x, x * r2 * r2 * r2;
    A.row(row + 1) << y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y, y * r2 * r2 * r2;
    b.segment<2>(row) = sample.position - p;
    row += 2;
  }
  const Eigen::VectorXd k = A.leftCols(coefficients).colPivHouseholderQr().solve(b);
  LensFit fit{camera};
  fit.camera.lens = Lens::kPinhole;
  fit.camera.distortion = {};
  std::copy_n(k.data(), k.size(), fit.camera.distortion.begin());
  fit.error = LargestError(fit.camera, camera, samples);
  return fit;
}

// r(θ) = s θ (1 + k1 θ² + …) is linear in s, s k1, …; s scales the focal lengths.
LensFit FitFisheye(const RawCamera& camera, const std::vector<LensSample>& samples) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(samples.size()), 5);
  Eigen::VectorXd b(A.rows());
  for (Eigen::Index row = 0; row < A.rows(); ++row) {
    const LensSample& sample = samples[static_cast<size_t>(row)];
    const Eigen::Vector2d along = sample.direction.head<2>();
    const double angle = std::atan2(along.norm(), sample.direction.z()), a2 = angle * angle;
    A.row(row) << angle, angle * a2, angle * a2 * a2, angle * a2 * a2 * a2,
        angle * a2 * a2 * a2 * a2;
    b[row] = sample.position.dot(along.normalized());
  }
  const Eigen::Matrix<double, 5, 1> k = A.colPivHouseholderQr().solve(b);
  LensFit fit{camera};
  fit.camera.lens = Lens::kFisheye;
  fit.camera.fx *= k[0];
  fit.camera.fy *= k[0];
  for (int i = 0; i < 4; ++i) fit.camera.distortion[static_cast<size_t>(i)] = k[i + 1] / k[0];
  fit.camera.distortion[4] = 0;
  fit.error = LargestError(fit.camera, camera, samples);
  return fit;
}

std::string ApproximateLens(const std::string& model, const LensSamples& samples,
                            RawCamera& camera) {
  if (!samples.Enough())
    ThrowInput("has a " + model + " lens whose coefficients map most directions outside the image");
  const bool forward =
      std::all_of(samples.samples.begin(), samples.samples.end(), [](const LensSample& sample) {
        return std::acos(std::clamp(sample.direction.z(), -1.0, 1.0)) < kWidest;
      });
  LensFit best = FitFisheye(camera, samples.samples);
  if (forward && samples.whole) {
    // A pinhole's images stay as they are, those of a fisheye are resampled.
    LensFit brown = FitBrown(camera, samples.samples);
    if (brown.error <= kMostMisfit || !(best.error <= kMostMisfit)) best = brown;
  }
  char error[40];
  PrintTo(error, sizeof error, "%.2g pixels", best.error);
  if (!(best.error <= kMostMisfit)) {
    ThrowInput("has a " + model + " lens that Alidade's models approximate only to " + error +
               ": undistort the images first, or calibrate again as " +
               (best.camera.lens == Lens::kPinhole
                    ? "pinhole with the five coefficients k1 k2 p1 p2 k3"
                    : "fisheye (equidistant, Kannala-Brandt)"));
  }
  camera = best.camera;
  return "The " + model + " lens is approximated by " +
         (camera.lens == Lens::kPinhole ? "k1 k2 p1 p2 k3" : "an equidistant fisheye") +
         "; largest error in the image: " + error;
}

std::string SetOpenCvLens(std::span<const double> coefficients, RawCamera& camera) {
  const auto zero_from = [&](size_t first) {
    return std::all_of(
        coefficients.begin() + static_cast<std::ptrdiff_t>(std::min(first, coefficients.size())),
        coefficients.end(), [](double k) { return k == 0; });
  };
  camera.lens = Lens::kPinhole;
  camera.distortion = {};
  if (zero_from(5)) {
    std::copy_n(coefficients.begin(), std::min<size_t>(5, coefficients.size()),
                camera.distortion.begin());
    return {};
  }
  while (coefficients.size() > 8 && coefficients.back() == 0)  // padding
    coefficients = coefficients.first(coefficients.size() - 1);
  if (coefficients.size() < 8 || coefficients.size() > 14)
    ThrowInput("has " + std::to_string(coefficients.size()) +
               " distortion coefficients; OpenCV's models have 4, 5, 8, 12 or 14");
  std::array<double, 14> k{};
  std::copy(coefficients.begin(), coefficients.end(), k.begin());
  const LensSamples samples =
      SampleLens(camera, [&](const Eigen::Vector3d& p) -> std::optional<Eigen::Vector2d> {
        if (!(p.z() > std::cos(kWidest))) return std::nullopt;
        return ProjectOpenCv(k, p.x() / p.z(), p.y() / p.z());
      });
  if (!samples.whole)
    ThrowInput(
        "has a rational distortion that is not invertible within the image: calibrate again with "
        "the target at the image's borders as well, or with five coefficients");
  return ApproximateLens(zero_from(8) ? "rational" : "thin prism or tilted", samples, camera);
}

}  // namespace alidade
