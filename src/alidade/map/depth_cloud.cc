#include "alidade/map/depth_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace alidade {
namespace {

// One point in the world frame.
struct Sample {
  Eigen::Vector3d p_world;  // meters
  double sigma = 0;         // along the ray, meters
  std::array<uint8_t, 3> rgb{};
};

template <typename Take>
void ForEachSample(const std::vector<PlacedDepth>& keyframes, const Camera& camera,
                   const Take& take) {
  for (const PlacedDepth& keyframe : keyframes) {
    for (const DepthPixel& pixel : keyframe.depth->pixels) {
      const double inverse = pixel.inverse_depth;
      if (!(inverse > 0)) continue;
      const Eigen::Vector3d ray = camera.Unproject({pixel.x, pixel.y});  // z = 1
      const Eigen::Vector3d p = keyframe.T_world_camera * (ray * (keyframe.scale / inverse));
      if (!p.allFinite()) continue;
      // d(1/ρ) = dρ / ρ², along the ray.
      const double sigma = keyframe.scale * ray.norm() * pixel.sigma / (inverse * inverse);
      take(Sample{p, sigma, pixel.rgb});
    }
  }
}

using Voxel = std::array<int64_t, 3>;

// Numbers voxels in the order in which they are first met. A table of numbers and a list of voxels
// take less memory than std::unordered_map.
class VoxelNumbers {
 public:
  size_t Of(const Voxel& voxel) {
    if (2 * voxels_.size() >= table_.size()) Grow();
    uint32_t& number = table_[Slot(voxel)];
    if (number == kNone) {
      number = static_cast<uint32_t>(voxels_.size());
      voxels_.push_back(voxel);
    }
    return number;
  }

 private:
  static constexpr uint32_t kNone = UINT32_MAX;

  // Where the number of the voxel is or has to be, by linear probing.
  size_t Slot(const Voxel& voxel) const {
    uint64_t hash = 0;
    for (const int64_t i : voxel) {
      hash = (hash ^ static_cast<uint64_t>(i)) * 0x9e3779b97f4a7c15ull;
      hash ^= hash >> 29;
    }
    size_t slot = static_cast<size_t>(hash) & (table_.size() - 1);
    while (table_[slot] != kNone && voxels_[table_[slot]] != voxel)
      slot = (slot + 1) & (table_.size() - 1);
    return slot;
  }
  void Grow() {
    table_.assign(std::max<size_t>(1024, 2 * table_.size()), kNone);
    for (size_t i = 0; i < voxels_.size(); ++i) table_[Slot(voxels_[i])] = static_cast<uint32_t>(i);
  }

  std::vector<uint32_t> table_;  // a power of two, at most half full
  std::deque<Voxel> voxels_;     // grows without copying
};

// Weighted sums over the samples of one voxel.
struct Sums {
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), rgb = Eigen::Vector3d::Zero();
  double weight = 0;
};

void Append(Cloud& cloud, const Sample& sample) {
  cloud.points.push_back(sample.p_world.cast<float>());
  cloud.colors.push_back(sample.rgb);
  cloud.sigmas.push_back(static_cast<float>(sample.sigma));
}

Sample MeanOf(const Sums& sums) {
  Sample mean;
  mean.p_world = sums.p / sums.weight;
  mean.sigma = 1 / std::sqrt(sums.weight);
  for (int channel = 0; channel < 3; ++channel) {
    mean.rgb[static_cast<size_t>(channel)] =
        static_cast<uint8_t>(std::lround(sums.rgb[channel] / sums.weight));
  }
  return mean;
}

}  // namespace

PlacedDepth PlaceDepth(const KeyFrame& keyframe) {
  return {keyframe.depth.get(), keyframe.T_camera_world.Inverse(),
          keyframe.scale / keyframe.depth->scale};
}

Cloud MakeDepthCloud(const std::vector<PlacedDepth>& keyframes, const Camera& camera,
                     double voxel) {
  Cloud cloud;
  if (!(voxel > 0)) {
    ForEachSample(keyframes, camera, [&](const Sample& sample) { Append(cloud, sample); });
    return cloud;
  }
  std::optional<VoxelNumbers> places(std::in_place);  // index of each voxel in `sums`
  std::deque<Sums> sums;
  ForEachSample(keyframes, camera, [&](const Sample& sample) {
    constexpr double kFarthest = 1e15;  // voxels; beyond it indices lose precision
    const Eigen::Vector3d index = sample.p_world / voxel;
    if (!(index.cwiseAbs().maxCoeff() < kFarthest)) return;
    Voxel key{};
    for (int axis = 0; axis < 3; ++axis)
      key[static_cast<size_t>(axis)] = static_cast<int64_t>(std::floor(index[axis]));
    const size_t place = places->Of(key);
    if (place == sums.size()) sums.emplace_back();
    // Lower limit of a millionth of a voxel: a sigma of 0 would give infinite weight.
    const double sigma = std::max(sample.sigma, 1e-6 * voxel);
    const double weight = 1 / (sigma * sigma);
    Sums& sum = sums[place];
    sum.p += weight * sample.p_world;
    for (int channel = 0; channel < 3; ++channel)
      sum.rgb[channel] += weight * sample.rgb[static_cast<size_t>(channel)];
    sum.weight += weight;
  });
  places.reset();
  cloud.points.reserve(sums.size());
  cloud.colors.reserve(sums.size());
  cloud.sigmas.reserve(sums.size());
  for (const Sums& sum : sums) Append(cloud, MeanOf(sum));
  return cloud;
}

cv::Mat DrawDepth(const DepthMap& depth, double scale, const Camera& camera) {
  cv::Mat1w picture(camera.height, camera.width, uint16_t{0});
  for (const DepthPixel& pixel : depth.pixels) {
    if (!(pixel.inverse_depth > 0)) continue;
    const double value = std::round(kDepthPictureFactor * scale / pixel.inverse_depth);
    if (!(value >= 1 && value <= 65535)) continue;
    const Eigen::Vector2d taken = camera.Distort({pixel.x, pixel.y});
    const double x = std::round(taken.x()), y = std::round(taken.y());
    if (!(x >= 0 && y >= 0 && x < camera.width && y < camera.height)) continue;
    uint16_t& old = picture(static_cast<int>(y), static_cast<int>(x));
    if (old == 0 || value < old) old = static_cast<uint16_t>(value);
  }
  return picture;
}

}  // namespace alidade
