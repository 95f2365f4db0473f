// Which maps of a batch can be merged.
#pragma once

#include <string>
#include <vector>

namespace alidade {

struct MergePlan {
  std::vector<std::vector<std::string>> groups;  // two or more each, the largest group first
  std::vector<std::string> left_out;             // one sentence for each map in no group
};

// `maps`: result folders of `run` with a map. A map joins the group of the largest map that it can
// be merged with (WhyNotTogether()). Maps that cannot be read, hold no keyframes or are the same as
// another one are left out.
MergePlan PlanMerge(const std::vector<std::string>& maps);

// Folder of a group in the batch's folder: "merged", then "merged-2", ...
std::string MergedName(size_t group);

}  // namespace alidade
