#include "alidade/detect/settings.h"

#include "alidade/base/error.h"

namespace alidade {

void DetectorSettings::Check() const {
  if (!(min_score > 0 && min_score < 1)) ThrowUsage("detector.min_score must be between 0 and 1");
  if (!(max_overlap > 0 && max_overlap <= 1))
    ThrowUsage("detector.max_overlap must be above 0 and at most 1");
}

}  // namespace alidade
