#include "alidade/run/results/run_log.h"

#include <algorithm>

namespace alidade {

std::string WhyNothing(const RunLog& log) {
  if (log.frames == 0) return "the source has no frame";
  if (log.dropped == log.frames) {
    return "none of the " + std::to_string(log.frames) + " frames could be used (" +
           log.first_problem + ")";
  }
  const int used = log.frames - log.dropped;
  if (2 * log.dark > used) return "the images are black";
  const auto most =
      std::max_element(log.untracked_reasons.begin(), log.untracked_reasons.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == log.untracked_reasons.end() ? "no frame was tracked" : most->first;
}

}  // namespace alidade
