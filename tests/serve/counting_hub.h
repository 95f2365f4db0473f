// A stream hub for tests: its messages are numbers, its whole state is "whole N", where N is the
// last number sent.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "alidade/stream/stream_hub.h"

namespace alidade {

class CountingHub : public StreamHub {
 public:
  // Pads each message to `bytes` bytes.
  explicit CountingHub(size_t bytes = 0) : bytes_(bytes) {}

  int Join(Take take) override {
    const std::lock_guard lock(mutex_);
    take(Made("hello"));
    take(Made("whole " + std::to_string(told_)));
    takes_[++last_id_] = std::move(take);
    ++joins_;
    changed_.notify_all();
    return last_id_;
  }
  void Leave(int id) override {
    const std::lock_guard lock(mutex_);
    takes_.erase(id);
    changed_.notify_all();
  }
  void Control(StreamControl control) override {
    const std::lock_guard lock(mutex_);
    controls_.push_back(control);
    changed_.notify_all();
  }

  void Tell() {
    const std::lock_guard lock(mutex_);
    const auto message = Made(std::to_string(++told_));
    for (auto& [id, take] : takes_) take(message);
  }

  // Waits until `condition` holds, for at most a minute.
  template <class Condition>
  bool WaitFor(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(1), [&] { return condition(*this); });
  }
  // Size of the messages that are still referenced.
  size_t living_bytes() const { return *living_; }
  // Call inside WaitFor().
  size_t members() const { return takes_.size(); }
  int joins() const { return joins_; }
  const std::vector<StreamControl>& controls() const { return controls_; }

 private:
  std::shared_ptr<const std::string> Made(std::string text) const {
    if (text.size() < bytes_) text.resize(bytes_, ' ');
    *living_ += text.size();
    return {new std::string(std::move(text)), [living = living_](const std::string* message) {
              *living -= message->size();
              delete message;
            }};
  }

  const size_t bytes_;
  const std::shared_ptr<std::atomic<size_t>> living_ = std::make_shared<std::atomic<size_t>>(0);
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<int, Take> takes_;
  int last_id_ = 0, joins_ = 0, told_ = 0;
  std::vector<StreamControl> controls_;
};

}  // namespace alidade
