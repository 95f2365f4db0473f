// Pose graph: camera poses that agree best with relative poses measured between them, after a loop
// was closed or two maps were joined (the "essential graph" of Strasdat, Montiel & Davison 2010;
// Mur-Artal, Montiel & Tardós 2015, §VII-D). Seven degrees of freedom where scale drifts, six where
// it is known. Flat arrays, no map.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

struct PoseGraphEdge {
  int a = -1, b = -1;  // indices of nodes
  Sim3 T_a_b;          // measured: camera b's frame to a's
  double weight = 1;   // inverse of a variance, against the other edges'; 0: left out
};

struct PoseGraph {
  std::vector<Sim3> T_camera_world;  // start, and result
  std::vector<uint8_t> fixed;        // one per node: nonzero = held where it is
  std::vector<PoseGraphEdge> edges;
  bool with_scale = true;  // false: s of all nodes and edges is taken as 1, and comes out as 1
};

struct PoseGraphSettings {
  int max_iterations = 20;              // accepted or rejected Levenberg–Marquardt steps
  double min_relative_decrease = 1e-6;  // stops when a step lowers the cost by less
  double huber = 0;              // of sqrt(weight) × the residual's length, radians; 0 = off
  double initial_lambda = 1e-9;  // damping, relative to the diagonal; long loops are soft
  // Map units whose error weighs as much as one of a radian, or of one in log scale. Right is the
  // distance of what the cameras look at (the landmarks' median depth): an error of one pixel is
  // then the same as a turn or as a shift. 0 = 10 × the median length of the edges, as keyframes
  // stand about a tenth of the depth apart; so the result does not depend on the map's unit.
  double length_scale = 0;
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

struct PoseGraphReport {
  double initial_cost = 0, final_cost = 0;  // ½ sum of weight × squared residual (or Huber's loss)
  int iterations = 0;
  bool converged = false;  // stopped by the decrease, not by the count or `stop`
};

// Minimises, in place, the sum over the edges of weight × |Log(T_a_b T_b_world T_world_a)|², its
// translation divided by the length scale. The cost never rises. Nodes that no edges connect to a
// fixed one stay where they are, and their edges count for nothing. `stop` (may be null) is looked
// at between iterations. The result is the same with any number of threads. Throws Error (usage) on
// indices that aren't there, edges from a node to itself, and numbers that are none.
PoseGraphReport OptimizePoseGraph(PoseGraph& graph, const PoseGraphSettings& settings = {},
                                  const std::atomic<bool>* stop = nullptr);

}  // namespace alidade
