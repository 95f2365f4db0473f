#include "alidade/run/batch/batch_merge.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/system/merge_maps.h"

namespace alidade {
namespace {

struct Candidate {
  std::string path, name;
  SavedMap saved;  // without its map
  std::pair<int, int> size;
};

std::string NameOf(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::optional<Candidate> ReadCandidate(const std::string& path, std::string& why) {
  try {
    Candidate candidate{path, NameOf(path), ReadSavedMap(path), {}};
    SavedMap& saved = candidate.saved;
    candidate.size = {saved.map.keyframe_count(), saved.map.landmark_count()};
    saved.map = {};
    saved.places = {};
    if (candidate.size.first > 0) return candidate;
    why = candidate.name + ": its map is empty";
  } catch (const Error& error) {
    why = error.what();
  }
  return std::nullopt;
}

bool SameFile(const Candidate& a, const Candidate& b) {
  return a.size == b.size && ReadFile(SavedMapPath(a.path), kMostMapBytes) ==
                                 ReadFile(SavedMapPath(b.path), kMostMapBytes);
}

}  // namespace

MergePlan PlanMerge(const std::vector<std::string>& maps) {
  MergePlan plan;
  std::vector<Candidate> candidates;
  for (const std::string& path : maps) {
    std::string why;
    std::optional<Candidate> candidate = ReadCandidate(path, why);
    const auto twin =
        !candidate
            ? candidates.end()
            : std::find_if(candidates.begin(), candidates.end(),
                           [&](const Candidate& other) { return SameFile(*candidate, other); });
    if (twin != candidates.end()) {
      plan.left_out.push_back(candidate->name + " is the same map as " + twin->name);
    } else if (candidate) {
      candidates.push_back(std::move(*candidate));
    } else {
      plan.left_out.push_back(why);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.size > b.size; });
  std::vector<std::vector<const Candidate*>> groups;
  for (const Candidate& candidate : candidates) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& other) {
      return WhyNotTogether(other.front()->saved, candidate.saved).empty();
    });
    if (group == groups.end()) {
      groups.push_back({&candidate});
    } else {
      group->push_back(&candidate);
    }
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (const auto& group : groups) {
    if (group.size() > 1) {
      std::vector<std::string>& paths = plan.groups.emplace_back();
      for (const Candidate* candidate : group) paths.push_back(candidate->path);
    } else if (groups.size() > 1) {
      const Candidate& one = *group.front();
      const Candidate& other = *(&group == &groups.front() ? groups[1] : groups.front()).front();
      plan.left_out.push_back(one.name + " with " + other.name + ": " +
                              WhyNotTogether(other.saved, one.saved));
    }
  }
  return plan;
}

std::string MergedName(size_t group) {
  return group == 0 ? "merged" : "merged-" + std::to_string(group + 1);
}

}  // namespace alidade
