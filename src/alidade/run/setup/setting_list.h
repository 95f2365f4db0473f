// The settings as a list for users: `alidade settings`, the reference page, help in Python.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/setup/run_settings.h"

namespace alidade {

struct SettingInfo {
  std::string name;      // with "expert." for expert settings
  std::string value;     // current value
  std::string fallback;  // default value
  std::string unit, range, meaning;
  bool is_public = false;
};

// Public settings first, then in the order of the tables, each name once.
std::vector<SettingInfo> ListSettings(const RunSettings& settings = {});

// docs/reference/settings.md.
std::string SettingsPage(const std::vector<SettingInfo>& settings);

}  // namespace alidade
