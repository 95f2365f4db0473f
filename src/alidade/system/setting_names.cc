#include "alidade/system/setting_names.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/nearest_name.h"
#include "alidade/io/text.h"
#include "alidade/system/setting_old_names.h"

namespace alidade {
namespace {

constexpr std::string_view kExpert = "expert.";

double ParseWhole(const std::string& name, const std::string& text, double min, double max) {
  const double number = ParseNumber(text).value_or(std::nan(""));
  if (!std::isfinite(number) || number != std::floor(number))
    ThrowUsage("setting " + name + ": '" + text + "' is not a whole number");
  if (number < min || number > max)
    ThrowUsage("setting " + name + ": " + text + " is out of range");
  return number;
}

bool ParseBool(const std::string& name, const std::string& text) {
  if (text == "true") return true;
  if (text == "false") return false;
  const double number = ParseNumber(text).value_or(-1);
  if (number == 0 || number == 1) return number == 1;
  ThrowUsage("setting " + name + ": '" + text + "' is neither 1 (true) nor 0 (false)");
}

double ParseReal(const std::string& name, const std::string& text, bool is_float) {
  double number = ParseNumber(text).value_or(std::nan(""));
  if (is_float) number = static_cast<float>(number);  // infinite beyond a float's range
  if (!std::isfinite(number)) ThrowUsage("setting " + name + ": '" + text + "' is not a number");
  return number;
}

int ParseWord(const std::string& name, const std::string& text, const char* const* words) {
  std::vector<std::string> known;
  std::string list;
  for (int i = 0; words[i] != nullptr; ++i) {
    if (text == words[i]) return i;
    known.push_back(words[i]);
    list += (list.empty() ? "" : ", ") + known.back();
  }
  ThrowUsage("setting " + name + " cannot be '" + text + "' (it is one of " + list + ")" +
             DidYouMean(text, known));
}

void SetValue(const Setting& row, void* settings, const std::string& name,
              const std::string& text) {
  void* field = row.field(settings);
  switch (row.type) {
    case SettingType::kBool:
      *static_cast<bool*>(field) = ParseBool(name, text);
      break;
    case SettingType::kInt:
      *static_cast<int*>(field) =
          static_cast<int>(ParseWhole(name, text, -2147483648.0, 2147483647.0));
      break;
    case SettingType::kUint64:
      *static_cast<uint64_t*>(field) = static_cast<uint64_t>(ParseWhole(name, text, 0, 9e15));
      break;
    case SettingType::kFloat:
      *static_cast<float*>(field) = static_cast<float>(ParseReal(name, text, true));
      break;
    case SettingType::kDouble:
      *static_cast<double*>(field) = ParseReal(name, text, false);
      break;
    case SettingType::kText:
      *static_cast<std::string*>(field) = text;
      break;
    case SettingType::kWord: {
      const int value = ParseWord(name, text, row.words);
      std::memcpy(field, &value, sizeof(value));
      break;
    }
  }
}

// `match(row)` chooses the rows. Returns whether there were any.
template <typename Match>
bool SetMatching(std::span<const SettingsPart> parts, const std::string& name,
                 const std::string& value, const Match& match) {
  bool found = false;
  for (const SettingsPart& part : parts) {
    for (const Setting& row : part.table) {
      if (!match(row)) continue;
      found = true;
      SetValue(row, part.settings, name, value);
    }
  }
  return found;
}

std::string Suggestion(std::span<const SettingsPart> parts, std::string name) {
  if (name.starts_with(kExpert)) name.erase(0, kExpert.size());
  std::vector<std::string> bare;
  for (const SettingsPart& part : parts)
    for (const Setting& row : part.table) bare.push_back(row.name);
  const std::string nearest = NearestName(name, bare);
  for (const SettingsPart& part : parts)
    for (const Setting& row : part.table)
      if (row.name == nearest) return "; did you mean '" + FullName(row) + "'?";
  return "";
}

}  // namespace

void SetByName(std::span<const SettingsPart> parts, const std::string& name,
               const std::string& value, OldNames old) {
  const auto full = [&](const Setting& row) { return name == FullName(row); };
  if (SetMatching(parts, name, value, full)) return;
  const OldName renamed = FindOldName(name);
  if (renamed.dropped) {
    if (old == OldNames::kWarn)
      LogWarning("setting " + name + " no longer exists and has no effect");
    return;
  }
  const std::string now = renamed.now.empty() ? name : renamed.now;
  std::string current;
  const bool found = SetMatching(parts, name, value, [&](const Setting& row) {
    if (now != row.name) return false;
    current = FullName(row);
    return true;
  });
  if (!found) ThrowUsage("unknown setting '" + name + "'" + Suggestion(parts, name));
  if (old == OldNames::kWarn) {
    LogWarning("setting " + name + " is now called " + current +
               "; the old name is accepted in this version only");
  }
}

std::vector<std::pair<std::string, std::string>> AllByName(std::span<const SettingsPart> parts) {
  std::vector<std::pair<std::string, std::string>> all;
  for (const SettingsPart& part : parts)
    for (const Setting& row : part.table)
      all.push_back({FullName(row), FormatValue(row, part.settings)});
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return all;
}

}  // namespace alidade
