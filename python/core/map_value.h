// A map as Python holds it.
#pragma once

#include <memory>

#include "alidade/map/map_file.h"
#include "python.h"

namespace alidade::python {

// Never changes. Its bytes are made when they are asked for.
using MapValue = SavedMap;
using MapHolder = std::shared_ptr<MapValue>;

}  // namespace alidade::python
