#include "alidade/place/settings.h"

#include "alidade/base/error.h"

namespace alidade {

void PlaceSettings::Check() const {
  vocabulary.Check();
  matching.Check();
  if (sample < 1) ThrowUsage("place.sample must be positive");
  if (shortlist < 1) ThrowUsage("place.shortlist must be positive");
}

}  // namespace alidade
