#include "alidade/system/saved_settings.h"

#include "alidade/base/error.h"
#include "alidade/system/setting_names.h"

namespace alidade {

SlamSettings SettingsOf(const SavedMap& saved) {
  SlamSettings settings;
  for (const auto& [name, value] : saved.settings) {
    try {
      SetByName(settings.Parts(), name, value, OldNames::kAccept);
    } catch (const Error&) {  // a setting of another version
    }
  }
  return settings;
}

}  // namespace alidade
