// Runs several programs at the same time.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace alidade {

struct ProcessTask {
  std::vector<std::string> words;  // program and arguments
  std::string log;                 // file for its output
};

struct ProcessEnd {
  int status = 0;  // exit status; -N: ended by signal N
  double wall_s = 0, cpu_s = 0, peak_mb = 0;
};

struct ProcessEvents {
  std::function<void(size_t task)> begun;
  std::function<void(size_t task, const ProcessEnd& end)> ended;
  std::function<void()> waiting;  // called ten times per second
};

// Runs all tasks in order, at most `at_once` at the same time, and returns when the last one has
// ended. After an interrupt (CatchInterrupts()) running tasks get SIGINT, and no further ones are
// started. Throws Error (input) if a process or its log cannot be created, after the running tasks
// have ended.
void RunProcesses(const std::vector<ProcessTask>& tasks, int at_once, const ProcessEvents& events);

}  // namespace alidade
