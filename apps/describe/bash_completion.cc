#include <sstream>

#include "alidade/base/shell_quoted.h"
#include "describe/completion.h"

namespace alidade {
namespace {

std::string BashWords(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

// Commands, as patterns of `case`: "alidade run" | "alidade evaluate" | …
void AddBashPaths(const CommandText& command, std::string& paths) {
  for (const CommandText& sub : command.commands) {
    paths += (paths.empty() ? "" : " | ") + ShellQuoted(sub.path);
    AddBashPaths(sub, paths);
  }
}

std::string BashOffers(const std::vector<std::string>& words, bool path) {
  std::string does;
  if (!words.empty()) does += "words=" + ShellQuoted(BashWords(words)) + " ";
  if (path) does += "files=1 ";
  return does.empty() ? "" : does + ";;";
}

// Completes the value of an option.
void AddBashValues(const CommandText& command, std::ostream& out) {
  for (const OptionText& option : command.options) {
    if (option.positional || !option.takes_value) continue;
    std::string pattern;
    for (const std::string& name : option.names)
      pattern += (pattern.empty() ? "" : " | ") + ShellQuoted(command.path + " " + name);
    std::string does = BashOffers(WordsOf(option), IsPath(option));
    // Values without known words get no proposals.
    out << "    " << pattern << ") " << (does.empty() ? ";;" : does) << "\n";
  }
  for (const CommandText& sub : command.commands) AddBashValues(sub, out);
}

// Completes the words after a command.
void AddBashCommand(const CommandText& command, std::ostream& out) {
  std::vector<std::string> options, words;
  bool path = false;
  for (const OptionText& option : command.options) {
    if (!option.positional) {
      options.insert(options.end(), option.names.begin(), option.names.end());
      continue;
    }
    for (const std::string& word : WordsOf(option)) words.push_back(word);
    path = path || IsPath(option);
  }
  for (const CommandText& sub : command.commands) words.push_back(sub.name);
  out << "    " << ShellQuoted(command.path) << ") options=" << ShellQuoted(BashWords(options))
      << " " << (words.empty() && !path ? ";;" : BashOffers(words, path)) << "\n";
  for (const CommandText& sub : command.commands) AddBashCommand(sub, out);
}

}  // namespace

std::string BashCompletion(const CommandText& program) {
  std::string paths;
  AddBashPaths(program, paths);
  std::ostringstream out;
  out << "# Completes `alidade` in bash. Made by `alidade completion bash`.\n"
         "_alidade() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}\n"
         "  local command=alidade word index words= options= files=\n"
         "  # bash takes --name=value for three words.\n"
         "  [ \"$current\" != = ] || current=\n"
         "  [ \"$previous\" != = ] || previous=${COMP_WORDS[COMP_CWORD - 2]}\n"
         "  for ((index = 1; index < COMP_CWORD; ++index)); do\n"
         "    word=${COMP_WORDS[index]}\n"
         "    case \"$command $word\" in\n"
         "    "
      << paths
      << ") command=\"$command $word\" ;;\n"
         "    esac\n"
         "  done\n"
         "  COMPREPLY=()\n"
         "  case \"$command $previous\" in\n";
  AddBashValues(program, out);
  out << "  *)\n"
         "    case \"$command\" in\n";
  AddBashCommand(program, out);
  out << "    esac\n"
         "    case \"$current\" in -*) words=$options files= ;; esac\n"
         "    ;;\n"
         "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
         "  case \"${COMPREPLY[*]}\" in *=) compopt -o nospace 2>/dev/null ;; esac\n"
         "  if [ -n \"$files\" ]; then\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- \"$current\")\n"
         "  fi\n"
         "}\n"
         "complete -F _alidade alidade\n";
  return out.str();
}

}  // namespace alidade
