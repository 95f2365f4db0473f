#include "alidade/io/read_ahead.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

double ThreadCpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

ReadAhead::ReadAhead(std::unique_ptr<FrameSource> source, int capacity)
    : source_(std::move(source)),
      info_(source_->Info()),
      capacity_(static_cast<size_t>(std::max(1, capacity))),
      thread_([this] { Run(); }) {}

ReadAhead::~ReadAhead() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  source_->Stop();
  thread_.join();
}

void ReadAhead::Run() {
  KeepLoopsOnThisThread();  // so that this thread's CPU clock includes all work of reading
  std::exception_ptr failure;
  try {
    while (true) {
      std::optional<SourceFrame> frame = source_->Next();
      cpu_seconds_.store(ThreadCpuSeconds());
      if (!frame) break;
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stop_ || info_.live || queue_.size() < capacity_; });
      if (stop_) break;
      Push(std::move(*frame));
      changed_.notify_all();
    }
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  failure_ = failure;
  finished_ = true;
  changed_.notify_all();
}

void ReadAhead::Push(SourceFrame frame) {
  if (info_.live && !queue_.empty()) {
    std::vector<ImuSample>& before = queue_.back().imu;
    frame.imu.insert(frame.imu.begin(), before.begin(), before.end());
    queue_.pop_back();
    ++replaced_;
  }
  queue_.push_back(std::move(frame));
}

bool ReadAhead::Wait(double seconds) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                           [this] { return finished_ || !queue_.empty(); });
}

int ReadAhead::replaced() const {
  const std::lock_guard lock(mutex_);
  return replaced_;
}

bool ReadAhead::ready() const {
  const std::lock_guard lock(mutex_);
  return !queue_.empty();
}

std::optional<SourceFrame> ReadAhead::Next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return finished_ || !queue_.empty(); });
  if (!queue_.empty()) {
    SourceFrame frame = std::move(queue_.front());
    queue_.pop_front();
    changed_.notify_all();
    return frame;
  }
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::nullopt;
}

}  // namespace alidade
