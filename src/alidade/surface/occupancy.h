// A grid of free, occupied and unknown cells on the floor, from depth images.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "alidade/surface/dense_view.h"

namespace alidade {

struct OccupancySettings {
  double cell = 0.05;       // edge length, meters (map units)
  double clearance = 0.05;  // lower things are driven over, meters above the floor
  double height = 1.0;      // of the robot: what hangs higher is driven under, meters
  // Readings with a standard deviation of more than this many cells are left out, except of the
  // floor, whose place is known by the ray.
  double most_sigma = 2;
  double range = 0;  // farther readings are left out, meters; 0: by `most_sigma` alone
  // Inverse sensor model (Moravec & Elfes 1985): probability that a voxel is occupied if rays of
  // one image end in it, and if they pass through it (that of Hornung et al. 2013). Ends count
  // fully if they are a third of the rays that a surface in the voxel would stop.
  double hit = 0.8, pass = 0.4;
  // That something stands in a cell whose floor one image sees: wrong readings of the floor, as
  // often as of what stands there (1 - hit).
  double floor = 0.2;
  // A cell is never more certain than this, so that what changes is learned (Yguel et al. 2007).
  double least = 0.12, most = 0.97;
  // Reported as occupied, and as free: map_server's thresholds. One image of a cell's floor
  // suffices.
  double occupied = 0.65, free = 0.25;

  // Farthest depth that is used of readings with a standard deviation of inverse depth, meters.
  double RangeFor(double inverse_sigma) const;
  // Depth whose typical standard deviation in `view` is one cell, meters; at most `range`.
  double SharpRange(const DenseView& view) const;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

// As nav_msgs/OccupancyGrid has it.
struct OccupancyPicture {
  int width = 0, height = 0;  // cells along x and y
  double cell = 0;            // edge length, meters
  double x = 0, y = 0;        // of the corner of the first cell, meters in the floor's frame
  // By row from small y, in a row from small x: 0 free, 100 occupied, -1 unknown.
  std::vector<int8_t> cells;

  int8_t At(int column, int row) const {
    return cells[static_cast<size_t>(row) * static_cast<size_t>(width) +
                 static_cast<size_t>(column)];
  }
};

// Log-odds of voxels from the floor up to the robot's height (Moravec & Elfes 1985; in three
// dimensions, as what is seen below a table top says nothing of the top). A cell of the floor is
// occupied if any voxel above `clearance` is; it is free if its floor was seen or rays came lower
// than `clearance` there, and nothing above is thought to be occupied. Add() may be called image by
// image; one thread.
class OccupancyMap {
 public:
  // `T_floor_world`: Floor::FrameFor(), from the world of the views.
  OccupancyMap(const OccupancySettings& settings, const Se3& T_floor_world);

  void Add(const DenseView& view);
  // The smallest rectangle with all cells that are not unknown; empty if there are none.
  OccupancyPicture Picture() const;
  size_t bytes() const;  // approximate

 private:
  static constexpr int kTile = 16;  // columns of voxels in each direction
  struct Tile {
    int x, y;
    std::vector<float> log_odds;  // by column, then height; 0: unknown
    std::vector<uint32_t> seen;   // number of the last image with a ray, times 2, +1 if it ended
  };
  struct Ray {
    Eigen::Vector3d from, to;  // in voxels
  };

  Tile& TileAt(int x, int y);
  size_t IndexIn(int x, int y, int layer) const;
  // A reading in the floor's frame.
  struct Reading {
    Eigen::Vector3d camera, ray;
    double z, sigma;  // depth along z of the camera, meters
    Eigen::Vector3d At(double depth) const { return camera + depth * ray; }
  };

  // Spreads a reading over the voxels within two standard deviations: a ray ends in each of them
  // with the probability of the reading, and passes it with that of those behind.
  void HitAlong(const Reading& reading);
  void Hit(const Eigen::Vector3d& p_floor, double z, double ends, double passes);
  void UseHits(double rays_at_one);
  // Log-odds that something stands where a reading has this height above the floor, meters.
  double FloorEvidence(double height, double sigma) const;
  void SeeFloor(const Eigen::Vector3d& p_floor, double evidence);
  void UseFloors();
  void Pass(int x, int y, int layer);
  // Uses the end of a ray: something to hit, the floor, or, clearly below it, a hole or a mirror,
  // which makes nothing free. Returns the depth up to which the ray passes.
  double Use(const Reading& reading, double range);
  void PassAlong(const Ray& ray);
  void Update(int x, int y, int layer, uint32_t mark, float change);
  Eigen::Vector3d InVoxels(const Eigen::Vector3d& p_floor) const;
  int8_t StateOf(const Tile& tile, int x, int y) const;

  OccupancySettings settings_;
  Se3 T_floor_world_;
  int layers_;  // the lowest is what a robot drives over
  uint32_t image_ = 0;
  float pass_, floor_, least_, most_;  // log-odds
  struct Hits {
    int rays = 0;
    double z = 0;                 // depth of the first, meters
    double ends = 0, passes = 0;  // sums of probabilities
  };
  struct SeenFloor {
    int count = 0;
    double evidence = 0;  // sum of log-odds
  };
  std::unordered_map<uint64_t, SeenFloor> floors_;  // of the present image, by voxel
  std::unordered_map<uint64_t, Hits> hits_;         // of the present image, by voxel
  std::unordered_map<uint64_t, size_t> index_;
  std::vector<Tile> tiles_;
  size_t last_ = 0;  // index of the tile used last: rays stay in one for a while
};

// map.pgm: black occupied, white free, gray unknown; the first row has the largest y.
std::string EncodeGridPgm(const OccupancyPicture& picture);
// map.yaml for map_server. `image`: name of the PGM beside it. `notes`: comment lines.
std::string EncodeGridYaml(const OccupancyPicture& picture, const std::string& image,
                           const std::vector<std::string>& notes);

}  // namespace alidade
