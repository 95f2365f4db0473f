#include "alidade/system/mapping_stage.h"

#include "alidade/base/timing.h"

namespace alidade {

MappingStage::MappingStage(Mapper& mapper, bool threaded) : mapper_(mapper) {
  if (threaded) thread_ = std::thread([this] { Run(); });
}

MappingStage::~MappingStage() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
    hurry_ = true;
    queue_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void MappingStage::Process(KeyFrameId id) {
  const Stopwatch watch;
  mapper_.Process(id, thread_.joinable() ? &hurry_ : nullptr);
  std::lock_guard<std::mutex> lock(mutex_);
  milliseconds_.push_back(watch.Milliseconds());
}

void MappingStage::Add(KeyFrameId id) {
  if (!thread_.joinable()) return Process(id);
  {
    std::lock_guard<std::mutex> lock(mutex_);
    queue_.push_back(id);
    hurry_ = true;
  }
  changed_.notify_all();
}

int MappingStage::backlog() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return static_cast<int>(queue_.size()) + working_;
}

void MappingStage::Drain() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return failure_ || (queue_.empty() && !working_); });
  if (failure_) std::rethrow_exception(failure_);
}

std::vector<double> MappingStage::Milliseconds() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return milliseconds_;
}

void MappingStage::Run() {
  while (true) {
    KeyFrameId id;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [&] { return stopping_ || !queue_.empty(); });
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
