#include "program/arguments.h"

#include <CLI/CLI.hpp>

namespace alidade {
namespace {

std::vector<std::string> OptionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

const CLI::App* FindSubcommand(const CLI::App& app, const std::string& name,
                               std::vector<std::string>& names) {
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (sub->check_name(name)) return sub;
    names.push_back(sub->get_name());
  }
  return nullptr;
}

}  // namespace

void CheckNames(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CLI::App* command = &app;
  std::string path = app.get_name();
  bool may_be_subcommand = true;
  for (const std::string& argument : arguments) {
    if (argument == "--" || command->get_prefix_command()) return;
    if (argument.size() > 2 && argument.compare(0, 2, "--") == 0) {
      const std::string name = argument.substr(0, argument.find('='));
      const std::vector<std::string> known = OptionNames(*command);
      bool found = false;
      for (const std::string& option : known) found = found || option == name;
      if (!found) {
        ThrowUsage("unknown option " + name + " of `" + path + "`" + DidYouMean(name, known));
      }
      continue;
    }
    if (!may_be_subcommand || argument.empty() || argument[0] == '-') continue;
    std::vector<std::string> names;
    const CLI::App* sub = FindSubcommand(*command, argument, names);
    if (sub != nullptr) {
      command = sub;
      path += " " + argument;
    } else if (!names.empty()) {
      ThrowUsage("unknown command '" + argument + "' of `" + path + "`" +
                 DidYouMean(argument, names));
    } else {
      may_be_subcommand = false;  // the command's own arguments have begun
    }
  }
}

}  // namespace alidade
