#include "alidade/place/settings.h"

#include "alidade/base/error.h"

namespace alidade {

void PlaceSettings::Check() const {
  vocabulary.Check();
  matching.Check();
  if (sample < 1) ThrowUsage("places.sample must be positive");
  if (shortlist < 1) ThrowUsage("places.shortlist must be positive");
}

}  // namespace alidade
