#include "describe/markdown_page.h"

#include <algorithm>
#include <sstream>
#include <vector>

namespace alidade {
namespace {

// Text outside code: what Markdown would take for a tag, an emphasis or the end of a table's cell
// is escaped, except in `code`, where only the bar of a table is special.
std::string MarkdownText(const std::string& text) {
  std::string escaped;
  bool code = false;
  for (const char c : text) {
    if (c == '`') code = !code;
    if (c == '|' || (!code && (c == '<' || c == '*' || c == '_'))) escaped += '\\';
    escaped += c == '\n' ? ' ' : c;
  }
  return escaped;
}

std::string MarkdownCode(const std::string& text) {
  return "`" + MarkdownText("`" + text + "`").substr(1);
}

std::string UsageLine(const CommandText& command) {
  std::string line = command.path + " [OPTIONS]";
  for (const OptionText& option : command.options) {
    if (!option.positional) continue;
    const std::string word = option.names.front() + (option.repeats ? "..." : "");
    line += " " + (option.required ? word : "[" + word + "]");
  }
  return line + (command.commands.empty() ? "" : " COMMAND");
}

std::string OptionCell(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + name;
  if (option.takes_value && !option.positional && !option.placeholder.empty())
    names += " " + option.placeholder;
  return MarkdownCode(names) + (option.required && !option.positional ? ", required" : "");
}

void AddOptionTable(const CommandText& command, const std::string& heading, bool positional,
                    std::ostream& out) {
  bool begun = false;
  for (const OptionText& option : command.options) {
    if (option.positional != positional || (!positional && option.group != heading)) continue;
    if (!begun)
      out << "\n| "
          << (positional             ? std::string("argument")
              : heading == "Options" ? "option"
                                     : heading)
          << " | meaning |\n|---|---|\n";
    begun = true;
    out << "| " << OptionCell(option) << " | " << MarkdownText(option.help);
    if (!option.fallback.empty()) out << " Default: " << MarkdownCode(option.fallback) << ".";
    out << " |\n";
  }
}

// A help text as a sentence.
std::string Sentence(std::string text) {
  if (!text.empty() && text.back() == '.') text.pop_back();
  return MarkdownText(text) + ".";
}

void AddCommand(const CommandText& command, std::ostream& out) {
  out << "\n## " << command.path << "\n\n"
      << Sentence(command.help) << "\n\n```\n"
      << UsageLine(command) << "\n```\n";
  AddOptionTable(command, "", true, out);
  std::vector<std::string> groups;
  for (const OptionText& option : command.options)
    if (!option.positional && std::find(groups.begin(), groups.end(), option.group) == groups.end())
      groups.push_back(option.group);
  for (const std::string& group : groups) AddOptionTable(command, group, false, out);
  // Examples and notes are laid out by hand, for a terminal.
  const size_t first = command.footer.find_first_not_of('\n');
  if (first != std::string::npos) out << "\n```text\n" << command.footer.substr(first) << "\n```\n";
  for (const CommandText& sub : command.commands) AddCommand(sub, out);
}

}  // namespace

std::string MarkdownPage(const CommandText& program) {
  std::ostringstream out;
  out << "# Command line\n\n"
         "This page lists every command and option. `scripts/docs` generates it from the texts of\n"
         "`alidade COMMAND --help`; do not edit it.\n\n"
         "| command | what it does |\n|---|---|\n";
  for (const CommandText& command : program.commands) {
    std::string anchor = command.path;
    std::replace(anchor.begin(), anchor.end(), ' ', '-');
    out << "| [" << command.path << "](#" << anchor << ") | " << MarkdownText(command.help)
        << " |\n";
  }
  AddCommand(program, out);
  return out.str();
}

}  // namespace alidade
