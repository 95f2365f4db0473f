#include "alidade/run/batch/batch_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <map>
#include <thread>

#include "alidade/base/error.h"
#include "alidade/base/timing.h"
#include "alidade/run/play/loop.h"

namespace alidade {
namespace {

struct Running {
  size_t task = 0;
  Stopwatch clock;
};

double SecondsOf(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

pid_t Launch(const ProcessTask& task) {
  const int log = open(task.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (log < 0) ThrowInput(task.log + ": cannot be written: " + std::strerror(errno));
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  std::vector<std::string> words = task.words;
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  // Between fork and exec the child has our handlers of Ctrl-C, whose state is lost with exec, so a
  // SIGINT then would be ignored. SIGINT is blocked until the child has its own handlers.
  sigset_t stops, before;
  sigemptyset(&stops);
  sigaddset(&stops, SIGINT);
  sigaddset(&stops, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stops, &before);
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    setpgid(0, 0);                     // Ctrl-C reaches only this process, which passes it on
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // children end when this process is killed
    dup2(nothing, STDIN_FILENO);
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  const int why = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  close(log);
  if (nothing >= 0) close(nothing);
  if (child < 0) ThrowInput(std::string("cannot start a process: ") + std::strerror(why));
  return child;
}

// `told`: SIGINT was sent to it; a program without handlers yet ends at once.
ProcessEnd EndOf(int state, const rusage& usage, const Stopwatch& clock, bool told) {
  ProcessEnd end;
  end.status = WIFEXITED(state) ? WEXITSTATUS(state) : -WTERMSIG(state);
  if (told && end.status == -SIGINT) end.status = kInterruptedStatus;
  end.wall_s = 1e-3 * clock.Milliseconds();
  end.cpu_s = SecondsOf(usage.ru_utime) + SecondsOf(usage.ru_stime);
  end.peak_mb = 1024e-6 * static_cast<double>(usage.ru_maxrss);
  return end;
}

}  // namespace

void RunProcesses(const std::vector<ProcessTask>& tasks, int at_once, const ProcessEvents& events) {
  std::map<pid_t, Running> running;
  size_t next = 0;
  bool told = false;
  std::exception_ptr problem;
  while (next < tasks.size() || !running.empty()) {
    while (!problem && !Interrupted() && next < tasks.size() &&
           static_cast<int>(running.size()) < at_once) {
      try {
        if (events.begun) events.begun(next);
        const pid_t child = Launch(tasks[next]);
        running[child].task = next++;
      } catch (...) {
        problem = std::current_exception();
      }
    }
    if (running.empty()) break;  // interrupted, or no task can be started
    if (Interrupted() && !std::exchange(told, true)) {
      for (const auto& [child, what] : running) kill(child, SIGINT);
    }
    bool any = false;
    for (auto it = running.begin(); it != running.end();) {
      int state = 0;
      rusage usage{};
      const pid_t ended = wait4(it->first, &state, WNOHANG, &usage);
      if (ended == 0 || (ended < 0 && errno == EINTR)) {
        ++it;
        continue;
      }
      const Running what = it->second;
      it = running.erase(it);
      any = true;
      if (events.ended) events.ended(what.task, EndOf(state, usage, what.clock, told));
    }
    if (any) continue;
    if (events.waiting) events.waiting();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  if (problem) std::rethrow_exception(problem);
}

}  // namespace alidade
