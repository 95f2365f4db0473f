// `alidade settings`: what can be set, with value, range, unit and meaning.
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
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
    if (old.dropped) ThrowUsage("setting " + options.name + " no longer exists");
    ThrowUsage("there is no setting or group '" + options.name + "'" +
               (old.now.empty() ? DidYouMean(options.name, names)
                                : "; it is now called '" + old.now + "'"));
  }
  return chosen;
}

// Columns of the terminal; 100 if the output is a file or a pipe.
size_t OutputWidth() {
  constexpr size_t kUnknown = 100, kNarrowest = 60;
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUnknown;
  return std::max<size_t>(size.ws_col, kNarrowest);
}

// The words of `text` in lines of at most `width` bytes, all but the first one indented.
std::string Wrapped(const std::string& text, size_t width, size_t indent) {
  std::string wrapped;
  size_t used = 0;
  std::istringstream words(text);
  for (std::string word; words >> word; used += word.size()) {
    if (used > 0 && used + 1 + word.size() > width) {
      wrapped += "\n" + std::string(indent, ' ');
      used = 0;
    } else if (used > 0) {
      wrapped += ' ';
      ++used;
    }
    wrapped += word;
  }
  return wrapped;
}

// A line with name, value and range of each setting, and its meaning below.
void PrintTable(const std::vector<SettingInfo>& settings) {
  constexpr size_t kIndent = 4, kLongestColumn = 48;
  size_t name = 0, value = 0;
  for (const SettingInfo& info : settings) {
    name = std::max(name, std::min(info.name.size(), kLongestColumn));
    value = std::max(value, std::min(info.value.size(), kLongestColumn / 4));
  }
  const size_t width = OutputWidth();
  for (const SettingInfo& info : settings) {
    const std::string range =
        info.range + (info.range.empty() || info.unit.empty() ? "" : " ") + info.unit;
    std::printf("%-*s  %-*s%s%s\n", static_cast<int>(name), info.name.c_str(),
                range.empty() ? 0 : static_cast<int>(value), info.value.c_str(),
                range.empty() ? "" : "  ", range.c_str());
    std::printf("%*s%s\n", static_cast<int>(kIndent), "",
                Wrapped(info.meaning, width - kIndent, kIndent).c_str());
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
      app.add_subcommand("settings", "List the settings with value, range, unit and meaning");
  const auto options = std::make_shared<SettingsOptions>();
  command->add_option("NAME", options->name, "Setting, or group such as tracker")
      ->type_name("NAME");
  command->add_flag("--all", options->all, "Also list expert settings");
  command->add_flag("--json", options->as_json, "Print JSON instead of a table");
  command->add_option("--profile", options->run.profile, "Show the values of a profile")
      ->type_name("desktop|phone");
  command->add_option("--config", options->run.config, "Show the values after this YAML file")
      ->type_name("FILE");
  command
      ->add_option("--set", options->run.settings,
                   "Show the values after this change; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);  // one value each, so that NAME may follow
  command->add_flag("--markdown", options->markdown, "Print docs/reference/settings.md")->group("");
  command->footer(
      "\nPublic settings are stable. Those that begin with `expert.` may change in any "
      "version.\n\nExamples:\n  alidade settings                            public settings\n  "
      "alidade settings tracker                    all settings of a group\n  alidade settings "
      "loop.min_found             one setting\n  alidade settings --config mine.yaml         with "
      "the values of a file");
  command->callback(
      [options, &action] { action = [options] { return SettingsCommand(*options); }; });
}

}  // namespace alidade
