// Voxels in blocks of 8 x 8 x 8 that exist only near surfaces, found by a hash table (Nießner et
// al. 2013).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace alidade {

struct Voxel {
  static constexpr float kFull = 32767;
  int16_t distance = 0;              // to the surface, positive in front: kFull = the truncation
  std::array<uint16_t, 3> rgb = {};  // red green blue, 1/256 of a gray level
  float weight = 0;                  // sum of those of its measurements; 0: never seen
};
static_assert(sizeof(Voxel) == 12);

struct VoxelBlock {
  static constexpr int kSide = 8, kVoxels = kSide * kSide * kSide;
  Eigen::Vector3i at;  // block (0, 0, 0) begins at the origin
  std::array<Voxel, kVoxels> voxels;

  static int IndexOf(int x, int y, int z) { return (z * kSide + y) * kSide + x; }
};

// Blocks keep their index. Not thread-safe, except for reading.
class VoxelBlocks {
 public:
  int count() const { return static_cast<int>(blocks_.size()); }
  VoxelBlock& operator[](int index) { return *blocks_[static_cast<size_t>(index)]; }
  const VoxelBlock& operator[](int index) const { return *blocks_[static_cast<size_t>(index)]; }
  int Find(const Eigen::Vector3i& at) const;  // index; -1: there is none
  int Add(const Eigen::Vector3i& at);         // the index of a new block, or of the one there
  size_t bytes() const;                       // approximate

 private:
  std::vector<std::unique_ptr<VoxelBlock>> blocks_;
  std::unordered_map<uint64_t, int> index_;  // by KeyOf()
};

// 21 bits for each coordinate. With voxels of 1 mm a block's side is 8 mm: 8 km in each direction.
uint64_t KeyOf(const Eigen::Vector3i& at);
Eigen::Vector3i PlaceOf(uint64_t key);
// Whether KeyOf() has the bits for it.
bool HasKey(const Eigen::Vector3i& at);

}  // namespace alidade
