// Pose graph optimization: camera poses from relative pose measurements, after a loop closure or a
// merge of two maps (the essential graph of Strasdat, Montiel & Davison 2010; Mur-Artal, Montiel &
// Tardós 2015, §VII-D). Seven degrees of freedom if scale drifts, six if it is known. Flat arrays.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

struct PoseGraphEdge {
  int a = -1, b = -1;  // indices of nodes
  Sim3 T_a_b;          // measured: maps camera b's frame to camera a's
  double weight = 1;   // inverse variance relative to the other edges; 0: ignored
};

struct PoseGraph {
  std::vector<Sim3> T_camera_world;  // initial values and result
  std::vector<uint8_t> fixed;        // one per node; nonzero: held constant
  std::vector<PoseGraphEdge> edges;
  bool with_scale = true;  // false: s of all nodes and edges is 1
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
  double initial_cost = 0, final_cost = 0;  // ½ sum of weight × squared residual (or Huber loss)
  int iterations = 0;
  bool converged = false;  // stopped by the decrease, not by the iteration limit or `stop`
};

// Minimizes, in place, the sum over edges of weight × |Log(T_a_b T_b_world T_world_a)|², with the
// translation divided by the length scale. The cost never rises. Nodes not connected to a fixed
// node are unchanged, and their edges are ignored. `stop` (may be null) is polled between
// iterations. The result does not depend on the number of threads. Throws Error (usage) on indices
// out of range, self-edges and non-finite numbers.
PoseGraphReport OptimizePoseGraph(PoseGraph& graph, const PoseGraphSettings& settings = {},
                                  const std::atomic<bool>* stop = nullptr);

}  // namespace alidade
