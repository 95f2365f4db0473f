// Compares several runs, from their result folders.
#pragma once

#include <string>
#include <vector>

namespace alidade {

struct ComparedFolder {
  std::string path;
  std::string name;  // name on the page; empty: that of the folder, or its path if two are equal
};

// The page (view/comparison.h). Runs of one place are drawn over each other, in the world of the
// first of them (compared_places.h), those of other places beside them. Throws Error: usage for
// fewer than two results, input for folders without a run.
std::string CompareResults(const std::vector<ComparedFolder>& folders);

}  // namespace alidade
