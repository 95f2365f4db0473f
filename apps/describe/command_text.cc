#include "describe/command_text.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>

#include "alidade/run/setup/run_settings.h"

namespace alidade {
namespace {

std::vector<std::string> PlaceholderParts(const std::string& placeholder) {
  std::vector<std::string> parts;
  std::istringstream stream(placeholder.substr(0, placeholder.find(' ')));
  for (std::string part; std::getline(stream, part, '|');) parts.push_back(part);
  return parts;
}

bool IsPlainWord(const std::string& part) {
  return !part.empty() && std::none_of(part.begin(), part.end(), [](unsigned char c) {
    return std::isupper(c) != 0 || (std::isalnum(c) == 0 && c != '-' && c != '_');
  });
}

OptionText DescribeOption(const CLI::Option& option) {
  OptionText text;
  text.positional = !option.nonpositional();
  if (text.positional) {
    text.names = {option.get_name(true)};
  } else {
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  }
  text.required = option.get_required();
  text.takes_value = option.get_type_size() != 0;
  text.repeats =
      text.takes_value && (option.get_expected_max() >= CLI::detail::expected_max_vector_size ||
                           option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll);
  if (text.takes_value) {
    text.placeholder = option.get_type_name();
    text.fallback = option.get_default_str();
  }
  text.help = option.get_description();
  text.group = option.get_group();
  return text;
}

}  // namespace

CommandText DescribeCommand(const CLI::App& app, const std::string& path) {
  CommandText text;
  text.path = path;
  text.name = app.get_name();
  text.help = app.get_description();
  text.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) text.options.push_back(DescribeOption(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_group().empty()) continue;
    text.commands.push_back(DescribeCommand(*command, path + " " + command->get_name()));
  }
  return text;
}

std::vector<std::string> WordsOf(const OptionText& option) {
  std::vector<std::string> words;
  if (option.placeholder == "NAME=VALUE") {
    for (const auto& setting : RunSettings().All()) words.push_back(setting.first + "=");
    return words;
  }
  const std::vector<std::string> parts = PlaceholderParts(option.placeholder);
  if (parts.size() < 2) return words;
  std::copy_if(parts.begin(), parts.end(), std::back_inserter(words), IsPlainWord);
  return words;
}

bool IsPath(const OptionText& option) {
  const std::vector<std::string> parts = PlaceholderParts(option.placeholder);
  return std::any_of(parts.begin(), parts.end(), [](const std::string& part) {
    return part == "FILE" || part == "FOLDER" || part == "PATH";
  });
}

}  // namespace alidade
