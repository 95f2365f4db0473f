// Runs the real alidade program, as a user would, and collects what it says.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "support/temp_folder.h"

namespace alidade {

struct ProgramResult {
  int status = -1;       // exit status; -1 when a signal ended it
  std::string out, err;  // stdout, stderr
};

inline std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// `while_running` is given the process id, to send it signals. `in`: the folder the program starts
// in.
inline ProgramResult RunAlidade(const std::vector<std::string>& arguments,
                                const std::function<void(pid_t)>& while_running = nullptr,
                                const std::string& in = ".") {
  const TempFolder folder;
  const std::string out = folder / "out", err = folder / "err";
  std::vector<std::string> words = {ALIDADE_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t child = fork();
  if (child == 0) {
    dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    dup2(open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    if (chdir(in.c_str()) != 0) _exit(127);
    execv(argv[0], argv.data());
    _exit(127);
  }
  if (while_running) while_running(child);
  int state = 0;
  waitpid(child, &state, 0);
  ProgramResult result;
  if (WIFEXITED(state)) result.status = WEXITSTATUS(state);
  result.out = ReadText(out);
  result.err = ReadText(err);
  return result;
}

// How many lines a text has: an error is one.
inline int LineCount(const std::string& text) {
  int lines = 0;
  for (const char c : text) lines += c == '\n';
  return lines;
}

}  // namespace alidade
