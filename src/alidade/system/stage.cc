#include "alidade/system/stage.h"

#include <utility>

#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"

namespace alidade {

Stage::Stage(Work work, Schedule schedule) : work_(std::move(work)), schedule_(schedule) {
  if (schedule != Schedule::kInline) thread_ = std::thread([this] { Run(); });
}

Stage::~Stage() { Stop(); }

void Stage::Stop() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
    hurry_ = true;
    queue_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Stage::Process(KeyFrameId id) {
  const Stopwatch watch;
  work_(id, schedule_ == Schedule::kInline ? nullptr : &hurry_);
  std::lock_guard<std::mutex> lock(mutex_);
  milliseconds_.push_back(watch.Milliseconds());
}

void Stage::Add(KeyFrameId id) {
  if (schedule_ == Schedule::kInline) return Process(id);
  {
    std::lock_guard<std::mutex> lock(mutex_);
    queue_.push_back(id);
    hurry_ = true;
  }
  changed_.notify_all();
}

int Stage::backlog() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return static_cast<int>(queue_.size()) + working_;
}

void Stage::GiveUp() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    queue_.clear();
    hurry_ = true;
  }
  changed_.notify_all();
}

void Stage::Drain() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return failure_ || (queue_.empty() && !working_); });
  if (failure_) std::rethrow_exception(failure_);
}

std::vector<double> Stage::Milliseconds() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return milliseconds_;
}

void Stage::WhileResting(const std::function<void()>& action) {
  if (schedule_ == Schedule::kInline) return action();
  {
    std::unique_lock<std::mutex> lock(mutex_);
    ++rests_;
    hurry_ = true;
    changed_.wait(lock, [&] { return !working_; });
  }
  std::exception_ptr failure;
  try {
    action();
  } catch (...) {
    failure = std::current_exception();
  }
  {
    std::lock_guard<std::mutex> lock(mutex_);
    --rests_;
  }
  changed_.notify_all();
  if (failure) std::rethrow_exception(failure);
}

void Stage::Run() {
  if (schedule_ == Schedule::kBackground) {
    KeepLoopsOnThisThread();
    LowerThreadPriority();
  }
  while (true) {
    KeyFrameId id;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [&] { return stopping_ || (!queue_.empty() && rests_ == 0); });
      if (stopping_) return;
      id = queue_.front();
      queue_.pop_front();
      working_ = true;
      hurry_ = !queue_.empty();
    }
    std::exception_ptr failure;
    try {
      Process(id);
    } catch (...) {
      failure = std::current_exception();
    }
    {
      std::lock_guard<std::mutex> lock(mutex_);
      working_ = false;
      if (failure) failure_ = failure;
    }
    changed_.notify_all();
    if (failure) return;
  }
}

}  // namespace alidade
