#include "describe/man_page.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace alidade {
namespace {

// Text as roff has it: no word of it is taken for a command.
std::string Roff(const std::string& text) {
  std::string roff;
  for (const char c : text) {
    const bool begins = roff.empty() || roff.back() == '\n';
    if (begins && (c == '.' || c == '\'')) roff += "\\&";
    if (c == '\\') {
      roff += "\\e";
    } else if (c == '-') {
      roff += "\\-";  // a minus, which can be copied
    } else if (c == '\'') {
      roff += "\\(aq";
    } else if (c == '`') {
      roff += "\\(ga";
    } else {
      roff += c;
    }
  }
  return roff;
}

std::string Bold(const std::string& text) { return "\\fB" + Roff(text) + "\\fR"; }
std::string Italic(const std::string& text) { return "\\fI" + Roff(text) + "\\fR"; }

// "alidade evaluate ate" → alidade-evaluate-ate
std::string ManPageOf(const std::string& path) {
  std::string page = path;
  std::replace(page.begin(), page.end(), ' ', '-');
  return page;
}

std::string SeePage(const std::string& path) { return Bold(ManPageOf(path)) + "(1)"; }

void AddManSynopsis(const CommandText& command, std::ostream& out) {
  out << ".SH SYNOPSIS\n" << Bold(command.path);
  const auto named = std::any_of(command.options.begin(), command.options.end(),
                                 [](const OptionText& option) { return !option.positional; });
  if (named) out << " [" << Italic("OPTIONS") << "]";
  for (const OptionText& option : command.options) {
    if (!option.positional) continue;
    const std::string word = Italic(option.names.front()) + (option.repeats ? " ..." : "");
    out << " " << (option.required ? word : "[" + word + "]");
  }
  if (!command.commands.empty()) out << " " << Italic("COMMAND") << " ...";
  out << "\n";
}

void AddManOption(const OptionText& option, std::ostream& out) {
  out << ".TP\n";
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + (option.positional ? Italic(name) : Bold(name));
  out << names;
  if (option.takes_value && !option.placeholder.empty()) {
    const std::string value = Italic(option.placeholder);
    out << " " << value;
  }
  if (!option.fallback.empty()) out << " (" << Roff(option.fallback) << ")";
  if (option.repeats) out << " ...";
  out << "\n" << Roff(option.help) << "\n";
}

void AddManOptions(const CommandText& command, std::ostream& out) {
  std::vector<std::string> groups;
  for (const OptionText& option : command.options) {
    const std::string group = option.positional ? "Arguments" : option.group;
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  std::stable_partition(groups.begin(), groups.end(),
                        [](const std::string& group) { return group == "Arguments"; });
  for (const std::string& group : groups) {
    std::string heading = Roff(group);
    std::transform(heading.begin(), heading.end(), heading.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    out << ".SH " << heading << "\n";
    for (const OptionText& option : command.options)
      if ((option.positional ? "Arguments" : option.group) == group) AddManOption(option, out);
  }
}

void AddManCommands(const CommandText& command, std::ostream& out) {
  if (command.commands.empty()) return;
  out << ".SH COMMANDS\n";
  for (const CommandText& sub : command.commands)
    out << ".TP\n" << SeePage(sub.path) << "\n" << Roff(sub.help) << "\n";
}

// Paragraphs; lines that are indented are shown as they are, "Examples:" and the like are headings.
void AddManFooter(const std::string& footer, std::ostream& out) {
  std::istringstream lines(footer);
  bool shown = false;
  const auto show = [&](bool on) {
    if (on != shown) out << (on ? ".EX\n" : ".EE\n");
    shown = on;
  };
  out << ".SH NOTES\n";
  for (std::string line; std::getline(lines, line);) {
    const bool indented = line.rfind("  ", 0) == 0;
    show(indented);
    if (line == "Examples:") {
      out << ".SH EXAMPLES\n";
    } else if (line.rfind("Exit status: ", 0) == 0) {
      out << ".SH EXIT STATUS\n" << Roff(line.substr(13)) << "\n";
    } else if (line.empty()) {
      out << ".PP\n";
    } else {
      out << Roff(indented ? line.substr(2) : line) << "\n";
    }
  }
  show(false);
}

// Headings that nothing stands under, and paragraphs that begin or end nothing, are warned of by
// readers of manual pages.
std::string TidiedPage(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const bool heading = line.rfind(".SH ", 0) == 0;
    if (heading || line == ".PP") {
      while (!lines.empty() &&
             (lines.back() == ".PP" || (heading && lines.back().rfind(".SH ", 0) == 0)))
        lines.pop_back();
    }
    if (line == ".PP" && (lines.empty() || lines.back().rfind(".SH ", 0) == 0)) continue;
    lines.push_back(line);
  }
  std::string tidy;
  for (const std::string& line : lines) tidy += line + "\n";
  return tidy;
}

// What `man -k` shows: without the program's name and a full stop.
std::string ManSummary(std::string help) {
  const std::string name = "Alidade: ";
  if (help.rfind(name, 0) == 0) help = help.substr(name.size());
  if (!help.empty() && help.back() == '.') help.pop_back();
  return help;
}

void AddManPages(const CommandText& command, const CommandText* parent, const std::string& version,
                 std::vector<ManPage>& pages) {
  std::ostringstream out;
  std::string title = ManPageOf(command.path);
  std::transform(title.begin(), title.end(), title.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  out << ".\\\" Made from the program's own --help: `alidade man-pages`.\n"
      << ".TH " << Roff(title) << " 1 \"\" \"" << Roff(version) << "\" \"User Commands\"\n"
      << ".SH NAME\n"
      << Roff(ManPageOf(command.path)) << " \\- " << Roff(ManSummary(command.help)) << "\n";
  AddManSynopsis(command, out);
  AddManCommands(command, out);
  AddManOptions(command, out);
  AddManFooter(command.footer, out);
  out << ".SH SEE ALSO\n";
  std::string also;
  const auto see = [&](const std::string& path) {
    also += (also.empty() ? "" : ",\n") + SeePage(path);
  };
  if (parent != nullptr) {
    if (parent->path != "alidade") see("alidade");
    see(parent->path);
    for (const CommandText& sibling : parent->commands)
      if (sibling.path != command.path) see(sibling.path);
  }
  for (const CommandText& sub : command.commands) see(sub.path);
  out << also << "\n";
  pages.push_back({ManPageOf(command.path) + ".1", TidiedPage(out.str())});
  for (const CommandText& sub : command.commands) AddManPages(sub, &command, version, pages);
}

}  // namespace

std::vector<ManPage> ManPages(const CommandText& program, const std::string& version) {
  std::vector<ManPage> pages;
  AddManPages(program, nullptr, version, pages);
  return pages;
}

}  // namespace alidade
