// Settings of one struct by name. `Visit(settings, visitor)` must call visitor(name, field) for
// every field.
#pragma once

#include <algorithm>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"
#include "alidade/system/setting_text.h"

namespace alidade {

// Throws Error (usage) for a name that is not among them, or a value that is not of the field's
// type.
template <typename Settings, typename Visit>
void SetByName(Settings& settings, Visit&& visit, const std::string& name,
               const std::string& value) {
  bool known = false;
  std::vector<std::string> names;
  visit(settings, [&](const char* field, auto& member) {
    names.push_back(field);
    if (name != field) return;
    known = true;
    member = ParseSetting<std::decay_t<decltype(member)>>(name, value);
  });
  if (!known) ThrowUsage("unknown setting '" + name + "'" + DidYouMean(name, names));
}

// Sorted by name.
template <typename Settings, typename Visit>
std::vector<std::pair<std::string, std::string>> AllByName(const Settings& settings,
                                                           Visit&& visit) {
  std::vector<std::pair<std::string, std::string>> all;
  visit(settings, [&](const char* field, const auto& member) {
    all.push_back({field, FormatSetting(member)});
  });
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace alidade
