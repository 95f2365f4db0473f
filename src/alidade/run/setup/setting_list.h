// The settings as a list for people: `alidade settings`, the reference page, help in Python.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/setup/run_settings.h"

namespace alidade {

struct SettingInfo {
  std::string name;      // with "expert." where it is one
  std::string value;     // of the settings that were asked
  std::string fallback;  // by default
  std::string unit, range, meaning;
  bool is_public = false;
};

// Public ones first, then in the order of the tables, each name once.
std::vector<SettingInfo> ListSettings(const RunSettings& settings = {});

// docs/reference/settings.md.
std::string SettingsPage(const std::vector<SettingInfo>& settings);

}  // namespace alidade
