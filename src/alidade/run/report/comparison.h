// Compares several runs, from their result folders.
#pragma once

#include <string>
#include <vector>

namespace alidade {

struct ComparedFolder {
  std::string path;
  std::string name;  // name on the page; empty: that of the folder, or its path if two are equal
};

// The page (view/comparison.h). Trajectories are drawn in the world of the first result: if its
// ground truth is known, each is aligned to its own ground truth, else the others are aligned to
// the first one by common time stamps. Throws Error: usage for fewer than two results, input for
// folders without a run.
std::string CompareResults(const std::vector<ComparedFolder>& folders);

}  // namespace alidade
