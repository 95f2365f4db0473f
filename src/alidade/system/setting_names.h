// Settings by name, over the tables of several structs.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/settings_table.h"

namespace alidade {

// What to do with a name of an earlier version.
enum class OldNames { kWarn, kAccept };

// Sets every field with this name. Earlier names are accepted: that of an expert setting without
// "expert.", and those of setting_old_names.h. Throws Error (usage) for an unknown name, with the
// nearest known one, or a value of another type; the range is checked by Check().
void SetByName(std::span<const SettingsPart> parts, const std::string& name,
               const std::string& value, OldNames old = OldNames::kWarn);

// (name, value) of every setting, sorted by name; one of each name.
std::vector<std::pair<std::string, std::string>> AllByName(std::span<const SettingsPart> parts);

}  // namespace alidade
