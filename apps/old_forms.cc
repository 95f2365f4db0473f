#include "old_forms.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>

#include "alidade/base/log.h"

namespace alidade {
namespace {

// A flag that once had an optional value.
struct OldFlag {
  const char* name;
  const char* value_option;  // takes the value now
  const char* value;         // as the messages call it
  bool number;               // the value was one
  bool flag_stays;           // beside the option with the value
};

constexpr std::array<OldFlag, 2> kOldFlags = {
    OldFlag{"--viewer", "--port", "PORT", true, true},
    OldFlag{"--record", "--record-to", "FILE", false, false},
};

const OldFlag* FindFlag(const CLI::App& command, const std::string& word) {
  for (const OldFlag& flag : kOldFlags) {
    if (word == flag.name && command.get_option_no_throw(flag.value_option) != nullptr)
      return &flag;
  }
  return nullptr;
}

const CLI::App* FindSubcommand(const CLI::App& command, const std::string& name) {
  const auto all = command.get_subcommands([](const CLI::App*) { return true; });
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const CLI::App* sub) { return sub->check_name(name); });
  return found == all.end() ? nullptr : *found;
}

bool CanBeValue(const OldFlag& flag, const std::string& word) {
  return !flag.number || std::all_of(word.begin(), word.end(),
                                     [](unsigned char c) { return c >= '0' && c <= '9'; });
}

// What a flag with its value is now.
std::vector<std::string> NewForm(const OldFlag& flag, const std::string& value) {
  const std::string option = flag.value_option, name = flag.name;
  LogWarning("`" + name + " " + flag.value + "` is now `" + (flag.flag_stays ? name + " " : "") +
             option + " " + flag.value + "`; the old form is accepted in this version only");
  if (value.empty()) return {name};
  if (flag.flag_stays) return {name, option, value};
  return {option, value};
}

struct Behind {  // a word behind a flag
  size_t index = 0;
  const OldFlag* flag = nullptr;
};

// Where the words behind a flag are that could be its value; at most as many as there are words too
// many for one SOURCE.
std::vector<Behind> OldValues(const CLI::App& command, const std::vector<std::string>& words,
                              size_t first) {
  std::vector<Behind> values;
  size_t positional = 0;
  for (size_t i = first; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--") {
      positional += words.size() - i - 1;
      break;
    }
    if (word.size() > 1 && word[0] == '-') {
      const CLI::Option* option = command.get_option_no_throw(word);
      if (option != nullptr && option->get_items_expected_max() > 0) ++i;  // the next is its value
      continue;
    }
    ++positional;
    const OldFlag* flag = i > first ? FindFlag(command, words[i - 1]) : nullptr;
    if (flag != nullptr && CanBeValue(*flag, word)) values.push_back({i, flag});
  }
  const size_t too_many = positional > 0 ? positional - 1 : 0;
  if (values.size() > too_many) values.resize(too_many);
  return values;
}

}  // namespace

std::vector<std::string> WithoutOldForms(const CLI::App& command, std::vector<std::string> words) {
  const CLI::App* sub = words.empty() ? nullptr : FindSubcommand(command, words[0]);
  const size_t first = sub != nullptr ? 1 : 0;
  if (sub == nullptr) sub = &command;
  const std::vector<Behind> values = OldValues(*sub, words, first);
  const auto value_at = [&](size_t i) {
    return std::find_if(values.begin(), values.end(),
                        [&](const Behind& b) { return b.index == i; });
  };
  std::vector<std::string> renewed;
  for (size_t i = 0; i < words.size(); ++i) {
    const size_t equals = words[i].find('=');
    const OldFlag* flag = FindFlag(*sub, words[i].substr(0, equals));
    std::vector<std::string> now = {words[i]};
    if (flag != nullptr && equals != std::string::npos) {
      now = NewForm(*flag, words[i].substr(equals + 1));
    } else if (value_at(i + 1) != values.end()) {
      now = NewForm(*flag, words[++i]);
    }
    renewed.insert(renewed.end(), now.begin(), now.end());
  }
  return renewed;
}

}  // namespace alidade
