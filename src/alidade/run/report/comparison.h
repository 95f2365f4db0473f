// Several runs beside each other, from the folders they left.
#pragma once

#include <string>
#include <vector>

namespace alidade {

struct ComparedFolder {
  std::string path;
  std::string name;  // on the page; empty: the folder's own, or its path where two have the same
};

// The page (view/comparison.h). Paths are drawn in the first result's world: when its truth is
// known it is laid on that, and so are the others on theirs; without, others are laid on the first
// by the stamps they have in common. Throws Error: usage for fewer than two, input for folders that
// hold no run.
std::string CompareResults(const std::vector<ComparedFolder>& folders);

}  // namespace alidade
