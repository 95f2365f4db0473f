// What `alidade merge` leaves: the map, the trajectories in its worlds, and what was joined.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/export/merge_inputs.h"

namespace alidade {

// A world of the merged map, and whose it is.
struct MergedWorld {
  MapId id;
  int keyframes = 0, landmarks = 0;
  std::vector<size_t> inputs;  // that are in it
};
// The one with the most keyframes first.
std::vector<MergedWorld> WorldsOf(const MergedMaps& merged);

// Where the results go: `out` itself when it ends in .alidade, else map.alidade in the folder
// `out`.
struct MergePlaces {
  std::string map, folder;  // the folder holds trajectories and merge.json
};
MergePlaces MergePlacesOf(const std::string& out);

// Throws Error (usage) where results of something else would be lost: a map that was not merged
// from these inputs, or some of them, and a file of an input's name. `overwrite`: they may be.
void CheckMergePlaces(const MergePlaces& places, const std::vector<MergeInput>& inputs,
                      bool overwrite);

// Writes all of it (docs/guides/several-maps.md) and removes the trajectories of an earlier merge.
// Throws Error (input) when a file cannot be written.
void WriteMerge(const MergePlaces& places, const std::vector<MergeInput>& inputs,
                const MergedMaps& merged);

}  // namespace alidade
