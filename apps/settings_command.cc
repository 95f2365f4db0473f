// `alidade settings`: what can be set, with value, range, unit and meaning.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"
#include "alidade/run/setup/options.h"
#include "alidade/run/setup/setting_list.h"
#include "alidade/system/setting_old_names.h"
#include "commands.h"

namespace alidade {
namespace {

struct SettingsOptions {
  std::string name;
  RunOptions run;  // profile, config and settings
  bool all = false, as_json = false, markdown = false;
};

// Those of the name or group; all of them for an empty one. "expert." may be left out.
std::vector<SettingInfo> Chosen(const std::vector<SettingInfo>& all,
                                const SettingsOptions& options) {
  std::vector<SettingInfo> chosen;
  std::vector<std::string> names;
  for (const SettingInfo& info : all) {
    const std::string bare = info.name.substr(info.is_public ? 0 : std::string("expert.").size());
    const auto fits = [&](const std::string& name) {
      return name == options.name || name.starts_with(options.name + ".");
    };
    names.push_back(bare);  // nearer to what people type than the full name
    if (options.name.empty() ? options.all || info.is_public : fits(info.name) || fits(bare))
      chosen.push_back(info);
  }
  if (chosen.empty()) {
    const OldName old = FindOldName(options.name);
    if (old.dropped) ThrowUsage("setting " + options.name + " has no name any more");
    ThrowUsage("no setting or group is called '" + options.name + "'" +
               (old.now.empty() ? DidYouMean(options.name, names)
                                : "; it is now called '" + old.now + "'"));
  }
  return chosen;
}

void PrintTable(const std::vector<SettingInfo>& settings) {
  constexpr size_t kWidest = 20;  // columns of a value; lists of classes are longer
  size_t name = 0, value = 0, range = 0;
  const auto with_unit = [](const SettingInfo& info) {
    return info.range + (info.range.empty() || info.unit.empty() ? "" : " ") + info.unit;
  };
  for (const SettingInfo& info : settings) {
    name = std::max(name, info.name.size());
    value = std::max(value, std::min(info.value.size(), kWidest));
    range = std::max(range, with_unit(info).size());
  }
  for (const SettingInfo& info : settings) {
    std::printf("%-*s  %-*s  %-*s  %s\n", static_cast<int>(name), info.name.c_str(),
                static_cast<int>(value), info.value.c_str(), static_cast<int>(range),
                with_unit(info).c_str(), info.meaning.c_str());
  }
}

void PrintJson(const std::vector<SettingInfo>& settings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const SettingInfo& info : settings) {
    list.push_back({{"name", info.name},
                    {"value", info.value},
                    {"default", info.fallback},
                    {"unit", info.unit},
                    {"range", info.range},
                    {"meaning", info.meaning},
                    {"public", info.is_public}});
  }
  std::printf("%s\n", list.dump(2).c_str());
}

int SettingsCommand(const SettingsOptions& options) {
  const RunSettings used = SettingsFrom(options.run);
  if (options.markdown) {
    const std::string page = SettingsPage(ListSettings(used));
    std::fwrite(page.data(), 1, page.size(), stdout);
    return 0;
  }
  const std::vector<SettingInfo> chosen = Chosen(ListSettings(used), options);
  options.as_json ? PrintJson(chosen) : PrintTable(chosen);
  return 0;
}

}  // namespace

void AddSettingsCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("settings", "What can be set, with value, range, unit and meaning");
  const auto options = std::make_shared<SettingsOptions>();
  command->add_option("NAME", options->name, "A setting, or a group such as tracker")
      ->type_name("NAME");
  command->add_flag("--all", options->all, "Expert settings as well");
  command->add_flag("--json", options->as_json, "Print JSON instead of a table");
  command->add_option("--profile", options->run.profile, "Values of a profile")
      ->type_name("desktop|phone");
  command->add_option("--config", options->run.config, "Values with a YAML file of settings")
      ->type_name("FILE");
  command->add_option("--set", options->run.settings, "Values with one setting changed; repeatable")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);  // one value each, so that NAME may follow
  command->add_flag("--markdown", options->markdown, "Print docs/reference/settings.md")->group("");
  command->footer(
      "\nPublic settings are stable. Those that begin with `expert.` may change in any version.\n"
      "\nExamples:\n"
      "  alidade settings                            the public ones\n"
      "  alidade settings tracker                    all of a group\n"
      "  alidade settings loop.min_found             one\n"
      "  alidade settings --config mine.yaml         with the values of a file");
  command->callback(
      [options, &action] { action = [options] { return SettingsCommand(*options); }; });
}

}  // namespace alidade
