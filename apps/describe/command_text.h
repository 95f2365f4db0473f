// The command line as plain data, read from CLI11's tree of commands.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace alidade {

struct OptionText {
  std::vector<std::string> names;  // "-h", "--help"; the name of a positional argument: "SOURCE"
  bool positional = false;
  bool required = false;
  bool repeats = false;      // may occur, or takes values, more than once
  bool takes_value = false;  // false: a flag
  std::string placeholder;   // name of the value: "FILE", "mono|stereo|rgbd"
  std::string fallback;      // default value; empty: not stated
  std::string help;
  std::string group;  // heading in the help
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

// The possible words of a value: the lower-case words of "realtime|max|FPS"; for NAME=VALUE all
// settings with '='.
std::vector<std::string> WordsOf(const OptionText& option);
// Whether the value is a path: FILE, FOLDER or PATH, possibly among other words.
bool IsPath(const OptionText& option);

}  // namespace alidade
