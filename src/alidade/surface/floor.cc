#include "alidade/surface/floor.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "alidade/base/random.h"
#include "alidade/surface/voxel_blocks.h"

namespace alidade {
namespace {

constexpr int kPixelsAcross = 64;  // of a view, that are read
// Cubes in the median depth: at 3 m they are 10 cm wide.
constexpr double kCubesInDepth = 30;

struct SeenPoint {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  // mean of the readings in a cube
  double sigma = 0;                             // mean along the ray
  int count = 0;
};

struct SeenSurface {
  std::vector<SeenPoint> points;
  std::vector<Eigen::Vector3d> cameras;
  double cube = 0;
};

struct Reading {
  Eigen::Vector3d p;
  double z, sigma;
};

std::vector<Reading> ReadingsOf(const std::vector<DenseView>& views) {
  std::vector<Reading> readings;
  for (const DenseView& view : views) {
    const int step = std::max(1, view.depth.cols / kPixelsAcross);
    for (int y = step / 2; y < view.depth.rows; y += step) {
      for (int x = step / 2; x < view.depth.cols; x += step) {
        const double z = view.depth(y, x);
        if (!(z > 0)) continue;
        readings.push_back({view.T_world_camera * view.camera.Unproject({x, y}, z), z,
                            z * z * view.InverseSigmaAt(x, y)});
      }
    }
  }
  return readings;
}

SeenSurface SurfaceOf(const std::vector<DenseView>& views) {
  SeenSurface surface;
  for (const DenseView& view : views) surface.cameras.push_back(view.T_world_camera.t);
  const std::vector<Reading> readings = ReadingsOf(views);
  if (readings.empty()) return surface;
  std::vector<double> depths;
  for (const Reading& reading : readings) depths.push_back(reading.z);
  std::nth_element(depths.begin(), depths.begin() + static_cast<ptrdiff_t>(depths.size() / 2),
                   depths.end());
  surface.cube = depths[depths.size() / 2] / kCubesInDepth;
  std::unordered_map<uint64_t, size_t> cubes;
  for (const Reading& reading : readings) {
    if (reading.sigma > surface.cube) continue;
    const Eigen::Vector3i at = (reading.p / surface.cube).array().floor().cast<int>();
    if (!HasKey(at)) continue;
    const auto [cube, added] = cubes.emplace(KeyOf(at), surface.points.size());
    if (added) surface.points.emplace_back();
    SeenPoint& point = surface.points[cube->second];
    point.p += reading.p;
    point.sigma += reading.sigma;
    ++point.count;
  }
  for (SeenPoint& point : surface.points) {
    point.p /= point.count;
    point.sigma /= point.count;
  }
  return surface;
}

// Half-width of the band around a plane in which a point lies on it: two standard deviations of its
// depth, and of the poses, about a tenth of a cube.
double BandOf(const SeenPoint& point, double cube) { return 2 * (point.sigma + 0.1 * cube); }

struct Support {
  int on = 0, below = 0, cameras_above = 0;
};

Support SupportOf(const SeenSurface& surface, const Eigen::Vector3d& up, double height) {
  Support support;
  for (const SeenPoint& point : surface.points) {
    const double above = up.dot(point.p) - height, band = BandOf(point, surface.cube);
    support.on += std::abs(above) <= band ? 1 : 0;
    support.below += above < -2 * band ? 1 : 0;
  }
  for (const Eigen::Vector3d& camera : surface.cameras)
    support.cameras_above += up.dot(camera) > height ? 1 : 0;
  return support;
}

bool IsFloor(const Support& support, const SeenSurface& surface, const FloorSettings& settings) {
  return support.below <= settings.below_share * static_cast<double>(surface.points.size()) &&
         2 * support.cameras_above > static_cast<int>(surface.cameras.size());
}

// Least squares on the points near the plane, weighted by their inverse variances: far readings are
// the least precise, and the feet of walls and furniture are among them.
Floor Refine(const SeenSurface& surface, Floor floor) {
  for (int round = 0; round < 5; ++round) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double weights = 0;
    std::vector<const SeenPoint*> near;
    const auto weight_of = [&](const SeenPoint& point) {
      const double band = BandOf(point, surface.cube);
      return 1 / (band * band);
    };
    for (const SeenPoint& point : surface.points) {
      if (std::abs(floor.up.dot(point.p) - floor.height) > BandOf(point, surface.cube)) continue;
      near.push_back(&point);
      mean += weight_of(point) * point.p;
      weights += weight_of(point);
    }
    if (near.size() < 3) return floor;
    mean /= weights;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const SeenPoint* point : near)
      spread += weight_of(*point) * (point->p - mean) * (point->p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    const Eigen::Vector3d normal = solver.eigenvectors().col(0);
    floor.up = normal.dot(floor.up) < 0 ? Eigen::Vector3d(-normal) : normal;
    floor.height = floor.up.dot(mean);
    floor.sigma = std::sqrt(std::max(0.0, solver.eigenvalues()[0]) / weights);
    floor.share = static_cast<double>(near.size()) / static_cast<double>(surface.points.size());
  }
  return floor;
}

}  // namespace

Se3 Floor::FrameFor(const Eigen::Vector3d& origin, const Eigen::Vector3d& forward) const {
  Eigen::Vector3d x = forward - up * up.dot(forward);
  if (x.norm() < 1e-3 * forward.norm() || x.norm() == 0) x = up.unitOrthogonal();
  x.normalize();
  Se3 T_floor_world;
  T_floor_world.R << x.transpose(), up.cross(x).transpose(), up.transpose();
  const Eigen::Vector3d below = origin - up * (up.dot(origin) - height);
  T_floor_world.t = -(T_floor_world.R * below);
  return T_floor_world;
}

std::optional<Floor> FindFloor(const std::vector<DenseView>& views, const Eigen::Vector3d& up,
                               const FloorSettings& settings) {
  const SeenSurface surface = SurfaceOf(views);
  const size_t count = surface.points.size();
  if (count < 3) return std::nullopt;
  Random random(1, 71);
  Floor best;
  int most = 0;
  const double least_cosine = std::cos(settings.most_tilt);
  for (int i = 0; i < settings.samples; ++i) {
    const std::vector<int> three = random.Sample(3, static_cast<int>(count));
    const auto at = [&](size_t k) -> const Eigen::Vector3d& {
      return surface.points[static_cast<size_t>(three[k])].p;
    };
    Eigen::Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0));
    if (!(normal.norm() > 1e-3 * surface.cube * surface.cube)) continue;
    normal.normalize();
    if (normal.dot(up) < 0) normal = -normal;
    if (normal.dot(up) < least_cosine) continue;
    const double height = normal.dot(at(0));
    const Support support = SupportOf(surface, normal, height);
    if (support.on <= most || !IsFloor(support, surface, settings)) continue;
    most = support.on;
    best.up = normal;
    best.height = height;
  }
  if (most < 3) return std::nullopt;
  return Refine(surface, best);
}

}  // namespace alidade
