#include "program/terminal.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace alidade {
namespace {

constexpr char kLogger[] = "alidade";

size_t TerminalWidth() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

}  // namespace

Terminal::Terminal(bool quiet)
    : quiet_(quiet), shows_progress_(!quiet && isatty(STDERR_FILENO) != 0) {
  spdlog::drop(kLogger);
  spdlog::stderr_color_st(kLogger)->set_pattern("%n: %^%l%$: %v");
}

Terminal::~Terminal() { SetProgress(""); }

void Terminal::Erase() {
  if (!line_.empty()) std::fputs("\r\033[K", stderr);
}

void Terminal::SetProgress(const std::string& line) {
  if (!shows_progress_) return;
  const std::lock_guard lock(mutex_);
  Erase();
  line_ = line.substr(0, TerminalWidth() - 1);  // a line that wraps could not be erased
  std::fputs(line_.c_str(), stderr);
  std::fflush(stderr);
}

void Terminal::Warn(const std::string& message) {
  const std::lock_guard lock(mutex_);
  if (quiet_) return;
  Erase();
  std::string one_line = message;
  for (char& c : one_line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  spdlog::get(kLogger)->warn("{}", one_line);
  std::fputs(line_.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace alidade
