#include "alidade/serve/client_queue.h"

#include <utility>

namespace alidade {

bool ClientQueue::Push(const Message& message) {
  std::deque<Entry> forgotten;  // destroyed after the lock is released
  const std::lock_guard lock(mutex_);
  if (behind_) return false;
  const size_t counts = joining_ ? 0 : message->size();
  if (counted_ + counts > bytes_ && !entries_.empty()) {
    entries_.swap(forgotten);
    counted_ = 0;
    behind_ = true;
    return true;
  }
  entries_.push_back({message, counts});
  counted_ += counts;
  return !std::exchange(awake_, true);
}

ClientQueue::Message ClientQueue::Pop() {
  const std::lock_guard lock(mutex_);
  awake_ = !entries_.empty();
  if (!awake_) return nullptr;
  Message message = std::move(entries_.front().message);
  counted_ -= entries_.front().counts;
  entries_.pop_front();
  return message;
}

bool ClientQueue::behind() const {
  const std::lock_guard lock(mutex_);
  return behind_;
}

void ClientQueue::Begin() {
  std::deque<Entry> forgotten;
  const std::lock_guard lock(mutex_);
  entries_.swap(forgotten);
  counted_ = 0;
  behind_ = false;
  joining_ = true;
}

void ClientQueue::Joined() {
  const std::lock_guard lock(mutex_);
  joining_ = false;
}

size_t ClientQueue::waiting_bytes() const {
  const std::lock_guard lock(mutex_);
  size_t bytes = 0;
  for (const Entry& entry : entries_) bytes += entry.message->size();
  return bytes;
}

}  // namespace alidade
