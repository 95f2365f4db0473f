#include "alidade/surface/voxel_blocks.h"

namespace alidade {
namespace {

constexpr int kBits = 21, kHalf = 1 << (kBits - 1);
constexpr uint64_t kMask = (uint64_t{1} << kBits) - 1;

}  // namespace

bool HasKey(const Eigen::Vector3i& at) { return at.minCoeff() >= -kHalf && at.maxCoeff() < kHalf; }

uint64_t KeyOf(const Eigen::Vector3i& at) {
  uint64_t key = 0;
  for (int i = 2; i >= 0; --i) key = key << kBits | static_cast<uint64_t>(at[i] + kHalf);
  return key;
}

Eigen::Vector3i PlaceOf(uint64_t key) {
  Eigen::Vector3i at;
  for (int i = 0; i < 3; ++i) at[i] = static_cast<int>(key >> (i * kBits) & kMask) - kHalf;
  return at;
}

int VoxelBlocks::Find(const Eigen::Vector3i& at) const {
  const auto found = index_.find(KeyOf(at));
  return found == index_.end() ? -1 : found->second;
}

int VoxelBlocks::Add(const Eigen::Vector3i& at) {
  const auto [entry, added] = index_.emplace(KeyOf(at), count());
  if (added) {
    blocks_.push_back(std::make_unique<VoxelBlock>());
    blocks_.back()->at = at;
  }
  return entry->second;
}

size_t VoxelBlocks::bytes() const {
  // An entry of the hash table: key, value, and the pointers of its list.
  constexpr size_t kEntry = 40;
  return blocks_.size() * (sizeof(VoxelBlock) + sizeof(void*) + kEntry);
}

}  // namespace alidade
