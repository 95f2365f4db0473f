// Which of several runs can be drawn in one world.
#pragma once

#include <optional>
#include <vector>

#include "alidade/run/folder/result_folder.h"
#include "alidade/run/sources/truth.h"

namespace alidade {

struct PlacedRuns {
  std::vector<size_t> runs;         // indices of the results
  std::vector<Sim3> T_place_world;  // of each run; the place's world is that of the first one's
                                    // ground truth, or its own
};

// Groups the runs that have a trajectory, in their order. `errors`: of each run, if its ground
// truth is known. A run joins the place of an earlier run if
// - both have ground truth, and it is of the same recording or the same trajectory; it is then
//   aligned to its own ground truth;
// - otherwise if both are of the same recording, or at least half of the poses of the shorter one
//   have common times and agree, once aligned, to 5 % of the extent of the earlier one.
std::vector<PlacedRuns> PlacesOf(const std::vector<ResultFolder>& results,
                                 const std::vector<std::optional<TruthErrors>>& errors);

}  // namespace alidade
