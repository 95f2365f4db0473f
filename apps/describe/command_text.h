// The command line as plain data, read from CLI11's tree of commands.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace alidade {

struct OptionText {
  std::vector<std::string> names;  // "-h", "--help"; of a positional one its name: "SOURCE"
  bool positional = false;
  bool required = false;
  bool repeats = false;      // may be given, or goes on, more than once
  bool takes_value = false;  // false: a flag
  std::string placeholder;   // what the value is called: "FILE", "mono|stereo|rgbd"
  std::string fallback;      // what it is by default; empty: not said
  std::string help;
  std::string group;  // heading it stands under
};

struct CommandText {
  std::string path;  // "alidade evaluate ate"
  std::string name;  // "ate"
  std::string help;
  std::string footer;  // examples and more
  std::vector<OptionText> options;
  std::vector<CommandText> commands;
};

// Hidden commands and options (group "") are left out.
CommandText DescribeCommand(const CLI::App& app, const std::string& path);

// The words a value is one of: of "realtime|max|FPS" the lower-case ones, of NAME=VALUE every
// setting, with its '='.
std::vector<std::string> WordsOf(const OptionText& option);
// Whether it names files or folders: FILE, FOLDER, PATH, or one of them among other words.
bool IsPath(const OptionText& option);

}  // namespace alidade
