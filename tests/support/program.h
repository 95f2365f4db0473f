// Runs the real alidade program as a user would, and captures its output.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "support/read_text.h"
#include "support/temp_folder.h"

namespace alidade {

struct ProgramResult {
  int status = -1;       // exit status; -1: ended by a signal
  std::string out, err;  // stdout, stderr
};

// `while_running` is called with the process id, to send signals. `in`: the working folder.
inline ProgramResult RunProgram(const std::string& program,
                                const std::vector<std::string>& arguments,
                                const std::function<void(pid_t)>& while_running = nullptr,
                                const std::string& in = ".") {
  const TempFolder folder;
  const std::string out = folder / "out", err = folder / "err";
  std::vector<std::string> words = {program};
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

inline ProgramResult RunAlidade(const std::vector<std::string>& arguments,
                                const std::function<void(pid_t)>& while_running = nullptr,
                                const std::string& in = ".") {
  return RunProgram(ALIDADE_BINARY, arguments, while_running, in);
}

// Number of lines; an error message is one line.
inline int LineCount(const std::string& text) {
  int lines = 0;
  for (const char c : text) lines += c == '\n';
  return lines;
}

}  // namespace alidade
