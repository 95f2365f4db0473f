#include <algorithm>
#include <sstream>

#include "alidade/base/shell_quoted.h"
#include "describe/completion.h"

namespace alidade {
namespace {

// "alidade evaluate ate" → _alidade_evaluate_ate
std::string ZshFunction(const std::string& path) {
  std::string name = "_" + path;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

// Escapes a help text inside the [] of a specification, where brackets and colons are special.
std::string ZshEscaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string ZshAction(const OptionText& option) {
  const std::vector<std::string> words = WordsOf(option);
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : " ") + word;
  if (option.placeholder == "NAME=VALUE") return "_values -S '' setting $_alidade_settings";
  if (!words.empty() && IsPath(option))
    return "_alternative \"words:word:(" + list + ")\" \"files:file:_files\"";
  if (!words.empty()) return "(" + list + ")";
  return IsPath(option) ? "_files" : " ";
}

std::string ZshValue(const OptionText& option) {
  const std::string message = option.placeholder.empty() ? "value" : option.placeholder;
  return ":" + ZshEscaped(message) + ":" + ZshAction(option);
}

void AddZshOption(const OptionText& option, std::ostream& out) {
  const std::string help = "[" + ZshEscaped(ShortHelp(option.help)) + "]";
  std::string others;  // after one of the names, none is offered again
  for (const std::string& name : option.names) others += (others.empty() ? "" : " ") + name;
  for (const std::string& name : option.names) {
    std::string text = option.repeats ? "*" : "(" + others + ")";
    text += name;
    if (option.takes_value && name.size() > 2) text += '=';
    text += help;
    if (option.takes_value) text += ZshValue(option);
    out << "    " << ShellQuoted(text) << " \\\n";
  }
}

void AddZshFunction(const CommandText& command, std::ostream& out) {
  const bool nested = !command.commands.empty();
  out << ZshFunction(command.path) << "() {\n";
  if (nested) {
    out << "  local curcontext=$curcontext state line\n  local -a commands\n";
  }
  out << "  _arguments -S " << (nested ? "-C " : "") << "\\\n";
  int place = 0;
  for (const OptionText& option : command.options) {
    if (!option.positional) {
      AddZshOption(option, out);
      continue;
    }
    const std::string where = option.repeats ? "*" : std::to_string(++place);
    out << "    "
        << ShellQuoted(where + ":" + ZshEscaped(option.names.front()) + ":" + ZshAction(option))
        << " \\\n";
  }
  if (!nested) {
    out << "    && return 0\n}\n\n";
    return;
  }
  out << "    '1: :->command' '*:: :->arguments' && return 0\n"
         "  case $state in\n"
         "  command)\n"
         "    commands=(\n";
  for (const CommandText& sub : command.commands)
    out << "      " << ShellQuoted(sub.name + ":" + ShortHelp(sub.help)) << "\n";
  out << "    )\n"
         "    _describe -t commands command commands\n"
         "    ;;\n"
         "  arguments)\n"
         "    case $words[1] in\n";
  for (const CommandText& sub : command.commands)
    out << "    " << sub.name << ") " << ZshFunction(sub.path) << " ;;\n";
  out << "    esac\n"
         "    ;;\n"
         "  esac\n"
         "}\n\n";
  for (const CommandText& sub : command.commands) AddZshFunction(sub, out);
}

}  // namespace

std::string ZshCompletion(const CommandText& program) {
  OptionText settings;
  settings.placeholder = "NAME=VALUE";
  std::ostringstream out;
  out << "#compdef alidade\n# Completes `alidade` in zsh. Made by `alidade completion zsh`.\n\n"
         "typeset -ga _alidade_settings=(\n";
  for (const std::string& word : WordsOf(settings)) out << "  " << ShellQuoted(word) << "\n";
  out << ")\n\n";
  AddZshFunction(program, out);
  out << "if [ \"$funcstack[1]\" = _alidade ]; then\n"
         "  _alidade \"$@\"\n"
         "else\n"
         "  compdef _alidade alidade\n"
         "fi\n";
  return out.str();
}

}  // namespace alidade
