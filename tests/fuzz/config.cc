#include "alidade/run/setup/run_settings.h"
#include "alidade/run/setup/settings_file.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {

// Valid settings are written into maps and stats.json, and must be readable from there.
void Config(std::string_view bytes) {
  RunSettings settings;
  ApplySettingsText(std::string(bytes), "settings.yaml", settings);
  settings.Check();
  RunSettings again;
  for (const auto& [name, value] : settings.All()) {
    try {
      again.Set(name, value);
    } catch (const std::exception& error) {
      Expect(false, "a setting's value cannot be set: " + std::string(error.what()));
    }
  }
  Expect(again.All() == settings.All(), "settings change when they are set to what they are");
}

}  // namespace alidade::fuzz
