#include "alidade/surface/surface_nets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

constexpr int kSide = VoxelBlock::kSide;
constexpr int kPadded = kSide + 1;

using CellVertices = std::array<int32_t, VoxelBlock::kVoxels>;  // index in the block; -1: none

constexpr int kStrides[3] = {1, kPadded, kPadded* kPadded};

// The voxels of a block and the first ones of the blocks behind it along x, y and z.
class PaddedBlock {
 public:
  enum Flag : uint8_t { kSeen = 1, kOftenSeen = 2, kBehind = 4 };
  using Flags = std::array<uint8_t, kPadded * kPadded * kPadded>;

  PaddedBlock(const VoxelBlocks& blocks, int index, float min_weight) {
    static const VoxelBlock kUnseen{};
    const Eigen::Vector3i at = blocks[index].at;
    for (int i = 0; i < 8; ++i) {
      const int found =
          i == 0 ? index : blocks.Find(at + Eigen::Vector3i(i & 1, i >> 1 & 1, i >> 2));
      blocks_[static_cast<size_t>(i)] = found < 0 ? &kUnseen : &blocks[found];
    }
    for (int z = 0, i = 0; z < kPadded; ++z) {
      for (int y = 0; y < kPadded; ++y) {
        for (int x = 0; x < kPadded; ++x, ++i) {
          const Voxel& voxel = At(x, y, z);
          flags_[static_cast<size_t>(i)] = static_cast<uint8_t>(
              (voxel.weight != 0 ? kSeen : 0) | (voxel.weight >= min_weight ? kOftenSeen : 0) |
              (voxel.distance < 0 ? kBehind : 0));
        }
      }
    }
  }
  static size_t IndexOf(int x, int y, int z) {
    return static_cast<size_t>((z * kPadded + y) * kPadded + x);
  }
  const Voxel& At(int x, int y, int z) const {
    const int which = x / kSide | y / kSide << 1 | z / kSide << 2;
    return blocks_[static_cast<size_t>(which)]
        ->voxels[static_cast<size_t>(VoxelBlock::IndexOf(x % kSide, y % kSide, z % kSide))];
  }
  const Flags& flags() const { return flags_; }  // by IndexOf()

 private:
  std::array<const VoxelBlock*, 8> blocks_{};
  Flags flags_;
};

// Flags that all corners of a cell have, and those that any has, by the index of corner 0.
struct CellFlags {
  explicit CellFlags(const PaddedBlock::Flags& flags) : all(flags), any(flags) {
    for (const int stride : kStrides) {
      const auto step = static_cast<size_t>(stride);
      for (size_t i = 0; i + step < all.size(); ++i) {  // beyond the last cells: not used
        all[i] &= all[i + step];
        any[i] |= any[i + step];
      }
    }
  }
  // All corners were seen often enough, and some are behind the surface.
  bool Cut(size_t i) const {
    return (all[i] & PaddedBlock::kOftenSeen) != 0 && (any[i] & PaddedBlock::kBehind) != 0 &&
           (all[i] & PaddedBlock::kBehind) == 0;
  }
  PaddedBlock::Flags all, any;
};

using Cell = std::array<const Voxel*, 8>;  // corner i at (i & 1, i >> 1 & 1, i >> 2)

Cell CellAt(const PaddedBlock& block, int x, int y, int z) {
  Cell cell;
  for (int i = 0; i < 8; ++i)
    cell[static_cast<size_t>(i)] = &block.At(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
  return cell;
}

struct BlockSurface {
  Cloud vertices;
  CellVertices cells;
  uint32_t first = 0;  // index of its first vertex in the mesh
};

// The vertex of a cell: position in voxels from its corner 0, normal, color.
void AddVertex(const Cell& cell, const Eigen::Vector3f& corner, float voxel, Cloud& vertices) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero(), gradient = Eigen::Vector3f::Zero();
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
  int cuts = 0;
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (i >> axis & 1) continue;
      const Voxel &a = *cell[static_cast<size_t>(i)],
                  &b = *cell[static_cast<size_t>(i | 1 << axis)];
      const float da = a.distance, db = b.distance;
      gradient[axis] += db - da;
      if ((da < 0) == (db < 0)) continue;
      const float share = da / (da - db);
      Eigen::Vector3f cut(static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1),
                          static_cast<float>(i >> 2));
      cut[axis] += share;
      sum += cut;
      for (size_t c = 0; c < 3; ++c)
        color[static_cast<int>(c)] += (1 - share) * a.rgb[c] + share * b.rgb[c];
      ++cuts;
    }
  }
  const float count = static_cast<float>(cuts);
  vertices.points.push_back(voxel * (corner + sum / count));
  vertices.normals.push_back(gradient.normalized());
  std::array<uint8_t, 3> rgb{};
  for (size_t c = 0; c < 3; ++c)
    rgb[c] = static_cast<uint8_t>(
        std::lround(std::min(255.0f, color[static_cast<int>(c)] / count / 256)));
  vertices.colors.push_back(rgb);
}

BlockSurface VerticesOf(const VoxelBlocks& blocks, int index, const SurfaceNetsSettings& settings) {
  BlockSurface surface;
  surface.cells.fill(-1);
  const PaddedBlock block(blocks, index, static_cast<float>(settings.min_weight));
  const CellFlags flags(block.flags());
  const Eigen::Vector3f start = (kSide * blocks[index].at).cast<float>();
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        if (!flags.Cut(PaddedBlock::IndexOf(x, y, z))) continue;
        surface.cells[static_cast<size_t>(VoxelBlock::IndexOf(x, y, z))] =
            static_cast<int32_t>(surface.vertices.points.size());
        AddVertex(
            CellAt(block, x, y, z),
            start + Eigen::Vector3f(0.5f, 0.5f, 0.5f) + Eigen::Vector3i(x, y, z).cast<float>(),
            static_cast<float>(settings.voxel), surface.vertices);
      }
    }
  }
  return surface;
}

// Vertices of cells by their place relative to a block: the block's own and those before it.
class NearCells {
 public:
  NearCells(const VoxelBlocks& blocks, const std::vector<BlockSurface>& surfaces, int index) {
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3i step(i & 1, i >> 1 & 1, i >> 2);
      const int found = i == 0 ? index : blocks.Find(blocks[index].at - step);
      surfaces_[static_cast<size_t>(i)] =
          found < 0 ? nullptr : &surfaces[static_cast<size_t>(found)];
    }
  }
  // Index in the mesh; -1: none. Coordinates from -1 on.
  int64_t At(const Eigen::Vector3i& cell) const {
    const int which = (cell.x() < 0 ? 1 : 0) | (cell.y() < 0 ? 2 : 0) | (cell.z() < 0 ? 4 : 0);
    const BlockSurface* surface = surfaces_[static_cast<size_t>(which)];
    if (surface == nullptr) return -1;
    const int32_t vertex = surface->cells[static_cast<size_t>(
        VoxelBlock::IndexOf(cell.x() & 7, cell.y() & 7, cell.z() & 7))];
    return vertex < 0 ? -1 : int64_t{surface->first} + vertex;
  }

 private:
  std::array<const BlockSurface*, 8> surfaces_{};
};

// Two triangles around the edge from a voxel along `axis`, if all four cells have a vertex.
void AddQuad(const NearCells& cells, const Eigen::Vector3i& voxel, int axis, bool into_surface,
             std::vector<std::array<uint32_t, 3>>& triangles) {
  const Eigen::Vector3i b = Eigen::Vector3i::Unit((axis + 1) % 3),
                        c = Eigen::Vector3i::Unit((axis + 2) % 3);
  // Counterclockwise as seen from the end of the axis.
  const std::array<int64_t, 4> around = {cells.At(voxel - b - c), cells.At(voxel - c),
                                         cells.At(voxel), cells.At(voxel - b)};
  std::array<uint32_t, 4> corner{};
  for (size_t i = 0; i < 4; ++i) {
    if (around[i] < 0) return;
    corner[i] = static_cast<uint32_t>(around[i]);
  }
  if (into_surface) std::swap(corner[1], corner[3]);
  triangles.push_back({corner[0], corner[1], corner[2]});
  triangles.push_back({corner[0], corner[2], corner[3]});
}

std::vector<std::array<uint32_t, 3>> TrianglesOf(const VoxelBlocks& blocks,
                                                 const std::vector<BlockSurface>& surfaces,
                                                 int index) {
  std::vector<std::array<uint32_t, 3>> triangles;
  const PaddedBlock block(blocks, index, 0);
  const NearCells cells(blocks, surfaces, index);
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const size_t i = PaddedBlock::IndexOf(x, y, z);
        const uint8_t from = block.flags()[i];
        if ((from & PaddedBlock::kSeen) == 0) continue;
        for (int axis = 0; axis < 3; ++axis) {
          const uint8_t next = block.flags()[i + static_cast<size_t>(kStrides[axis])];
          if ((next & PaddedBlock::kSeen) == 0 || ((from ^ next) & PaddedBlock::kBehind) == 0)
            continue;
          AddQuad(cells, {x, y, z}, axis, (next & PaddedBlock::kBehind) != 0, triangles);
        }
      }
    }
  }
  return triangles;
}

template <typename T>
void Append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

Mesh MakeSurfaceNets(const VoxelBlocks& blocks, const SurfaceNetsSettings& settings) {
  const size_t count = static_cast<size_t>(blocks.count());
  std::vector<BlockSurface> surfaces(count);
  ParallelFor(blocks.count(),
              [&](int i) { surfaces[static_cast<size_t>(i)] = VerticesOf(blocks, i, settings); });
  Mesh mesh;
  for (BlockSurface& surface : surfaces) {
    surface.first = static_cast<uint32_t>(mesh.vertices.points.size());
    Append(surface.vertices.points, mesh.vertices.points);
    Append(surface.vertices.normals, mesh.vertices.normals);
    Append(surface.vertices.colors, mesh.vertices.colors);
    surface.vertices = {};
  }
  std::vector<std::vector<std::array<uint32_t, 3>>> triangles(count);
  ParallelFor(blocks.count(),
              [&](int i) { triangles[static_cast<size_t>(i)] = TrianglesOf(blocks, surfaces, i); });
  for (const auto& part : triangles) Append(part, mesh.triangles);
  return mesh;
}

}  // namespace alidade
