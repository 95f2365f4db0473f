#include "alidade/run/export/frame_matcher.h"

#include "alidade/base/error.h"

namespace alidade {

std::optional<PosedFrame> FrameMatcher::Match(const SourceFrame& frame) {
  if (!frame.problem.empty() || frame.image.empty()) return std::nullopt;
  for (const PosedFrame& candidate : poses_.At(frame.time)) {
    if (!candidate.keyframe.valid()) return candidate;
    if (found_.count(candidate.keyframe) > 0) continue;
    if (!check_.Shows(frame.image, *saved_.map.Find(candidate.keyframe))) {
      others_.insert(candidate.keyframe);
      continue;
    }
    found_.insert(candidate.keyframe);
    others_.erase(candidate.keyframe);
    return candidate;
  }
  return std::nullopt;
}

void FrameMatcher::CheckFound(const std::string& source) const {
  if (!found_.empty()) return;
  ThrowInput(source +
             (others_.empty() ? " has no frame at the times of the map's keyframes"
                              : ": its images do not show what the map was made of") +
             ": it was changed since the run, or is another recording");
}

int FrameMatcher::missing() const {
  return static_cast<int>(poses_.keyframes() - found_.size() - others_.size());
}

}  // namespace alidade
