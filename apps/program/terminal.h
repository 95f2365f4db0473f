// Terminal output of a running command: warnings, and one line of progress.
#pragma once

#include <mutex>
#include <string>

namespace alidade {

// Warn() may be called from any thread.
class Terminal {
 public:
  explicit Terminal(bool quiet);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  bool shows_progress() const { return shows_progress_; }  // stderr is a terminal, and not quiet
  void SetProgress(const std::string& line);               // replaces the line; empty: none
  void Warn(const std::string& message);

 private:
  void Erase();

  const bool quiet_, shows_progress_;
  std::mutex mutex_;
  std::string line_;  // as currently shown
};

}  // namespace alidade
