// Queue of messages to send to one viewer, limited in bytes. The messages are shared by all
// viewers.
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

  // Producer, any thread. Returns true when the consumer must be woken: it is idle, or the queue
  // was discarded. Messages pushed between Begin() and Joined() are the whole state and do not
  // count against the limit.
  bool Push(const Message& message);

  // Consumer. Null when the queue is empty; the next Push() then returns true.
  Message Pop();
  // The limit was exceeded: the queue was discarded and accepts nothing until Begin().
  bool behind() const;
  void Begin();   // before joining: empties the queue
  void Joined();  // after joining
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
  bool awake_ = false;  // the consumer will call Pop() again without being woken
};

}  // namespace alidade
