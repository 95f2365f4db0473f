#include "alidade/run/setup/setting_list.h"

#include <algorithm>
#include <map>

namespace alidade {
namespace {

std::string RangeOf(const Setting& row) {
  if (row.type == SettingType::kBool) return "0 or 1";
  if (row.type != SettingType::kWord) return RangeInWords(row.range);
  std::string words;
  for (int i = 0; row.words[i] != nullptr; ++i)
    words += (i > 0 ? ", " : "") + std::string(row.words[i]);
  return words;
}

// The group of a setting: "tracker" for "tracker.extractor.features".
std::string GroupOf(const SettingInfo& info) {
  const std::string bare =
      info.is_public ? info.name : info.name.substr(std::string("expert.").size());
  const size_t dot = bare.find('.');
  return dot == std::string::npos ? "general" : bare.substr(0, dot);
}

std::string InTable(const std::string& text) { return text.empty() ? "" : "`" + text + "`"; }

std::string TableOf(const std::vector<SettingInfo>& settings, bool is_public) {
  std::vector<std::string> groups;
  for (const SettingInfo& info : settings) {
    if (info.is_public == is_public &&
        std::find(groups.begin(), groups.end(), GroupOf(info)) == groups.end())
      groups.push_back(GroupOf(info));
  }
  std::string text;
  for (const std::string& group : groups) {
    text += "\n### " + std::string(is_public ? "" : "expert: ") + group +
            "\n\n| name | default | range | unit | meaning |\n|---|---|---|---|---|\n";
    for (const SettingInfo& info : settings) {
      if (info.is_public != is_public || GroupOf(info) != group) continue;
      const bool list = info.fallback.find(',') != std::string::npos;
      text += "| `" + info.name + "` | " + (list ? "a list" : InTable(info.fallback)) + " | " +
              info.range + " | " + info.unit + " | " + info.meaning + " |\n";
    }
  }
  return text;
}

}  // namespace

std::vector<SettingInfo> ListSettings(const RunSettings& settings) {
  RunSettings used = settings, usual;
  const std::vector<SettingsPart> parts = used.Parts(), usual_parts = usual.Parts();
  std::vector<SettingInfo> list;
  std::map<std::string, size_t> at;
  for (size_t i = 0; i < parts.size(); ++i) {
    for (const Setting& row : parts[i].table) {
      const auto [found, is_new] = at.insert({row.name, list.size()});
      if (is_new) {
        list.push_back({FullName(row), FormatValue(row, parts[i].settings),
                        FormatValue(row, usual_parts[i].settings), "", RangeOf(row), "",
                        !row.expert});
      }
      SettingInfo& info = list[found->second];
      if (*row.meaning == 0) continue;
      info.unit = row.unit;
      info.meaning = row.meaning;
    }
  }
  std::stable_sort(list.begin(), list.end(), [](const SettingInfo& a, const SettingInfo& b) {
    return a.is_public > b.is_public;
  });
  return list;
}

std::string SettingsPage(const std::vector<SettingInfo>& settings) {
  const auto is_public = [](const SettingInfo& info) { return info.is_public; };
  const auto count = std::count_if(settings.begin(), settings.end(), is_public);
  return "# Settings\n\n"
         "This page lists all settings. `alidade settings --markdown` generates it; do not edit "
         "it.\n\n"
         "A setting is given with `--set NAME=VALUE`, in a YAML file with `--config FILE`, in "
         "Python "
         "with\n`settings={\"NAME\": VALUE}`. The later one holds: profile, file, `--set`. "
         "`alidade "
         "settings NAME` shows one, or a group.\n\n## Public settings\n\nThese " +
         std::to_string(count) +
         " are stable: a new name would be accepted beside the old one for a version.\n" +
         TableOf(settings, true) + "\n## Expert settings\n\nThese " +
         std::to_string(static_cast<long>(settings.size()) - count) +
         " may change or go in any version. Their names begin with `expert.`.\n" +
         TableOf(settings, false);
}

}  // namespace alidade
