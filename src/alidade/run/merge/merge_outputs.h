// The outputs of `alidade merge`: the map, the trajectories in its worlds, and a list of what was
// merged.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/merge/merge_inputs.h"

namespace alidade {

// A world of the merged map and its inputs.
struct MergedWorld {
  MapId id;
  int keyframes = 0, landmarks = 0;
  std::vector<size_t> inputs;  // indices of the inputs in this world
};
// Sorted by the number of keyframes, largest first.
std::vector<MergedWorld> WorldsOf(const MergedMaps& merged);

// Where the results are written: `out` if it ends in .alidade, else map.alidade in the folder
// `out`.
struct MergePlaces {
  std::string map, folder;  // the folder holds trajectories and merge.json
};
MergePlaces MergePlacesOf(const std::string& out);

// Throws Error (usage) if other results would be lost: a map that was not merged from these inputs
// or a subset of them, or a file with the name of an input. `overwrite`: allows it.
void CheckMergePlaces(const MergePlaces& places, const std::vector<MergeInput>& inputs,
                      bool overwrite);

// Writes all outputs (docs/guides/several-maps.md) and removes trajectories of an earlier merge.
// Throws Error (input) if a file cannot be written.
void WriteMerge(const MergePlaces& places, const std::vector<MergeInput>& inputs,
                const MergedMaps& merged);

}  // namespace alidade
