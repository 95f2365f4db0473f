#include "alidade/surface/tsdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/surface/surface_nets.h"

namespace alidade {
namespace {

constexpr int kBlockSide = VoxelBlock::kSide;
constexpr int kMostBlocks = 2'000'000;  // 12 GB
// Every so many pixels in both directions a ray makes blocks. At 4 m and a focal length of 500
// pixels rays are 3 cm apart, a fifth of the usual block.
constexpr int kRayStep = 4;
constexpr int kTile = 16;  // pixels, of the farthest depths of a view

// Blocks between two points, by steps of half a block.
void AddBlocksAlong(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double block,
                    std::vector<uint64_t>& keys) {
  const double length = (to - from).norm();
  const int steps = static_cast<int>(std::ceil(2 * length / block));
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector3d p = from + (to - from) * (static_cast<double>(i) / std::max(1, steps));
    const Eigen::Vector3i at = (p / block).array().floor().cast<int>();
    if (!HasKey(at)) continue;
    const uint64_t key = KeyOf(at);
    if (keys.empty() || keys.back() != key) keys.push_back(key);
  }
}

void Blend(const cv::Vec3b& bgr, float share, Voxel& voxel) {
  for (int c = 0; c < 3; ++c) {
    uint16_t& value = voxel.rgb[static_cast<size_t>(c)];
    const float now = value, seen = 256.0f * static_cast<float>(bgr[2 - c]);
    value = static_cast<uint16_t>(now + share * (seen - now) + 0.5f);
  }
}

// Up from one half, without a call of std::floor().
int16_t Rounded(float value) {
  const float up = value + 0.5f;
  const int whole = static_cast<int>(up);  // towards 0
  return static_cast<int16_t>(whole - (static_cast<float>(whole) > up ? 1 : 0));
}

// The tiles of the first and the last of some pixels of a row or column.
std::pair<int, int> TilesBetween(double from, double to, int pixels) {
  const double last = pixels - 1;
  return {static_cast<int>(std::clamp(from, 0.0, last)) / kTile,
          static_cast<int>(std::clamp(to, 0.0, last)) / kTile};
}

}  // namespace

// What the readings of a view tell something of: the pyramid of its image, up to behind what was
// seen.
struct Tsdf::Reach {
  static constexpr double kNearest = 0.05;  // meters; nearer blocks are not looked up by tiles
  Se3 T_camera_world;
  Camera camera;
  cv::Size size;
  std::array<Eigen::Vector3d, 4> sides;  // unit normals, into the pyramid
  cv::Mat1f farthest;                    // by tile: depth behind which nothing is told, meters
  double farthest_of_all = 0;

  bool Meets(const Eigen::Vector3d& p_camera, double radius) const {
    const double near = p_camera.z() - radius, far = p_camera.z() + radius;
    if (far < 0 || near > farthest_of_all) return false;
    for (const Eigen::Vector3d& side : sides) {
      if (side.dot(p_camera) < -radius) return false;
    }
    return near < kNearest || near <= FarthestAround(p_camera, radius);
  }

  // In the tiles onto which a sphere is projected, and some around: the slopes of its bounding box
  // are those of (x ± r) / (z ± r).
  double FarthestAround(const Eigen::Vector3d& p, double r) const {
    const auto least = [&](double a) { return (a - r) / (a > r ? p.z() + r : p.z() - r); };
    const auto most = [&](double a) { return (a + r) / (a > -r ? p.z() - r : p.z() + r); };
    const auto [left, right] = TilesBetween(camera.fx * least(p.x()) + camera.cx - 1,
                                            camera.fx * most(p.x()) + camera.cx + 1, size.width);
    const auto [top, bottom] = TilesBetween(camera.fy * least(p.y()) + camera.cy - 1,
                                            camera.fy * most(p.y()) + camera.cy + 1, size.height);
    float found = 0;
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) found = std::max(found, farthest(y, x));
    }
    return found;
  }
};

double TsdfSettings::RangeFor(double inverse_sigma) const {
  const double certain = RangeAt(inverse_sigma, most_sigma * voxel);
  return range > 0 ? std::min(range, certain) : certain;
}

void TsdfSettings::Check() const {
  if (!(voxel >= 1e-4 && voxel <= 10)) ThrowUsage("voxel: must be from 0.0001 to 10");
  if (!(most_sigma > 0)) ThrowUsage("most_sigma: must be positive");
  if (!(truncation >= 2)) ThrowUsage("truncation: must be at least 2 voxels");
  if (!(range >= 0)) ThrowUsage("range: must not be negative");
}

Tsdf::Tsdf(const TsdfSettings& settings) : settings_(settings) { settings.Check(); }

void Tsdf::AddBlocks(const DenseView& view) {
  const double band = settings_.TruncationDistance(), block = settings_.voxel * kBlockSide;
  const int rows = (view.depth.rows + kRayStep - 1) / kRayStep;
  std::vector<std::vector<uint64_t>> keys(static_cast<size_t>(rows));
  ParallelFor(rows, [&](int row) {
    std::vector<uint64_t>& own = keys[static_cast<size_t>(row)];
    for (int x = 0; x < view.depth.cols; x += kRayStep) {
      const int y = row * kRayStep;
      const double z = view.depth(y, x);
      if (!(z > 0 && z <= settings_.RangeFor(view.InverseSigmaAt(x, y)))) continue;
      const Eigen::Vector3d ray = view.camera.Unproject({x, y});
      const double near = std::max(0.0, z - band);
      AddBlocksAlong(view.T_world_camera * Eigen::Vector3d(ray * near),
                     view.T_world_camera * Eigen::Vector3d(ray * (z + band)), block, own);
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  });
  for (const auto& own : keys) {
    for (const uint64_t key : own) blocks_.Add(PlaceOf(key));
  }
  if (blocks_.count() > kMostBlocks)
    ThrowUsage("the surface has more than a billion voxels: choose larger ones");
}

Tsdf::Reach Tsdf::ReachOf(const DenseView& view) const {
  const Camera& c = view.camera;
  const double right = view.depth.cols - 0.5 - c.cx, bottom = view.depth.rows - 0.5 - c.cy;
  Reach reach;
  reach.T_camera_world = view.T_world_camera.Inverse();
  reach.sides = {Eigen::Vector3d(c.fx, 0, c.cx + 0.5).normalized(),
                 Eigen::Vector3d(-c.fx, 0, right).normalized(),
                 Eigen::Vector3d(0, c.fy, c.cy + 0.5).normalized(),
                 Eigen::Vector3d(0, -c.fy, bottom).normalized()};
  reach.camera = c;
  reach.size = view.depth.size();
  double range = settings_.range > 0 ? settings_.range : HUGE_VAL;
  if (view.inverse_sigmas.empty()) range = settings_.RangeFor(view.inverse_sigma);
  reach.farthest = cv::Mat1f::zeros((view.depth.rows + kTile - 1) / kTile,
                                    (view.depth.cols + kTile - 1) / kTile);
  for (int y = 0; y < view.depth.rows; ++y) {
    const float* depth = view.depth[y];
    float* tiles = reach.farthest[y / kTile];
    for (int x = 0; x < view.depth.cols; ++x)
      tiles[x / kTile] = std::max(tiles[x / kTile], depth[x]);
  }
  const double band = settings_.TruncationDistance();
  for (float& far : reach.farthest) {
    if (far > 0)  // with a margin for rounding
      far = static_cast<float>(1.001 * std::min<double>(far, range) + band);
    reach.farthest_of_all = std::max<double>(reach.farthest_of_all, far);
  }
  return reach;
}

void Tsdf::Update(const DenseView& view, const Reach& reach, VoxelBlock& block) const {
  const Se3& T_camera_world = reach.T_camera_world;
  const Eigen::Vector3d middle =
      settings_.voxel * kBlockSide * (block.at.cast<double>() + Eigen::Vector3d::Constant(0.5));
  const double radius = 0.87 * settings_.voxel * kBlockSide;  // half of the diagonal: √3/2
  if (!reach.Meets(T_camera_world * middle, radius)) return;
  const float band = static_cast<float>(settings_.TruncationDistance()),
              voxel = static_cast<float>(settings_.voxel),
              most_sigma = static_cast<float>(settings_.most_sigma * settings_.voxel),
              range = settings_.range > 0 ? static_cast<float>(settings_.range) : INFINITY,
              fx = static_cast<float>(view.camera.fx), fy = static_cast<float>(view.camera.fy),
              cx = static_cast<float>(view.camera.cx), cy = static_cast<float>(view.camera.cy),
              columns = static_cast<float>(view.depth.cols),
              rows = static_cast<float>(view.depth.rows);
  const Eigen::Vector3f first =
      (T_camera_world * Eigen::Vector3d(settings_.voxel * (kBlockSide * block.at.cast<double>() +
                                                           Eigen::Vector3d::Constant(0.5))))
          .cast<float>();
  const Eigen::Matrix3f steps = (settings_.voxel * T_camera_world.R).cast<float>();
  const float voxel2 = voxel * voxel;
  size_t index = 0;
  for (int z = 0; z < kBlockSide; ++z) {
    for (int y = 0; y < kBlockSide; ++y) {
      Eigen::Vector3f p =
          first + static_cast<float>(y) * steps.col(1) + static_cast<float>(z) * steps.col(2);
      for (int x = 0; x < kBlockSide; ++x, ++index, p += steps.col(0)) {
        if (!(p.z() > 0.01f)) continue;
        const float right = fx * p.x() / p.z() + cx + 0.5f, down = fy * p.y() / p.z() + cy + 0.5f;
        if (!(right >= 0 && down >= 0 && right < columns && down < rows)) continue;
        const int u = static_cast<int>(right), v = static_cast<int>(down);
        const float depth = view.depth(v, u);
        if (!(depth > 0 && depth <= range)) continue;
        const float distance = depth - p.z();
        if (distance < -band) continue;
        const float sigma =
            std::max(depth * depth * static_cast<float>(view.InverseSigmaAt(u, v)), 0.05f * voxel);
        if (sigma > most_sigma) continue;
        const float weight = voxel2 / (sigma * sigma);
        Voxel& seen = block.voxels[index];
        const float share = weight / (seen.weight + weight), now = seen.distance,
                    measured = Voxel::kFull * std::min(1.0f, distance / band);
        seen.distance = Rounded(now + share * (measured - now));
        if (!view.color.empty() && distance < band) Blend(view.color(v, u), share, seen);
        seen.weight += weight;
      }
    }
  }
}

void Tsdf::Add(const DenseView& view) {
  AddBlocks(view);
  const Reach reach = ReachOf(view);
  // All blocks: those in front of what this view sees are found to be free.
  ParallelFor(blocks_.count(), [&](int i) { Update(view, reach, blocks_[i]); });
}

Mesh Tsdf::MakeMesh() const {
  return MakeSurfaceNets(blocks_,
                         {settings_.voxel, 1 / (settings_.most_sigma * settings_.most_sigma)});
}

}  // namespace alidade
