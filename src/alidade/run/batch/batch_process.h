// Programs that run beside each other, a few at a time.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace alidade {

struct ProcessTask {
  std::vector<std::string> words;  // program and arguments
  std::string log;                 // file for what it says
};

struct ProcessEnd {
  int status = 0;  // exit status; -N: ended by signal N
  double wall_s = 0, cpu_s = 0, peak_mb = 0;
};

struct ProcessEvents {
  std::function<void(size_t task)> begun;
  std::function<void(size_t task, const ProcessEnd& end)> ended;
  std::function<void()> waiting;  // ten times a second
};

// Runs all tasks, `at_once` at a time, in order, and returns when the last has ended. After an
// interrupt (CatchInterrupts()) those that run are told, by SIGINT, and no more are begun. Throws
// Error (input) when a process or its log cannot be made; those that run are waited for.
void RunProcesses(const std::vector<ProcessTask>& tasks, int at_once, const ProcessEvents& events);

}  // namespace alidade
