// What waits to be sent to one viewer: messages that all viewers share, so many bytes at most.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

namespace alidade {

class ClientQueue {
 public:
  using Message = std::shared_ptr<const std::string>;

  explicit ClientQueue(size_t bytes) : bytes_(bytes) {}

  // By who tells, from any thread. True when who sends must be woken: it has nothing to do, or is
  // to hear that all was forgotten. Messages that come before Joined() are the whole state: they do
  // not count.
  bool Push(const Message& message);

  // By who sends. Null when nothing waits; then Push() will wake.
  Message Pop();
  // More than `bytes` waited: all is forgotten, nothing more is taken until Begin().
  bool behind() const;
  void Begin();   // before it joins: forgets all
  void Joined();  // after
  size_t waiting_bytes() const;

 private:
  struct Entry {
    Message message;
    size_t counts;  // bytes
  };
  const size_t bytes_;
  mutable std::mutex mutex_;
  std::deque<Entry> entries_;
  size_t counted_ = 0;
  bool joining_ = false;
  bool behind_ = false;
  bool awake_ = false;  // who sends will look again by itself
};

}  // namespace alidade
