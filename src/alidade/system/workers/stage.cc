#include "alidade/system/workers/stage.h"

#include <utility>

#include "alidade/base/parallel.h"
#include "alidade/base/part_times.h"

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

std::exception_ptr Stage::failure() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return failure_;
}

// Keeps the first failure: later ones may be its consequence.
void Stage::Fail(const std::exception_ptr& what) noexcept {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (!failure_) failure_ = what;
    queue_.clear();
    hurry_ = true;
  }
  changed_.notify_all();
}

void Stage::Process(Task& task) noexcept {
  const PartTimer timer(FramePart::kMapping);
  try {
    if (task.errand) return task.errand();
    const Stopwatch watch;
    work_(task.id, schedule_ == Schedule::kInline ? nullptr : &hurry_);
    milliseconds_.Add(watch.Milliseconds());
  } catch (...) {
    Fail(std::current_exception());
  }
}

bool Stage::Enqueue(Task task) noexcept {
  if (schedule_ == Schedule::kInline) {
    if (failure()) return false;
    Process(task);
    return true;
  }
  try {
    std::lock_guard<std::mutex> lock(mutex_);
    if (failure_ || stopping_) return false;
    queue_.push_back(std::move(task));
    hurry_ = true;
  } catch (...) {  // no memory for the queue
    Fail(std::current_exception());
    return false;
  }
  changed_.notify_all();
  return true;
}

void Stage::Add(KeyFrameId id) noexcept { Enqueue({id, nullptr}); }

bool Stage::AddErrand(std::function<void()> errand) noexcept {
  return Enqueue({{}, std::move(errand)});
}

int Stage::backlog() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return static_cast<int>(queue_.size()) + working_;
}

void Stage::GiveUp() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    std::erase_if(queue_, [](const Task& task) { return !task.errand; });
    hurry_ = true;
  }
  changed_.notify_all();
}

void Stage::Drain() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return queue_.empty() && !working_; });
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
    Task task;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock,
                    [&] { return stopping_ || failure_ || (!queue_.empty() && rests_ == 0); });
      if (stopping_ || failure_) return;
      task = std::move(queue_.front());
      queue_.pop_front();
      working_ = true;
      hurry_ = !queue_.empty();
    }
    Process(task);
    task = {};
    {
      std::lock_guard<std::mutex> lock(mutex_);
      working_ = false;
    }
    changed_.notify_all();
  }
}

}  // namespace alidade
