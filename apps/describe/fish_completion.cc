#include <sstream>

#include "describe/completion.h"

namespace alidade {
namespace {

// fish knows two escapes inside single quotes.
std::string FishQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "'";
}

void AddFishPaths(const CommandText& command, std::string& paths) {
  for (const CommandText& sub : command.commands) {
    paths += " " + FishQuoted(sub.path);
    AddFishPaths(sub, paths);
  }
}

// The part of `complete` that says what values there are.
std::string FishValues(const OptionText& option) {
  std::string list;
  for (const std::string& word : WordsOf(option)) list += (list.empty() ? "" : " ") + word;
  std::string text = IsPath(option) ? " -F" : "";
  if (!list.empty()) text += " -a " + FishQuoted(list);
  return text;
}

void AddFishCommand(const CommandText& command, std::ostream& out) {
  const std::string start = "complete -c alidade -n " + FishQuoted("__alidade_at " + command.path);
  for (const CommandText& sub : command.commands)
    out << start << " -a " << sub.name << " -d " << FishQuoted(ShortHelp(sub.help)) << "\n";
  for (const OptionText& option : command.options) {
    if (option.positional) {
      const std::string values = FishValues(option);
      if (!values.empty())
        out << start << values << " -d " << FishQuoted(option.names.front()) << "\n";
      continue;
    }
    out << start;
    for (const std::string& name : option.names)
      out << (name.size() > 2 ? " -l " + name.substr(2) : " -s " + name.substr(1));
    if (option.takes_value) out << (IsPath(option) ? " -r" : " -x");
    if (option.takes_value) out << FishValues(option);
    out << " -d " << FishQuoted(ShortHelp(option.help)) << "\n";
  }
  for (const CommandText& sub : command.commands) AddFishCommand(sub, out);
}

}  // namespace

std::string FishCompletion(const CommandText& program) {
  std::string paths;
  AddFishPaths(program, paths);
  std::ostringstream out;
  out << "# Completes `alidade` in fish. Made by `alidade completion fish`.\n"
         "function __alidade_at --description 'Whether this is the command being typed'\n"
         "  set -l command alidade\n"
         "  for word in (commandline -opc)[2..]\n"
         "    switch \"$command $word\"\n"
         "      case"
      << paths
      << "\n"
         "        set command \"$command $word\"\n"
         "    end\n"
         "  end\n"
         "  test \"$command\" = \"$argv\"\n"
         "end\n\n"
         "complete -c alidade -f\n";
  AddFishCommand(program, out);
  return out.str();
}

}  // namespace alidade
