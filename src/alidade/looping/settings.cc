#include "alidade/looping/settings.h"

#include "alidade/base/error.h"

namespace alidade {

void LoopSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("setting loop.") + what);
  };
  require(match_scale > 0, "match_scale must be positive");
  require(candidates >= 1, "candidates must be at least 1");
  require(group >= candidates, "group must be at least loop.candidates");
  require(score_share >= 0 && score_share <= 1, "score_share must be between 0 and 1");
  require(min_aligned >= 3, "min_aligned must be at least 3");
  require(min_matches >= min_aligned, "min_matches must be at least loop.min_aligned");
  require(min_found >= 10, "min_found must be at least 10");
  require(min_merge_found >= min_found, "min_merge_found must be at least loop.min_found");
  require(min_found_share >= 0 && min_found_share <= 1, "min_found_share must be between 0 and 1");
  require(min_merge_alike >= 0 && min_merge_alike <= 1, "min_merge_alike must be between 0 and 1");
  require(min_known_scale >= 0, "min_known_scale must not be negative");
  require(alike_radius > 0, "alike_radius must be positive");
  require(search_radius > 0, "search_radius must be positive");
  require(max_distance > 0 && max_distance <= 256, "max_distance must be between 1 and 256");
  require(confirm_keyframes >= confirm_needed && confirm_needed >= 0,
          "confirm_keyframes must be at least loop.confirm_needed");
  require(max_drift > 0 && max_drift_floor >= 0, "max_drift must be positive");
  require(max_turn > 0, "max_turn must be positive");
  require(tied_share >= 0 && tied_share <= 1, "tied_share must be between 0 and 1");
  require(max_view_turn > 0, "max_view_turn must be positive");
  require(max_scale >= 1, "max_scale must be at least 1");
  require(max_plain_scale >= max_scale, "max_plain_scale must be at least loop.max_scale");
  reach.Check();
  graph.Check();
  bundle.Check();
}

}  // namespace alidade
