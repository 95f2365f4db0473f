// A map as held by Python objects.
#pragma once

#include <memory>

#include "alidade/map/map_file.h"
#include "python.h"

namespace alidade::python {

// Immutable. Encoded on demand.
using MapValue = SavedMap;
using MapHolder = std::shared_ptr<MapValue>;

}  // namespace alidade::python
