// The settings that a saved map was made with.
#pragma once

#include "alidade/map/map_file.h"
#include "alidade/system/settings.h"

namespace alidade {

// As far as this version has them; the others have their defaults.
SlamSettings SettingsOf(const SavedMap& saved);

}  // namespace alidade
