#include "alidade/surface/tsdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

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

}  // namespace

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

// The pyramid in front of the camera that holds all that its readings tell something of.
struct Tsdf::Reach {
  Se3 T_camera_world;
  std::array<Eigen::Vector3d, 4> sides;  // unit normals, into the pyramid
  double farthest = 0;                   // depth, meters

  bool Meets(const Eigen::Vector3d& p_camera, double radius) const {
    if (p_camera.z() < -radius || p_camera.z() > farthest + radius) return false;
    return std::all_of(sides.begin(), sides.end(),
                       [&](const Eigen::Vector3d& side) { return side.dot(p_camera) >= -radius; });
  }
};

Tsdf::Reach Tsdf::ReachOf(const DenseView& view) const {
  const Camera& c = view.camera;
  const double right = view.depth.cols - 0.5 - c.cx, bottom = view.depth.rows - 0.5 - c.cy;
  Reach reach;
  reach.T_camera_world = view.T_world_camera.Inverse();
  reach.sides = {Eigen::Vector3d(c.fx, 0, c.cx + 0.5).normalized(),
                 Eigen::Vector3d(-c.fx, 0, right).normalized(),
                 Eigen::Vector3d(0, c.fy, c.cy + 0.5).normalized(),
                 Eigen::Vector3d(0, -c.fy, bottom).normalized()};
  cv::minMaxLoc(view.depth, nullptr, &reach.farthest);
  if (settings_.range > 0) reach.farthest = std::min(reach.farthest, settings_.range);
  if (view.inverse_sigmas.empty())  // with a margin for rounding
    reach.farthest = std::min(reach.farthest, 1.001 * settings_.RangeFor(view.inverse_sigma));
  reach.farthest += settings_.TruncationDistance();
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
