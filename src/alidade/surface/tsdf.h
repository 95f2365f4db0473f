// Fuses depth images into signed distances to the surface.
#pragma once

#include "alidade/surface/dense_view.h"
#include "alidade/surface/mesh.h"
#include "alidade/surface/voxel_blocks.h"

namespace alidade {

struct TsdfSettings {
  double voxel = 0.02;  // edge length, meters (map units)
  // Readings with a standard deviation of more than this many voxels are left out.
  double most_sigma = 2;
  // Distance at which the signed distance is truncated, voxels: two standard deviations of the
  // least certain reading.
  double truncation = 4;
  double range = 0;  // farther readings are left out, meters; 0: by `most_sigma` alone

  double TruncationDistance() const { return truncation * voxel; }
  // Farthest depth of readings with a standard deviation of inverse depth, meters.
  double RangeFor(double inverse_sigma) const;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

// Truncated signed distance function (Curless & Levoy 1996) along the viewing rays, each reading
// weighted by the inverse of its variance. One thread at a time; the result does not depend on the
// number of threads it uses. To follow corrected poses (closed loops), fuse again.
class Tsdf {
 public:
  explicit Tsdf(const TsdfSettings& settings);

  void Add(const DenseView& view);
  // Where the surface was seen: the standard deviation by the readings is at most `most_sigma`. In
  // the world of the views.
  Mesh MakeMesh() const;
  size_t bytes() const { return blocks_.bytes(); }

 private:
  void AddBlocks(const DenseView& view);
  struct Reach;  // what a view can see
  Reach ReachOf(const DenseView& view) const;
  void Update(const DenseView& view, const Reach& reach, VoxelBlock& block) const;

  TsdfSettings settings_;
  VoxelBlocks blocks_;
};

}  // namespace alidade
